#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""./run modes [NAME…]: packaged viewers in the modes that people use, bare and under `understudy run`, as a table.

The script at UNDERSTUDY_VIEWER_MODES (../shared/clients/modes/run beside the checkout, if the variable is not set) is
called as

    [WITH="command…"] run VIEWER DATA MODES IMAGE.png FRAMES

It saves a first, a middle and a last image (IMAGE.a.png, IMAGE.b.png, IMAGE.png) and prints a line "FRAME ms median X".
Bare and substituted runs alternate, in reverse order in every second round; a ratio is that of two adjacent runs. The
interval of the ratio is that of Student's t over the logarithms. Everything is configured as for users: the speed guard is
on. If a volume is handed back to the viewer, the runs last for five seconds of frames and at least 60 frames, provided that a
frame takes less than half a second.

Rows of the viewer `viewer` are those of ./run viewers, whose script is called with the name that stands in place of the
data; for these rows, only the last image is compared.

With --simultaneous, the two runs of a round share one processor, and "ms bare" is the processor time of frames: whatever
slows the machine for a second slows both. This is for machines with other load, on which the times of two consecutive runs
vary by more than the ratio should resolve. Viewers whose script is not Python, or whose nodes are processes of their own,
cannot be timed in this way. --simultaneous-near-one does so if the volume is handed back, or if the first ratio is near 1.

With --jobs N, N rows are measured at once, each on a processor of its own. With --resume, rows that table.json contains
are not measured again: measuring all rows takes hours.

With --watch, each row runs once under Understudy with the speed guard off, and once bare. The table then shows how many images
were compared and how many failed, and the share of a bare frame that recognition and sentinels took, on average over all
frames but the first; and how long Understudy waited for what the viewer had drawn before, as the viewer itself would have.

During rotation (`inter`), VTK chooses the quality of an image by the clock: two runs show different images in the middle.
In this mode, every frame of one more run is compared with what the viewer draws in the same frame (--verify 1).

An image is compared with the bare viewer's of the same round in tiles of 16 × 16 pixels, as described in
docs/verification.md: the worst tile's difference as a multiple of the bound.

