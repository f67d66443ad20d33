#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""./run demo: shows the CT of an engine in two viewers, with and without render nodes.

Writes out/demo/: images, difference maps, report.json and index.html. Prints the same figures as a table.
"""

import json
import sys
from dataclasses import dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import page  # noqa: E402
import viewers  # noqa: E402
from display import VirtualDisplay  # noqa: E402

FOLDER = viewers.OUT / "demo"
MODES = {"rgba": "pre-classified voxels, fixed function", "table": "scalar voxels, 1-D table in GLSL",
         "core": "OpenGL 3.3 core profile"}
FRAMES = 12
ORBIT = 5  # degrees per frame
ENGINE_SIZE = (256, 256, 110)


@dataclass
class Shot:
    """One run of a viewer, and its results."""
    way: str
    image: Path
    frame_ms: float
    report: dict = field(default_factory=dict)
    difference: dict = field(default_factory=dict)
    difference_map: Path | None = None

    def substituted(self):
        return sum(volume["draws"]["substituted"] for volume in self.report.get("volumes", []))


@dataclass
class Scene:
    """One viewer; the first shot is the bare viewer, with which the others are compared."""
    name: str
    what: str
    shots: list


def ways(names, report_stem):
    """Yields (name, prefix, report path) for each way to run; the bare viewer has neither prefix nor report."""
    nodes = {"embedded": [], "4 ranks": ["-n", "4"]}
    for name in names:
        if name == "bare":
            yield name, [], None
        else:
            report = FOLDER / f"{report_stem}-{name.replace(' ', '-')}.json"
            yield name, viewers.understudy(*nodes[name], "--report", report), report


def take(way, image, report, frame_ms, bare):
    shot = Shot(way, image, frame_ms)
    if report:
        shot.report = viewers.read_report(report)
    if bare:
        shot.difference_map = image.with_name(image.stem + "-difference.png")
        shot.difference = viewers.compare(bare.image, image, shot.difference_map)
    print(f"  {way:10} {frame_ms:8.1f} ms a frame"
          + (f", {shot.substituted()} volume draws substituted, RMS {shot.difference['rms']:.4f}" if bare else ""),
          flush=True)
    return shot


def bundled_scene(volume, mode):
    scene = Scene(f"understudy-viewer --mode {mode}", MODES[mode], [])
    print(scene.name, flush=True)
    for way, prefix, report in ways(["bare", "embedded", "4 ranks"], f"viewer-{mode}"):
        image = FOLDER / f"viewer-{mode}-{way.replace(' ', '-')}.png"
        times = viewers.bundled_viewer(prefix, volume, mode, FRAMES, ORBIT, image)
        scene.shots.append(take(way, image, report, viewers.steady_median(times),
                                scene.shots[0] if scene.shots else None))
    return scene


def osgvolume_scene(volume):
    scene = Scene("osgvolume", "OpenSceneGraph's own viewer, as Debian ships it: fixed function, texgen, clip planes", [])
    print(scene.name, flush=True)
    with VirtualDisplay() as display:
        for way, prefix, report in ways(["bare", "4 ranks"], "osgvolume"):
            image = FOLDER / f"osgvolume-{way.replace(' ', '-')}.png"
            frame_ms = viewers.osgvolume_frame_ms(prefix, volume, ENGINE_SIZE, display)
            viewers.photograph_window([*prefix, *viewers.osgvolume(volume, ENGINE_SIZE)], display, image)
            scene.shots.append(take(way, image, report, frame_ms, scene.shots[0] if scene.shots else None))
    return scene


def table(scenes):
    lines = [f"{'viewer':34} {'run':10} {'ms/frame':>9} {'speed-up':>9} {'substituted':>12} {'max':>8} {'RMS':>8} {'PSNR':>9}"]
    for scene in scenes:
        bare = scene.shots[0]
        for shot in scene.shots:
            line = f"{scene.name:34} {shot.way:10} {shot.frame_ms:9.1f} {bare.frame_ms / shot.frame_ms:8.1f}x"
            if shot.difference:
                psnr = shot.difference["psnr"]
                line += (f" {shot.substituted():12d} {shot.difference['max']:8.4f} {shot.difference['rms']:8.4f}"
                         f" {'inf' if psnr is None else f'{psnr:.2f}':>6} dB")
            lines.append(line)
    return "\n".join(lines)


def summary(scenes):
    """Returns the content of report.json: the figures of the table, and the report of every run."""
    return {"volume": str(viewers.ENGINE),
            "scenes": [{"viewer": scene.name,
                        "runs": [{"run": shot.way, "image": shot.image.name, "frame_ms": shot.frame_ms,
                                  "difference_to_bare": shot.difference or None, "report": shot.report or None}
                                 for shot in scene.shots]}
                       for scene in scenes]}


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    volume = viewers.engine_volume()
    scenes = [bundled_scene(volume, mode) for mode in MODES]
    scenes.append(osgvolume_scene(volume))
    (FOLDER / "report.json").write_text(json.dumps(summary(scenes), indent=1), encoding="utf-8")
    (FOLDER / "index.html").write_text(page.html(scenes, table(scenes)), encoding="utf-8")
    print("\n" + table(scenes))
    print(f"\nimages and difference maps: {FOLDER / 'index.html'}")
    untouched = [f"{scene.name}, {shot.way}" for scene in scenes for shot in scene.shots[1:] if not shot.substituted()]
    if untouched:
        print("understudy substituted nothing in: " + "; ".join(untouched), file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (viewers.ViewerFailed, RuntimeError, OSError) as error:
        sys.exit(f"demo: {error}")
