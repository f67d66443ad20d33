#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes docs/images/before-after.png from what `./run demo` has left in out/demo: images and times of one run.

    ./run demo && python3 docs/images/before_after.py

Needs ImageMagick's convert, which `./run demo` installs."""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DEMO = ROOT / "out" / "demo"
VIEWER = "understudy-viewer --mode table"
CAPTIONS = {"bare": "before: the viewer alone", "embedded": "after: understudy run -- viewer"}


def panel(shot, bare):
    text = f"{CAPTIONS[shot['run']]}\n{shot['frame_ms']:.0f} ms a frame"
    if shot is not bare:
        text += f", {shot['difference_to_bare']['psnr']:.0f} dB"
    return ["(", str(DEMO / shot["image"]), "-resize", "400x400",
            "-gravity", "center", "-crop", "400x270+0+0", "+repage", "-background", "white", "-gravity", "south",
            "-splice", "0x52", "-font", "DejaVu-Sans", "-pointsize", "17", "-fill", "black", "-annotate", "+0+5", text, ")"]


def main():
    scenes = json.loads((DEMO / "report.json").read_text(encoding="utf-8"))["scenes"]
    shots = {shot["run"]: shot for scene in scenes if scene["viewer"] == VIEWER for shot in scene["runs"]}
    target = ROOT / "docs" / "images" / "before-after.png"
    subprocess.run(["convert", *panel(shots["bare"], shots["bare"]), *panel(shots["embedded"], shots["bare"]),
                    "+append", "-strip", "-colors", "255", f"PNG8:{target}"], check=True)
    print(f"{target}: {target.stat().st_size} bytes")


if __name__ == "__main__":
    sys.exit(main())