Images, reports and the viewers' output are kept in out/modes, together with table.json and table.md.
"""

import argparse
import json
import math
import os
import re
import shutil
import statistics
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy

from viewers import ROOT, UNDERSTUDY, missing, run_group, say, viewer_script

OUT = ROOT / "out" / "modes"
# Folder whose sitecustomize.py makes Python's clock that of the process.
PROCESSOR_TIME = Path(__file__).resolve().parent / "processor_time"
TILE = 16
# The bounds of docs/verification.md, in 1/255: for a tile's average, and for the value that an eighth of its pixels
# reach.
MAX_EXCESS, MAX_COMMON = 3.0, 8.0
# Length of runs of a viewer whose volume is handed back, in ms of frames, if its frames are shorter than the second
# value.
HANDED_BACK_MS, SHORT_FRAME_MS = 5000, 500
# A first ratio below this counts as near 1, given the precision of two consecutive runs.
NEAR_ONE = 1.3
# A viewer that reports less than this for a frame has only scheduled the drawing, as mayavi does.
DRAWN_MS = 1
# For slices blended in 8 bits: each blend rounds, so that a hundred slices drift by several 255ths. Above this bound,
# every frame is compared with the viewer's slices as Understudy itself compares them: blended in floats.
BOUND_OF_SLICES = 4.0
SLICES = ("pyqtgraph", "pymol", "osgvolume")
# In these modes, the viewer chooses by the clock what it shows in the middle.
BY_THE_CLOCK = ("inter",)
# Two-sided 95 % quantiles of Student's t by degrees of freedom; above ten, the value for ten is used.
T_95 = (None, 12.71, 4.30, 3.18, 2.78, 2.57, 2.45, 2.36, 2.31, 2.26, 2.23)

VTK = ["plain", "mip", "minip", "avg", "add", "iso", "slice", "shade", "gradop", "shade,gradop", "clip", "crop", "fence",
       "inter", "inter,shade", "inside", "rgba", "comp2", "nearest", "tf2d", "mask", "cell", "rot", "two", "multi",
       "tfedit", "outline,text", "surf", "transl", "peel,transl", "para", "jitter", "sd1", "noadj", "fxaa", "marker", "smart", "mb",
       "gray", "unitdist", "ssao", "ms0"]
ROWS = (
    [("viewer", name, "-") for name in ("osgvolume", "osgvolume-rgba", "osgvolume-rt", "pyqtgraph", "pymol", "vtk", "vtk-mip",
                                        "vtk-shade", "vispy", "vispy-mip")]
    + [("vtk", "engine", mode) for mode in VTK]
    + [("vtk", data, mode) for data in ("cthead", "hu", "ct16", "tooth50", "f:brain", "bonsai") for mode in ("plain", "mip")]
    + [("vtk", "cthead", "inter"), ("vtk", "cthead", "shade"), ("vtk", "aneurism", "avg")]
    + [("vispy", "engine", mode) for mode in ("mip", "translucent", "additive", "iso", "translucent,fire", "mip,gray",
                                             "translucent,gray", "mip,ortho", "translucent,axis", "mip,two", "translucent,emu")]
    + [("vispy", "cthead", "mip"), ("vispy", "brain", "translucent"), ("vispy", "f:brain", "mip")]
    + [("vispy-turn", "brain", "hot"), ("vispy-turn", "engine", "fire"), ("vispy-turn", "brain", "grays"),
       ("vispy-grid", "brain", "200"), ("vispy-grid", "brain", "600")]
    + [("pyqtgraph", data, mode) for data, mode in (("psi", "plain"), ("psi", "additive"), ("psi", "dense"), ("psi", "rough"),
                                                   ("psi", "axis,scatter,lines"), ("engine", "plain"), ("brain", "nogrid"))]
    + [("pymol", "engine", mode) for mode in ("plain", "ramp", "rainbow", "ramp,mol", "ramp,layers", "ramp,bg", "ramp,isos", "multi")]
    + [("mayavi", data, mode) for data, mode in (("brain", "plain"), ("brain", "mapper"), ("engine", "vm,axes"))]
    + [("vedo", data, mode) for data, mode in (("brain", "plain"), ("brain", "mip"), ("engine", "c"), ("brain", "jitter"))]
    + [("paraview", data, mode) for data, mode in (("engine", "plain"), ("engine", "mip"), ("cthead", "plain"),
                                                  ("engine", "inter"), ("engine", "shade"))]
)


def script():
    path = Path(os.environ.get("UNDERSTUDY_VIEWER_MODES", ROOT.parent / "shared" / "clients" / "modes" / "run"))
    if not os.access(path, os.X_OK):
        sys.exit(f"modes: there is no script at {path} that runs viewers; set UNDERSTUDY_VIEWER_MODES to one "
                 "(tests/clients/modes.py says how it is asked)")
    return path


def command_of(row, image, frames):
    viewer, data, modes = row
    if viewer == "viewer":
        return [str(viewer_script()), data, str(image), str(frames)]
    return [str(script()), viewer, data, modes, str(image), str(frames)]


def name_of(row):
    """The viewer's name in viewers.py."""
    return row[1] if row[0] == "viewer" else row[0]


def pixels(path):
    """height x width x 3, 0 to 255."""
    text = subprocess.run(["convert", path, "-alpha", "off", "-depth", "8", "ppm:-"], stdout=subprocess.PIPE, check=True).stdout
    width, height = (int(number) for number in re.match(rb"P6\s+(\d+)\s+(\d+)\s+255\s", text).groups())
    return numpy.frombuffer(text[-3 * width * height:], numpy.uint8).reshape(height, width, 3).astype(numpy.int16)


