# SPDX-License-Identifier: Apache-2.0
"""How fast one core blends pixels, beside how fast it copies them, measured alternately.

Rows are PLACE/WAY (1e9 pixels a second) and PLACE/WAY/bytes (GB a second read and written, with the ratio to copying). PLACE
`cache` means images of 128^2 float RGBA pixels, `memory` images of 2048^2. A WAY named after a message blends directly from
the received message, or encodes the image into it.
"""

import json
import subprocess

import viewers


def rows():
    text = subprocess.run([str(viewers.PROGRAMS / "understudy-bench-blend")], stdout=subprocess.PIPE, text=True,
                          check=True).stdout
    found = [json.loads(line) for line in text.splitlines()]
    copy = {one["place"]: one for one in found if one["way"] == "copy"}
    result = []
    for one in found:
        name = f"{one['place']}/{one['way']}"
        moved = {"name": f"{name}/bytes", "value": one["pixels_per_second"] * one["bytes_per_pixel"] / 1e9, "unit": "GB/s"}
        if one["way"] != "copy":
            reference = copy[one["place"]]
            moved |= {"ratio_to": f"{one['place']}/copy/bytes",
                      "ratio": moved["value"] * 1e9 / (reference["pixels_per_second"] * reference["bytes_per_pixel"])}
        result += [{"name": name, "value": one["pixels_per_second"] / 1e9, "unit": "Gpixel/s"}, moved]
    return result
