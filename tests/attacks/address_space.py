# SPDX-License-Identifier: Apache-2.0
"""Limits the address space (ulimit -v): wherever the viewer itself ends well, it must do so under Understudy.

    address_space.py UNDERSTUDY UNDERSTUDY-VIEWER ENTRY-LIBRARY

The viewer's need is the smallest limit, in steps of 4 MB, from which on it ends well in 4 of 4 runs at every step. Below it,
the driver crashes at some limits and not at others (at 508 to 528 MB and at 580 to 592 MB, for example), depending on whether
a thread gets its own heap. Tested limits begin at that need plus 96 MB for the libraries' mappings and increase in steps of
50 MB. Status and image under Understudy must equal the viewer's, to 40 dB, until five steps after its volume is first
substituted.
"""

import os
import random
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

SIDE = 41
STEP_ALONE_MB = 4
STEP_MB = 50
MAPPINGS_MB = 96
MOST_MB = 16000
STEPS_BEYOND = 5
RUNS_ALONE = 4
RUNS_UNDER = 3
LEAST_DECIBELS = 40
PATIENCE_SECONDS = 600


class Viewer:
    def __init__(self, understudy, viewer, entry, folder):
        self.understudy, self.viewer, self.entry, self.folder = understudy, viewer, entry, folder
        self.volume = folder / "volume.raw"
        noise = random.Random(1).randbytes(SIDE)
        self.volume.write_bytes(bytes(noise[x] // 4 + 3 * min(x, y, z) for z in range(SIDE) for y in range(SIDE) for x in range(SIDE)))
        self.expected = folder / "expected.png"
        if self.draw(self.expected, None).returncode != 0:
            raise SystemExit("the viewer itself does not draw")

    def draw(self, image, limit_mb, **more):
        words = [self.viewer, self.volume, "--size", SIDE, SIDE, SIDE, "--type", "u8", "--offscreen", "--frames", 3, "--orbit", 5,
                 "--window-size", 200, 200, "--mode", "table", "--screenshot", image]
        environment = {name: value for name, value in os.environ.items() if not name.startswith("UNDERSTUDY")}
        environment |= {"UNDERSTUDY_SPEED_GUARD": "off", "XDG_RUNTIME_DIR": str(self.folder)} | more

        def limit():
            if limit_mb is not None:
                resource.setrlimit(resource.RLIMIT_AS, (limit_mb << 20, limit_mb << 20))

        return subprocess.run([str(word) for word in words], env=environment, capture_output=True, text=True, errors="replace",
                              timeout=PATIENCE_SECONDS, check=False, preexec_fn=limit)

    def ends(self, limit_mb, **more):
        """Status and PSNR of one run; the PSNR is None if there is no image."""
        image = self.folder / "image.png"
        image.unlink(missing_ok=True)
        result = self.draw(image, limit_mb, **more)
        if not image.exists():
            return result.returncode, None
        said = subprocess.run([self.understudy, "compare", self.expected, image], capture_output=True, text=True, check=False).stdout
        found = re.search(r"PSNR ([\d.]+|inf)", said)
        return result.returncode, float(found[1]) if found else None

    def ends_well(self, limit_mb, runs, **more):
        """How many of `runs` runs end well, and the worst PSNR of these."""
        ends = [self.ends(limit_mb, **more) for _ in range(runs)]
        good = [decibels for status, decibels in ends if status == 0 and decibels is not None and decibels >= LEAST_DECIBELS]
        return len(good), min(good, default=0)


def need_of(viewer, largest_mb):
    """The need of the viewer alone, in MB."""
    need = None
    for limit in range(STEP_MB * 4, largest_mb, STEP_ALONE_MB):
        # One failed run is sufficient.
        well = all(viewer.ends_well(limit, 1)[0] for _ in range(RUNS_ALONE))
        if not well:
            need = None
        elif need is None:
            need = limit
    return need


def main():
    understudy, program, entry = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        viewer = Viewer(understudy, program, entry, Path(folder))
        largest = max(1000, 100 * os.cpu_count())  # llvmpipe's threads take about 70 MB each
        need = need_of(viewer, largest)
        if need is None:
            raise SystemExit(f"the viewer itself does not end well below {largest} MB")
        print(f"the viewer alone needs {need} MB", flush=True)
        wrong = []
        substituted = 0
        for limit in range(need + MAPPINGS_MB, MOST_MB, STEP_MB):
            good, decibels = viewer.ends_well(limit, RUNS_UNDER, LD_PRELOAD=entry)
            print(f"{limit} MB: {good} of {RUNS_UNDER} runs end well, {decibels} dB", flush=True)
            if good < RUNS_UNDER:
                wrong.append(limit)
            # A bit-identical image is the viewer's own.
            substituted += decibels not in (0, float("inf"))
            if substituted > STEPS_BEYOND:
                break
        else:
            raise SystemExit(f"nothing is substituted below {MOST_MB} MB")
    if wrong:
        print(f"went wrong under Understudy: {wrong} MB")
    return len(wrong) > 0


if __name__ == "__main__":
    sys.exit(main())
