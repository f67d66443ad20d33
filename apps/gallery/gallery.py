#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""./run gallery [FOLDER]: renders volumes in files with `understudy render`, as four kinds of image.

The engine comes from Debian; FOLDER (default: ../shared/data beside the checkout) may contain others. Writes out/gallery/:
images, index.html with all of them, and table.md with command lines, times and errors.
"""

import json
import shlex
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "demo"))
import page  # noqa: E402
import viewers  # noqa: E402

FOLDER = viewers.OUT / "gallery"
TABLES = (HERE / "tables").relative_to(viewers.ROOT)
SIDE = 512
FRAMES = 5
FINE = 0.125  # step of the images that serve as references for the errors
KINDS = {"iso": "iso-surfaces under a light", "dvr": "direct volume rendering", "both": "both in one image",
         "shaded": "direct volume rendering under a light"}


@dataclass(frozen=True)
class Volume:
    name: str
    what: str
    file: str
    view: tuple  # options for all kinds
    iso: tuple  # surfaces of the kind "iso"
    within: tuple  # surfaces of the kind "both"


VOLUMES = (
    Volume("engine", "CT of an engine", viewers.ENGINE, ("--camera", "30,30,2.7"),
           ("80,#98a4b4",), ("190,#ff9a3c",)),
    Volume("head", "CT of a head", "cthead_256x256x113_int16be.raw.gz",
           ("--spacing", "1", "1", "2", "--camera", "-35,-5,2.8,180"),
           ("600,#e8c4a8",), ("1300,#f4ecdc",)),
    Volume("vessels", "angiography of the vessels of a head", "aneurism_256x256x256_uint8.raw.gz",
           ("--camera", "30,20,2.4"), ("60,#ff7060",), ("35,#6890d0,0.25",)),
    Volume("bonsai", "CT of a bonsai", "bonsai_256x256x256_uint8.nii.gz", ("--camera", "170,14,2.8"),
           ("38,#88b060", "110,#a07850"), ("110,#b08860",)),
)


def options(volume, kind):
    """Returns the options of `understudy render`, without the file and the image."""
    def surfaces(chosen):
        return [word for surface in chosen for word in ("--surface", surface)]

    def table(name):
        return ["--transfer-function", str(TABLES / f"{name}.json"), "--method", "pre-integrated"]

    return [*volume.view, *{
        "iso": ["--no-volume", *surfaces(volume.iso), "--light", "all"],
        "dvr": table(volume.name),
        "both": [*table(f"{volume.name}-veil"), *surfaces(volume.within), "--light", "surfaces"],
        "shaded": [*table(volume.name), "--light", "all", "--material", "0.3,0.85,0.3,20"]}[kind]]


@dataclass
class Shot:
    volume: Volume
    kind: str
    image: Path
    frame_ms: float
    rms: float

    def command(self):
        return f"understudy render ${self.volume.name} {shlex.join(options(self.volume, self.kind))}"


def render(file, wanted, image, *more):
    report = image.with_suffix(".json")
    viewers.run([viewers.PROGRAMS / "understudy", "render", file, *wanted, "--size", f"{SIDE}x{SIDE}", "--out", image,
                 "--save-float", image.with_suffix(".pfm"), "--report", report, *more])
    return json.loads(report.read_text(encoding="utf-8"))


def take(volume, file, kind):
    image = FOLDER / f"{volume.name}-{kind}.png"
    report = render(file, options(volume, kind), image, "--frames", FRAMES)
    fine = FOLDER / "fine.png"
    render(file, options(volume, kind), fine, "--step", FINE)
    rms = viewers.compare(image.with_suffix(".pfm"), fine.with_suffix(".pfm"))["rms"]
    for scrap in (*FOLDER.glob("fine*"), *FOLDER.glob(f"{image.stem}*.pfm")):
        scrap.unlink()
    shot = Shot(volume, kind, image, min(report["frames_ms"]), rms)
    print(f"  {kind:7} {shot.frame_ms:8.1f} ms a frame, rms {rms:.1e}", flush=True)
    return shot


def file_of(volume, folder):
    return viewers.engine_volume() if volume.file == viewers.ENGINE else folder / volume.file


def table(shots):
    rows = ["| image | ms a frame | rms | command |", "|---|---|---|---|"]
    rows += [f"| {shot.volume.name}, {shot.kind} | {shot.frame_ms:.0f} | {shot.rms:.1e} | `{shot.command()}` |"
             for shot in shots]
    return "\n".join(rows) + "\n"


def html(shots):
    def section(volume):
        own = [shot for shot in shots if shot.volume is volume]
        figures = [page.figure(shot.image, f"<b>{KINDS[shot.kind]}</b>, {shot.frame_ms:.0f} ms, rms {shot.rms:.1e}<br>"
                                             f"<code>{page.escape(shot.command())}</code>") for shot in own]
        return f"<section><h2>{page.escape(volume.what)}</h2><div class='row'>{''.join(figures)}</div></section>"

    volumes = dict.fromkeys(shot.volume for shot in shots)
    return f"""<!doctype html>
<html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Understudy: gallery</title><style>{page.STYLE}</style>
<h1>Gallery</h1>
<p class="lead">Volumes in files, {SIDE} × {SIDE} pixels, by the CPU of this machine in one process, the fastest of {FRAMES}
frames; the rms error is against the same image in steps of {FINE} voxels.</p>
{''.join(map(section, volumes))}
</html>
"""


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else viewers.ROOT.parent / "shared" / "data"
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir(parents=True)
    shots = []
    for volume in VOLUMES:
        file = file_of(volume, folder)
        if not file.exists():
            print(f"{volume.name}: left out, there is no {file}; name the folder that has it: ./run gallery FOLDER")
            continue
        print(f"{volume.name}: {volume.what}", flush=True)
        shots += [take(volume, file, kind) for kind in KINDS]
    (FOLDER / "table.md").write_text(table(shots), encoding="utf-8")
    (FOLDER / "index.html").write_text(html(shots), encoding="utf-8")
    print(f"\nimages:   {FOLDER / 'index.html'}\nfigures:  {FOLDER / 'table.md'}")


if __name__ == "__main__":
    try:
        main()
    except (viewers.ViewerFailed, RuntimeError, OSError) as error:
        sys.exit(f"gallery: {error}")
