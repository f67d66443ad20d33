# SPDX-License-Identifier: Apache-2.0
"""Frame time of the bundled viewer: bare, with Understudy inside it, and with 2 and 4 ranks.

256^3 voxels on 512^2 pixels, in three modes of the viewer. The ways alternate within each round; a value is the median over
all rounds. The error compares the last frame with the bare viewer's, which is blended in 8 bits.
"""

import statistics
import sys

import viewers

WAYS = {"bare": None, "embedded": [], "2 ranks": ["-n", "2"], "4 ranks": ["-n", "4"]}
MODES = ["rgba", "table", "core"]
ROUNDS = 3
FRAMES = 10
SETTLE = 4  # first frames, in which shaders are compiled, the volume is sent and its first frame is verified
ORBIT = 4  # degrees per frame
SIDE = 256


def cube():
    """Resamples the engine's slices to a cube by repeating them: 256^3 bytes of real structure."""
    path = viewers.OUT / "data" / f"engine.{SIDE}x{SIDE}x{SIDE}"
    engine = viewers.engine_volume().read_bytes()
    slice_bytes = SIDE * SIDE
    depth = len(engine) // slice_bytes
    if not path.exists() or path.stat().st_size != slice_bytes * SIDE:
        path.parent.mkdir(parents=True, exist_ok=True)
        slices = (engine[z * depth // SIDE * slice_bytes:][:slice_bytes] for z in range(SIDE))
        path.write_bytes(b"".join(slices))
    return path


def prefix(way):
    return [] if WAYS[way] is None else viewers.understudy(*WAYS[way])


def rows():
    volume = cube()
    folder = viewers.OUT / "bench" / "images"
    folder.mkdir(parents=True, exist_ok=True)
    result = []
    for mode in MODES:
        times = {way: [] for way in WAYS}
        images = {way: folder / f"frame-{mode}-{way.replace(' ', '-')}.png" for way in WAYS}
        for number in range(ROUNDS):
            for way in WAYS:
                print(f"  {mode}, round {number + 1} of {ROUNDS}, {way}", file=sys.stderr, flush=True)
                drawn = viewers.bundled_viewer(prefix(way), volume, mode, FRAMES, ORBIT, images[way])
                times[way] += drawn[SETTLE:]
        bare = statistics.median(times["bare"])
        for way in WAYS:
            row = {"name": f"frame/{mode}/{way}", "value": statistics.median(times[way]), "unit": "ms"}
            if way != "bare":
                row |= {"ratio_to": f"frame/{mode}/bare", "ratio": row["value"] / bare,
                        "rms": viewers.compare(images["bare"], images[way])["rms"]}
            result.append(row)
    return result
