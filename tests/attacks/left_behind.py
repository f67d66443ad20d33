# SPDX-License-Identifier: Apache-2.0
"""A program that draws a volume in one context after another and destroys each: their memory must be released.

    left_behind.py UNDERSTUDY CONTEXTS COUNT

CONTEXTS (contexts/contexts.cc) draws in COUNT contexts from glBegin, from buffers and from display lists. Every volume is
substituted, and no context may leave more than 20 KiB behind. In feedback mode, Mesa keeps what is drawn from.
"""

import os
import re
import subprocess
import sys
import tempfile

KINDS = ("immediate", "buffer", "list")
MOST_KIB = 20
TRIES = 3
PATIENCE_SECONDS = 3000


def trouble_with(words, environment, count):
    """An error message for one run; None if there is no error."""
    result = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=PATIENCE_SECONDS, check=False)
    left = re.search(r"(-?[\d.]+) KiB a context", result.stdout)
    shown = re.search(r"(\d+) substituted", result.stderr)
    print(f"{words[-2]}: {count} contexts, {left[1] if left else '?'} KiB a context left behind, "
          f"{shown[1] if shown else 0} frames substituted", flush=True)
    if result.returncode != 0 or left is None:
        return f"status {result.returncode}: {result.stderr}"
    if shown is None or int(shown[1]) < count:
        return f"not every volume was substituted: {result.stderr}"
    return f"{left[1]} KiB a context" if float(left[1]) > MOST_KIB else None


def main():
    understudy, contexts, count = sys.argv[1:]
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        environment = {name: value for name, value in os.environ.items() if not name.startswith("UNDERSTUDY")}
        environment |= {"EGL_PLATFORM": "surfaceless", "UNDERSTUDY_SPEED_GUARD": "off", "XDG_RUNTIME_DIR": folder}
        for kind in KINDS:
            # An allocator reserves or releases a megabyte now and then. Unlike a leak, this does not happen in every
            # run.
            for _ in range(TRIES):
                trouble = trouble_with([understudy, "run", "--", contexts, kind, count], environment, int(count))
                if trouble is None:
                    break
            else:
                wrong.append(f"{kind}: {trouble}")
    for line in wrong:
        print(line)
    return len(wrong) > 0


if __name__ == "__main__":
    sys.exit(main())
