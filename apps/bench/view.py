# SPDX-License-Identifier: Apache-2.0
"""Time from a rotation of the camera to its image, through `understudy view --web`, on the CT of an engine at 512^2.

A small client speaks WebSocket as the page does, one request at a time, and does not decode images. Rows are
NODES/WAY/median, late (95th percentile), cast, pack, bytes and pixels. lossless is PNG; jpeg is JPEG of all pixels; moving is
what a page gets while the user drags: as many pixels as 50 ms allow. The ways are measured in turn; a value is the median
over the rounds.
"""

import json
import re
import statistics
import subprocess

import viewers

NODES = {"embedded": [], "2 ranks": ["-n", "2"]}


def rows():
    result = []
    for name, nodes in NODES.items():
        command = [str(viewers.PROGRAMS / "understudy"), "view", "--web", "0", *nodes, "--transfer-function", "engine", "--size", "512x512",
                   "--volume-size", "256", "256", "110", "--type", "u8", str(viewers.engine_volume())]
        view = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        try:
            port, secret = re.search(r":(\d+)/#secret=(\w+)", view.stdout.readline()).groups()
            text = subprocess.run([str(viewers.PROGRAMS / "understudy-bench-view"), port, secret],
                                  stdout=subprocess.PIPE, text=True, check=True).stdout
        finally:
            view.terminate()
            view.wait()
        found = [json.loads(line) for line in text.splitlines()]
        for way in ("lossless", "jpeg", "moving"):
            mine = [one for one in found if one["way"] == way]
            for key, unit in (("median_ms", "ms"), ("late_ms", "ms"), ("cast_ms", "ms"), ("pack_ms", "ms"), ("bytes", "bytes"),
                              ("pixels", "pixels")):
                value = statistics.median(one[key] for one in mine)
                result.append({"name": f"{name}/{way}/{key.removesuffix('_ms')}", "value": value, "unit": unit})
    return result