def beyond_neighbours(of, other):
    """How far each pixel of one image lies outside the range of the other within one pixel around it."""
    padded = numpy.pad(other, ((1, 1), (1, 1), (0, 0)), mode="edge")
    height, width = other.shape[:2]
    near = numpy.stack([padded[y:y + height, x:x + width] for y in range(3) for x in range(3)])
    low, high = near.min(axis=0), near.max(axis=0)
    return numpy.maximum(numpy.maximum(low - of, of - high), 0).max(axis=2)


def severity(a, b):
    """Severity of the worst tile, as in docs/verification.md: 1 is the bound."""
    excess = numpy.maximum(beyond_neighbours(a, b), beyond_neighbours(b, a)).astype(float)
    direct = numpy.abs(a - b).max(axis=2).astype(float)
    height, width = (max(1, side // TILE) for side in direct.shape)

    def tiles(values):
        cut = values[:height * TILE, :width * TILE].reshape(height, TILE, width, TILE)
        return cut.transpose(0, 2, 1, 3).reshape(height * width, TILE * TILE)

    common = numpy.sort(tiles(direct), axis=1)[:, -(TILE * TILE // 8)]
    return float(numpy.maximum(tiles(excess).mean(axis=1) / MAX_EXCESS, common / MAX_COMMON).max())


def worst_tile(a, b):
    """None if an image is missing; infinite if sizes differ."""
    if not (a.exists() and b.exists()):
        return None
    a, b = pixels(a), pixels(b)
    return severity(a, b) if a.shape == b.shape else math.inf


class Run:
    """One run of a row, bare or under Understudy."""

    def __init__(self, row, way, frames, seconds, options="", own_clock=False):
        stem = re.sub(r"[^A-Za-z0-9.-]+", "_", ".".join([*row, way]))
        image, report, log = OUT / f"{stem}.png", OUT / f"{stem}.json", OUT / f"{stem}.log"
        self.images = [OUT / f"{stem}.a.png", OUT / f"{stem}.b.png", image]
        for old in (*self.images, report):
            old.unlink(missing_ok=True)
        environment = dict(os.environ, WITH="" if way == "bare" else f"{UNDERSTUDY} run {options} --report {report} --")
        if own_clock:
            environment["PYTHONPATH"] = os.pathsep.join([str(PROCESSOR_TIME), *filter(None, [os.environ.get("PYTHONPATH")])])
        status = run_group(command_of(row, image, frames), environment, log, seconds)
        words = log.read_text(encoding="utf-8", errors="replace")
        self.report = json.loads(report.read_text(encoding="utf-8")) if report.exists() else None
        measured = re.search(r"^FRAME ms median ([0-9.]+)", words, re.MULTILINE)
        self.frame_ms = float(measured.group(1)) if measured and float(measured.group(1)) >= DRAWN_MS else None
        self.trouble = ("" if image.exists() else f"no end after {seconds} s" if status is None
                        else f"no image (exit status {status}): see {log.relative_to(ROOT)}")

    def draws(self, kind):
        return sum(volume["draws"][kind] for volume in self.report["volumes"]) if self.report else 0

    def reason(self):
        """The most frequent reason for which draws were left to the viewer."""
        counts = {}
        for volume in self.report["volumes"] if self.report else []:
            for reason, count in volume["left_because"].items():
                counts[reason] = counts.get(reason, 0) + count
        return max(counts, key=counts.get) if counts else ""


def interval(ratios):
    """Median and 95 % interval of ratios."""
    if not ratios:
        return None, None, None
    logs = [math.log(ratio) for ratio in ratios]
    if len(logs) < 2:
        return ratios[0], None, None
    half = T_95[min(len(logs) - 1, 10)] * statistics.stdev(logs) / math.sqrt(len(logs))
    middle = statistics.fmean(logs)
    return statistics.median(ratios), math.exp(middle - half), math.exp(middle + half)


def pair_of(row, number, frames, arguments, simultaneous):
    """A bare and a substituted run, in alternating order from round to round, or both at the same time."""
    ways = ("bare", "substituted")
    if simultaneous:
        with ThreadPoolExecutor() as pool:
            return dict(zip(ways, pool.map(lambda way: Run(row, way, frames, arguments.seconds, own_clock=True), ways)))
    return {way: Run(row, way, frames, arguments.seconds) for way in (ways if number % 2 == 0 else reversed(ways))}


def frames_needed(pair, arguments):
    """The requested number of frames; more if the volume was handed back and the viewer's frames are short: the cost of
    handing back is incurred in the first frames, and must not dominate a run of few frames."""
    bare, run = pair["bare"], pair["substituted"]
    short = bare.frame_ms is not None and bare.frame_ms <= SHORT_FRAME_MS
    if not short or run.trouble or run.draws("left") <= run.draws("substituted"):
        return arguments.frames
    return max(arguments.frames, arguments.handed_back_frames, round(HANDED_BACK_MS / bare.frame_ms))


def worst_tile_of_own_frames(row, frames, arguments):
    """Worst tile over all frames of a run, each compared with the viewer's own drawing; infinite if one was not compared."""
    run = Run(row, "verified", frames, arguments.seconds, "--verify 1 --speed-guard off")
    if run.trouble or not run.report:
        return None
    verified = [volume["verify"] for volume in run.report["volumes"] if volume["draws"]["substituted"] > 0]
    compared = sum(verify["frames"] for verify in verified)
    return max((verify["worst_tile"] for verify in verified), default=None) if compared >= frames else math.inf


def is_near_one(pair):
    """Whether the volume was handed back, or the viewer alone is almost as fast."""
    bare, run = pair["bare"], pair["substituted"]
    if not bare.frame_ms or not run.frame_ms:
        return False
    return run.draws("left") > run.draws("substituted") or bare.frame_ms / run.frame_ms < NEAR_ONE


def row_of(row, arguments):
    simultaneous = arguments.simultaneous == "always"
    pair = pair_of(row, 0, arguments.frames, arguments, simultaneous)
    frames = frames_needed(pair, arguments)
    again = frames != arguments.frames
    if arguments.simultaneous == "near" and is_near_one(pair):
        simultaneous = again = True
    bare_ms, ratios, tiles = [], [], [None, None, None]
    for number in range(arguments.rounds):
        if number > 0 or again:
            pair = pair_of(row, number, frames, arguments, simultaneous)
        bare, run = pair["bare"], pair["substituted"]
        if bare.trouble or run.trouble:
            return {"row": row, "trouble": f"the bare viewer: {bare.trouble}" if bare.trouble else run.trouble}
        if bare.frame_ms and run.frame_ms:
            bare_ms.append(bare.frame_ms)
            ratios.append(bare.frame_ms / run.frame_ms)
        for place, (a, b) in enumerate(zip(bare.images, run.images)):
            tile = worst_tile(a, b)
            if tile is not None:
                tiles[place] = max(tile, tiles[place] or 0.0)
    if any(mode in BY_THE_CLOCK for mode in row[2].split(",")):
        tiles[1] = worst_tile_of_own_frames(row, frames, arguments)
    drift = bool(name_of(row).split("-")[0] in SLICES and any(tile is not None and tile > BOUND_OF_SLICES for tile in tiles))
    last = pair["substituted"]
    ratio, low, high = interval(ratios)
    return {"row": row, "ratio": ratio, "low": low, "high": high, "rounds": len(ratios), "tiles": tiles,
            "simultaneous": simultaneous,
            "in_floats": worst_tile_of_own_frames(row, frames, arguments) if drift else None,
            "bare_ms": statistics.median(bare_ms) if bare_ms else None,
            "substituted": last.draws("substituted"), "left": last.draws("left"), "reason": last.reason()}


def mean(values):
    return statistics.fmean(values) if values else 0.0


def watched(row, arguments):
    """One long run under Understudy that never hands back, and its costs relative to the bare viewer's frame."""
    bare = Run(row, "bare", min(arguments.frames, 24), arguments.seconds)
    run = Run(row, "watched", arguments.frames, arguments.seconds, "--speed-guard off")
    if run.trouble or bare.trouble:
        return {"row": row, "trouble": run.trouble or f"the bare viewer: {bare.trouble}"}
    frames = [frame for frame in run.report["frames_detail"] if frame["substituted"] > 0][1:]
    return {"row": row, "bare_ms": bare.frame_ms, "frames": len(frames), "substituted": run.draws("substituted"),
            "left": run.draws("left"), "reason": run.reason(),
            "compared": [sum(volume["verify"][kind] or 0 for volume in run.report["volumes"])
                         for kind in ("frames", "tiles", "lost")],
            "waiting_ms": mean([frame["waiting_ms"] for frame in frames]),
            "recognition_ms": mean([frame["recognition_ms"] for frame in frames]),
            "sentinels_ms": mean([frame["verification_ms"] for frame in frames])}


def watched_markdown(rows):
    lines = ["| viewer | data | modes | frames | substituted, left | images, tiles compared, lost | ms bare | recognition "
             "| sentinels | waiting | left because |", "|---|---|---|---|---|---|---|---|---|---|---|"]
    for row in rows:
        name = " | ".join(row["row"])
        if "trouble" in row:
            lines.append(f"| {name} | – | – | – | – | – | – | – | {row['trouble']} |")
            continue
        bare = row["bare_ms"]
        costs = [f"{row[kind]:.2f} ms" + (f" ({100 * row[kind] / bare:.1f} %)" if bare else "")
                 for kind in ("recognition_ms", "sentinels_ms", "waiting_ms")]
        compared = ", ".join(str(count) for count in row["compared"])
        lines.append(f"| {name} | {row['frames']} | {row['substituted']}, {row['left']} | {compared} "
                     f"| {f'{bare:.1f}' if bare else '–'} | {' | '.join(costs)} | {row['reason'] or '–'} |")
    return "\n".join(lines) + "\n"


def ratio_cell(row):
    if row["ratio"] is None:
        return "–"
    span = f" ({row['low']:.2f} to {row['high']:.2f})" if row["low"] is not None else ""
    return f"{row['ratio']:.2f}×{span}"


def markdown(rows):
    lines = ["| viewer | data | modes | draws substituted, left | ms bare | bare / Understudy (95 % interval) "
             "| worst tile of the bound: first, middle, last | left because |", "|---|---|---|---|---|---|---|---|"]
    for row in rows:
        name = " | ".join(row["row"])
        if "trouble" in row:
            lines.append(f"| {name} | – | – | – | – | {row['trouble']} |")
            continue
        tiles = ", ".join("–" if tile is None else f"{tile:.2g}" for tile in row["tiles"])
        tiles += "" if row["in_floats"] is None else f" ({row['in_floats']:.2g} in floats)"
        bare = f"{row['bare_ms']:.1f}{' of a processor' if row['simultaneous'] else ''}" if row["bare_ms"] else "–"
        lines.append(f"| {name} | {row['substituted']}, {row['left']} | {bare} | {ratio_cell(row)} | {tiles} | {row['reason'] or '–'} |")
    return "\n".join(lines) + "\n"


def verdicts(rows):
    """Yields what a user would complain about."""
    for row in rows:
        if "trouble" in row:
            continue
        if row["ratio"] is not None and (row["ratio"] < 0.97 or (row["high"] is not None and row["high"] < 1.0)):
            yield f"slower: {' '.join(row['row'])}: {ratio_cell(row)}"
        bound = BOUND_OF_SLICES if name_of(row["row"]).split("-")[0] in SLICES else 1.0
        differs = any(tile is not None and tile > bound for tile in row["tiles"])
        if differs if row["in_floats"] is None else row["in_floats"] > 1.0:
            yield f"different: {' '.join(row['row'])}: {row['tiles']}"


def measured(row, arguments):
    absent = missing(name_of(row))
    if absent:
        return {"row": row, "trouble": absent}
    return watched(row, arguments) if arguments.watch else row_of(row, arguments)


class Results:
    """The rows measured so far, written to disk after each row."""

    def __init__(self, wanted, table, resume):
        self.wanted, self.table, self.lock = wanted, table, threading.Lock()
        path = OUT / "table.json"
        kept = json.loads(path.read_text(encoding="utf-8")) if resume and path.exists() else []
        self.by_row = {tuple(row["row"]): row for row in kept if "trouble" not in row}
        if not resume:
            shutil.rmtree(OUT, ignore_errors=True)
        OUT.mkdir(parents=True, exist_ok=True)

    def missing(self):
        return [row for row in self.wanted if row not in self.by_row]

    def rows(self):
        return [self.by_row[row] for row in self.wanted if row in self.by_row]

    def add(self, row):
        with self.lock:
            self.by_row[tuple(row["row"])] = row
            say(self.table([row]).splitlines()[-1])
            (OUT / "table.json").write_text(json.dumps(list(self.by_row.values()), indent=1) + "\n", encoding="utf-8")
            (OUT / "table.md").write_text(self.table(self.rows()), encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(prog="./run modes", description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="rows whose VIEWER:DATA:MODES contains this; without a name all")
    parser.add_argument("--rounds", type=int, default=5, help="how often bare and substituted runs follow each other (5)")
    parser.add_argument("--frames", type=int, default=12, help="frames that a viewer shows (12)")
    way = parser.add_mutually_exclusive_group()
    way.add_argument("--simultaneous", action="store_const", const="always", default="never",
                     help="both runs of a round at once on one processor, timed by what each has had of it")
    way.add_argument("--simultaneous-near-one", action="store_const", const="near", dest="simultaneous",
                     help="that, where the viewer draws in the end or the first ratio is near 1")
    way.add_argument("--watch", action="store_true", help="one long run of each row, without the speed guard")
    parser.add_argument("--seconds", type=int, default=120, help="after these one run of a viewer is given up (120)")
    parser.add_argument("--handed-back-frames", type=int, default=60, metavar="N",
                        help="of a viewer that draws in the end, at least so many, if they are short (60)")
    parser.add_argument("--jobs", type=int, default=1, help="rows measured at once, each on a processor of its own (1)")
    parser.add_argument("--resume", action="store_true", help="keep the rows that out/modes/table.json has")
    arguments = parser.parse_args()
    if not UNDERSTUDY.exists():
        sys.exit("modes: build/bin/understudy is not built; run ./run build")
    wanted = [row for row in ROWS if not arguments.names or any(name in ":".join(row) for name in arguments.names)]
    if not wanted:
        sys.exit("modes: no row has such a name; tests/clients/modes.py lists them")
    table = watched_markdown if arguments.watch else markdown
    results = Results(wanted, table, arguments.resume)
    processors = sorted(os.sched_getaffinity(0))
    on_one = arguments.jobs > 1 or arguments.simultaneous != "never"
    turns = iter(processors * arguments.jobs)
    with ThreadPoolExecutor(arguments.jobs, initializer=lambda: on_one and os.sched_setaffinity(0, {next(turns)})) as pool:
        list(pool.map(lambda row: results.add(measured(row, arguments)), results.missing()))
    rows = results.rows()
    print(table(rows), end="")
    if arguments.watch:
        return 1 if any(row.get("compared", [0, 0, 0])[2] for row in rows) else 0
    complaints = list(verdicts(rows))
    print("\n".join(complaints) if complaints else "none slower than the bare viewer, none different")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
