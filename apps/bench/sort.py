# SPDX-License-Identifier: Apache-2.0
"""Times of ranks of this machine by what they divide (`understudy render -n N --sort …`), beside this process alone.

Times: each round runs all ways one after another; a value is the median over the rounds of the median frame, a ratio the
median of the rounds' ratios. Samples: those of all ranks against those of one rank, and those of the busiest rank against the
mean, over VIEWS unrelated random views. The deviation is (max - min) / mean of the ranks' processor times. Division is the
fraction of a frame in which ranks estimate costs and cut the image.
"""

import json
import math
import random
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import viewers

ENGINE = "/usr/share/doc/tachyon/examples/scenes/vol/engine.256x256x110"
SCENES = {
    "engine": [ENGINE, "--transfer-function", "engine"],
    "engine's surface": [ENGINE, "--surface", "40%", "--no-volume"],
    "lobes": ["synthetic:256x256x256:u8:lobes", "--transfer-function", "vessels"],
}
# Real volumes, if they are beside the checkout.
DATA = viewers.ROOT.parent / "shared" / "data"
SCENES |= {name: [str(DATA / file), "--transfer-function", table] for name, file, table in (
    ("CT head", "cthead_256x256x113_int16be.raw.gz", "ct"), ("aneurism", "aneurism_256x256x256_uint8.raw.gz", "vessels"),
    ("bonsai", "bonsai_256x256x256_uint8.nii.gz", "ct")) if (DATA / file).exists()}
SIZE = "1024x1024"
ROUNDS = 5
FRAMES = 5
VIEWS = 20
RANKS = (2, 3, 4)
MANY_RANKS = (8, 16)


def rendered(scene, folder, *options, frames=FRAMES):
    report = folder / "report.json"
    subprocess.run([str(viewers.PROGRAMS / "understudy"), "render", *scene, "--size", SIZE, "--frames", str(frames), "--out",
                    str(folder / "image.png"), "--report", str(report), *options], check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)
    return json.loads(report.read_text(encoding="utf-8"))


def times(name, scene, folder):
    ways = {"this process": []}
    ways |= {f"{ranks} ranks, {sort}": ["-n", str(ranks), "--sort", sort] for ranks in RANKS for sort in ("first", "last")}
    frames = {way: [] for way in ways}
    for round_number in range(ROUNDS):
        for way, options in (ways.items() if round_number % 2 == 0 else reversed(ways.items())):
            frames[way].append(rendered(scene, folder, *options)["time_ms"]["frame_median"])
        print(f"  {name}: round {round_number + 1} of {ROUNDS}", file=sys.stderr, flush=True)
    for way, ms in frames.items():
        row = {"name": f"sort/{name}/{way}", "value": statistics.median(ms), "unit": "ms"}
        if way != "this process":
            row["ratio_to"] = f"sort/{name}/this process"
            row["ratio"] = statistics.median(mine / alone for mine, alone in zip(ms, frames["this process"]))
        yield row


def over_mean(values):
    return max(values) * len(values) / sum(values)


def views(name, scene, folder):
    """Measures many ranks, which share this machine's cores: so the work of each, not the time of all."""
    chosen = random.Random(24)
    cameras = [f"{chosen.uniform(0, 360):.1f},{math.degrees(math.asin(chosen.uniform(-1, 1))):.1f},{chosen.uniform(2, 4):.2f}"
               for _ in range(VIEWS)]
    alone = [rendered(scene, folder, "--camera", camera, frames=1)["samples_taken"] for camera in cameras]
    for ranks in MANY_RANKS:
        for sort in ("first", "hybrid", "last"):
            reports = [rendered(scene, folder, "--camera", camera, "-n", str(ranks), "--sort", sort, frames=3)
                       for camera in cameras]
            samples = [[rank["samples_taken"] for rank in report["ranks"]] for report in reports]
            processors = [[rank["image_processor_ms"] for rank in report["ranks"]] for report in reports]
            row = {"name": f"sort/{name}/{ranks} ranks, {sort}/samples",
                   "value": statistics.median(sum(of) / one for of, one in zip(samples, alone)), "unit": "of one rank's",
                   "busiest_over_mean": statistics.median(over_mean(of) for of in samples),
                   "deviation": statistics.median((max(of) - min(of)) * len(of) / sum(of) for of in processors),
                   "division": statistics.median(report["time_ms"]["division"] / report["time_ms"]["frame_median"]
                                                 for report in reports)}
            print(f"  {row['name']}: {row['value']:.3f}, busiest {row['busiest_over_mean']:.3f} of the mean, processor times "
                  f"deviate by {row['deviation']:.3f}, division {100 * row['division']:.1f} %", file=sys.stderr, flush=True)
            yield row


def rows():
    with tempfile.TemporaryDirectory() as folder:
        for name, scene in SCENES.items():
            yield from times(name, scene, Path(folder))
            yield from views(name, scene, Path(folder))
