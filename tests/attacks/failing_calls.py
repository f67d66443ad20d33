# SPDX-License-Identifier: Apache-2.0
"""Makes one allocation, or one system call, of Understudy fail: the viewer must still show its image.

    failing_calls.py UNDERSTUDY UNDERSTUDY-VIEWER ENTRY-LIBRARY FAILING-CALLS PLACES

The bundled viewer draws three frames: in four modes alone, and in one of them with a render node. PLACES of its allocations
fail, one per run, spread evenly over all of them; likewise its reads, writes, mappings, sockets and threads, which are fewer.
Status and image must equal those of the viewer without Understudy, to 40 dB. FAILING-CALLS is the library that makes calls
fail (shortage/failing_calls.cc).
"""

import concurrent.futures
import os
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path

SIDE = 41
WAYS = (("table", 0), ("rgba", 0), ("core", 0), ("bricks", 0), ("rgba", 1))  # viewer mode, and number of nodes
LEAST_DECIBELS = 40
PATIENCE_SECONDS = 600  # for a busy machine; a viewer takes half a second
AT_ONCE = 2


class Viewer:
    def __init__(self, understudy, viewer, entry, failing, folder):
        self.understudy, self.viewer, self.folder = understudy, viewer, folder
        self.entry, self.failing = entry, failing
        self.volume = folder / f"volume.{SIDE}x{SIDE}x{SIDE}"
        blurred = random.Random(1).randbytes(SIDE)
        self.volume.write_bytes(bytes(blurred[x] // 4 + 3 * min(x, y, z) for z in range(SIDE) for y in range(SIDE) for x in range(SIDE)))

    def draw(self, mode, image, before=(), **environment):
        words = [*before, self.viewer, self.volume, "--size", SIDE, SIDE, SIDE, "--type", "u8", "--offscreen", "--frames", 3, "--orbit", 5,
                 "--window-size", 200, 200, "--mode", mode, "--screenshot", image]
        everything = {name: value for name, value in os.environ.items() if not name.startswith("UNDERSTUDY")}
        everything |= {"UNDERSTUDY_SPEED_GUARD": "off", "UNDERSTUDY_CONTROL": "on", "XDG_RUNTIME_DIR": str(self.folder)} | environment
        return subprocess.run([str(word) for word in words], env=everything, capture_output=True, text=True, errors="replace",
                              timeout=PATIENCE_SECONDS, check=False)

    def bare(self, mode):
        image = self.folder / f"{mode}.png"
        result = self.draw(mode, image)
        if result.returncode != 0:
            raise SystemExit(f"the viewer itself does not draw:\n{result.stderr}")
        return image

    def draw_under_shortage(self, mode, nodes, image, **environment):
        if nodes == 0:
            return self.draw(mode, image, LD_PRELOAD=f"{self.failing} {self.entry}", **environment)
        # The auditor's libraries are loaded into a separate namespace, where the library of failing calls would not
        # affect them.
        launcher = [self.understudy, "run", "--injection", "preload", "-n", nodes, "--"]
        return self.draw(mode, image, launcher, LD_PRELOAD=self.failing, **environment)

    def count(self, mode, nodes, what):
        """The number of such calls if none fails."""
        file = self.folder / "count"
        file.unlink(missing_ok=True)
        self.draw_under_shortage(mode, nodes, self.folder / "unused.png", FAIL_WHAT=what, FAIL_COUNT=str(file))
        return int.from_bytes(file.read_bytes(), "little")

    def difference(self, image, other):
        if not other.exists():
            return None
        said = subprocess.run([self.understudy, "compare", image, other], capture_output=True, text=True, check=False).stdout
        found = re.search(r"PSNR ([\d.]+|inf)", said)
        return float(found[1]) if found else None

    def trouble(self, mode, nodes, bare, what, number):
        """An error message if the run with this failing call went wrong, and whether a call failed."""
        image = self.folder / f"{mode}.{nodes}.{what}.{number}.png"
        try:
            result = self.draw_under_shortage(mode, nodes, image, FAIL_WHAT=what, FAIL_NTH=str(number))
        except subprocess.TimeoutExpired:
            return f"no end after {PATIENCE_SECONDS} s", True
        decibels = self.difference(bare, image)
        image.unlink(missing_ok=True)
        failed = "A CALL FAILS" in result.stderr
        if result.returncode == 0 and decibels is not None and decibels >= LEAST_DECIBELS:
            return None, failed
        last = [line for line in result.stderr.splitlines() if "A CALL FAILS" not in line][-2:]
        return f"status {result.returncode}, PSNR {decibels}, {last}", failed


def main():
    understudy, viewer, entry, failing, places = sys.argv[1:]
    wrong, runs, failed = [], 0, 0
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(AT_ONCE) as workers:
        drawn = Viewer(understudy, viewer, entry, failing, Path(folder))
        for mode, nodes in WAYS:
            bare = drawn.bare(mode)
            for what in ("memory", "system"):
                total = drawn.count(mode, nodes, what)
                step = max(1, total // int(places))
                numbers = range(step // 2, total, step)
                answers = list(workers.map(lambda number: drawn.trouble(mode, nodes, bare, what, number), numbers))
                way = f"{mode} with {nodes} nodes"
                bad = [f"{way}, {what} {number}: {said}" for number, (said, _) in zip(numbers, answers) if said]
                wrong += bad
                runs += len(answers)
                failed += sum(hit for _, hit in answers)
                print(f"{way}: {total} calls for {what}, {len(answers)} runs, {len(bad)} went wrong", flush=True)
    for line in wrong[:20]:
        print(line)
    # Threads divide the work differently in each run, so the last numbers are not always reached.
    if failed < 0.9 * runs:
        raise SystemExit(f"only in {failed} of {runs} runs a call failed")
    return len(wrong) > 0


if __name__ == "__main__":
    sys.exit(main())
