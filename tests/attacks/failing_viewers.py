# SPDX-License-Identifier: Apache-2.0
"""Makes one allocation of Understudy fail in third-party viewers: the viewer must still show its image.

    failing_viewers.py UNDERSTUDY ENTRY-LIBRARY FAILING-CALLS PLACES

UNDERSTUDY_VIEWERS names the program that starts viewers (CONTRIBUTING.md, "Add a viewer"). PLACES allocations of each viewer
fail, one per run: half of them spread evenly over the first ones, in which the volume is recognised, and half over all. The
image must equal that of the viewer without Understudy, to 40 dB. FAILING-CALLS is the library that makes calls fail
(shortage/failing_calls.cc).
"""

import concurrent.futures
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

VIEWERS = ("osgvolume", "pyqtgraph")
FIRST_CALLS = 20000
FRAMES = 3
LEAST_DECIBELS = 40
PATIENCE_SECONDS = 600
AT_ONCE = 2
SKIPPED = 77
CRASH = re.compile(r"Segmentation fault|Aborted|terminate called|Bus error")


class Viewer:
    def __init__(self, understudy, libraries, script, name, folder):
        self.understudy, self.libraries, self.script, self.name, self.folder = understudy, libraries, script, name, folder

    def draw(self, image, before=""):
        environment = {name: value for name, value in os.environ.items() if not name.startswith("UNDERSTUDY")}
        environment |= {"WITH": before, "RES": "half", "XDG_RUNTIME_DIR": str(self.folder)}
        return subprocess.run([self.script, self.name, image, str(FRAMES)], env=environment, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace", timeout=PATIENCE_SECONDS, check=False)

    def under_shortage(self, image, words):
        return self.draw(image, f"env LD_PRELOAD={self.libraries} UNDERSTUDY_SPEED_GUARD=off FAIL_WHAT=memory {words}")

    def count(self):
        file = self.folder / f"{self.name}.count"
        self.under_shortage(self.folder / "unused.png", f"FAIL_COUNT={file}")
        return int.from_bytes(file.read_bytes(), "little")

    def trouble(self, bare, number):
        """An error message if the run with this failing allocation went wrong, and whether one failed."""
        image = self.folder / f"{self.name}.{number}.png"
        try:
            result = self.under_shortage(image, f"FAIL_NTH={number}")
        except subprocess.TimeoutExpired:
            return f"no end after {PATIENCE_SECONDS} s", True
        said = subprocess.run([self.understudy, "compare", bare, image], capture_output=True, text=True, check=False).stdout
        image.unlink(missing_ok=True)
        found = re.search(r"PSNR ([\d.]+|inf)", said)
        decibels = float(found[1]) if found else None
        good = result.returncode == 0 and decibels is not None and decibels >= LEAST_DECIBELS and not CRASH.search(result.stdout)
        return None if good else f"status {result.returncode}, PSNR {decibels}, {result.stdout[-300:]}", "A CALL FAILS" in result.stdout


def numbers_of(total, places):
    first = min(total, FIRST_CALLS)
    return sorted({first * i // places for i in range(0, places, 2)} | {total * i // places for i in range(1, places, 2)})


def main():
    understudy, entry, failing, places = sys.argv[1:]
    script = os.environ.get("UNDERSTUDY_VIEWERS")
    if script is None:
        print("UNDERSTUDY_VIEWERS does not name the program that starts viewers")
        return SKIPPED
    wrong, tried = [], 0
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(AT_ONCE) as workers:
        for name in VIEWERS:
            viewer = Viewer(understudy, f"{failing}:{entry}", script, name, Path(folder))
            bare = Path(folder) / f"{name}.bare.png"
            if viewer.draw(bare).returncode != 0:
                print(f"{name} does not run here")
                continue
            tried += 1
            total = viewer.count()
            numbers = numbers_of(total, int(places))
            answers = list(workers.map(lambda number, viewer=viewer, bare=bare: viewer.trouble(bare, number), numbers))
            bad = [f"{name}, allocation {number}: {said}" for number, (said, _) in zip(numbers, answers) if said]
            hits = sum(hit for _, hit in answers)
            print(f"{name}: {total} allocations, {len(answers)} runs, in {hits} one failed, {len(bad)} went wrong", flush=True)
            wrong += bad
    for line in wrong[:20]:
        print(line)
    return SKIPPED if tried == 0 else len(wrong) > 0


if __name__ == "__main__":
    sys.exit(main())
