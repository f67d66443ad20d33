#!/usr/bin/env python3
"""Records the bundled viewer into traces/ and the pictures of a native replay into expected/.

    record_traces.py BUILD/bin [NAME...]     NAME: rgba, table, core; without names all of them

The volume is made here. version_1.ust is not touched: see README.md.
"""
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
SIDE = 20


def texel(i, j, k):
    """A shell with a bump: smooth, and different from all sides."""
    x, y, z = ((c + 0.5) / SIDE - 0.5 for c in (i, j, k))
    radius = math.sqrt(x * x + 1.3 * y * y + z * z)
    return int(255 * math.exp(-60 * (radius - 0.3) ** 2) * (0.6 + 0.4 * math.sin(9 * x + 4 * z)))


def main():
    programs = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        volume = pathlib.Path(folder) / f"shell.{SIDE}x{SIDE}x{SIDE}"
        volume.write_bytes(bytes(texel(i, j, k) for k in range(SIDE) for j in range(SIDE) for i in range(SIDE)))
        for name in sys.argv[2:] or ("rgba", "table", "core"):
            trace = HERE / "traces" / f"{name}.ust"
            subprocess.run([programs / "understudy", "run", "--chain", "driver", "--trace", trace, "--",
                            programs / "understudy-viewer", volume, "--mode", name, "--offscreen",
                            "--window-size", "160", "128", "--frames", "3", "--orbit", "25"], check=True)
            frames = pathlib.Path(folder) / name
            subprocess.run([programs / "understudy", "replay", "--native", "--save-frames", frames, trace], check=True)
            for number in range(1, 4):
                shutil.copyfile(frames / f"frame_{number:04}.png", HERE / "expected" / f"{name}_{number}.png")


if __name__ == "__main__":
    os.umask(0o022)
    main()
