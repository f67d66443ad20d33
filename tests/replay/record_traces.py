#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Records the bundled viewer into traces/ and the images of a native replay into expected/.

    record_traces.py BUILD/bin [NAME...]     without names all of them (WAYS below)

The volumes are generated here. The volume of the traces that traces_test.cc compares with a drawing in double precision is
kept: traces/judged.14x14x14. version_1.ust is not touched: see README.md.
"""
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent

FIRST_WAYS = {name: ["--mode", name, "--window-size", "160", "128", "--frames", "3"] for name in ("rgba", "table", "core")}
# The same as in traces_test.cc.
JUDGED_WAYS = {
    "under": ["--mode", "table", "--operator", "under"],
    "max": ["--mode", "core", "--operator", "max"],
    "min": ["--mode", "rgba", "--operator", "min"],
    "add": ["--mode", "table", "--operator", "add"],
    "opaque": ["--mode", "core", "--opaque"],
    "second": ["--mode", "rgba", "--second"],
    "time": ["--mode", "time"],
}
JUDGED = ["--preset", "engine", "--no-frame", "--background", "0.2", "0.4", "0.6", "--window-size", "96", "80",
          "--slices", "20", "--frames", "2"]


def texel(place, sides, least):
    """A shell with a bump: smooth, and different from every side."""
    x, y, z = ((c + 0.5) / side - 0.5 for c, side in zip(place, sides))
    radius = math.sqrt(x * x + 1.3 * y * y + z * z)
    shell = math.exp(-60 * (radius - 0.3) ** 2) * (0.6 + 0.4 * math.sin(9 * x + 4 * z))
    return int(least + (255 - least) * shell)


def volume(*sides, least=0):
    x, y, z = map(range, sides)
    return bytes(texel((i, j, k), sides, least) for k in z for j in y for i in x)


def main():
    programs = pathlib.Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        shell = pathlib.Path(folder) / "shell.20x20x20"
        shell.write_bytes(volume(20, 20, 20))
        judged = HERE / "traces" / "judged.14x14x14"
        if not judged.exists():
            judged.write_bytes(volume(14, 14, 14, least=30))
        ways = {name: [shell, *options] for name, options in FIRST_WAYS.items()}
        ways.update({name: [judged, *options, *JUDGED] for name, options in JUDGED_WAYS.items()})
        # The viewer's bricks are 64 texels long, so it takes a longer volume to have two of them.
        rod = pathlib.Path(folder) / "rod.72x12x12"
        rod.write_bytes(volume(72, 12, 12))
        ways["bricks"] = [rod, "--mode", "bricks", *JUDGED]
        ways["preint"] = [shell, "--mode", "preint", *JUDGED]
        ways["lit"] = [shell, "--mode", "lit", *JUDGED]
        # Fewer than sixteen textures in a row are not recognised, so this volume is larger.
        ways["stacks"] = [shell, "--mode", "stacks", *JUDGED]
        for name in sys.argv[2:] or ways:
            trace = HERE / "traces" / f"{name}.ust"
            subprocess.run([programs / "understudy", "run", "--chain", "driver", "--trace", trace, "--",
                            programs / "understudy-viewer", *ways[name], "--offscreen", "--orbit", "25"], check=True)
            frames = pathlib.Path(folder) / name
            subprocess.run([programs / "understudy", "replay", "--native", "--save-frames", frames, trace], check=True)
            for image in sorted(frames.glob("frame_*.png")):
                number = int(image.stem.removeprefix("frame_"))
                shutil.copyfile(image, HERE / "expected" / f"{name}_{number}.png")


if __name__ == "__main__":
    os.umask(0o022)
    main()
