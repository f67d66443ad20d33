# SPDX-License-Identifier: Apache-2.0
"""How fast hierarchical volumes are written and read, on one core and on all in turn, and how small they are.

Rows are VOLUME/build/CORES and VOLUME/read/CORES (MB of the volume's scalars a second, with the ratio to one core), and
VOLUME/size/KIND (size of the file as a fraction of the scalars' bytes, with the ratio to Zstandard at level 19). KIND is
`lossless`, or `1/255`: the error of every value is at most that fraction of the range.
"""

import json
import statistics
import subprocess

import viewers

SHARED = viewers.ROOT.parent / "shared" / "data"
# Name, file, and the range of the values.
VOLUMES = [("engine", viewers.engine_volume(), 255), ("lobes", "synthetic:192x192x192:f32:lobes", None),
           ("heptane", SHARED / "heptane_302x302x302_uint8.nii.gz", 255),
           ("cthead", SHARED / "cthead_256x256x113_int16be.raw.gz", 4095)]


def measured(volume, *options):
    text = subprocess.run([str(viewers.PROGRAMS / "understudy-bench-hierarchy"), str(volume), *options], stdout=subprocess.PIPE,
                          text=True, check=True).stdout
    return [json.loads(line) for line in text.splitlines()]


def rows():
    result = []
    for name, volume, value_range in VOLUMES:
        if not str(volume).startswith("synthetic:") and not volume.is_file():
            continue
        found = measured(volume, "--zstd")
        turns = [one for one in found if "turn" in one]
        for what in ("build", "read"):
            speeds = {cores: statistics.median(one[f"{what}_bytes_per_second"] for one in turns if one["cores"] == cores)
                      for cores in sorted({one["cores"] for one in turns})}
            for cores, speed in speeds.items():
                row = {"name": f"{name}/{what}/{cores}", "value": speed / 1e6, "unit": "MB/s"}
                if cores > 1:
                    row |= {"ratio_to": f"{name}/{what}/1", "ratio": speed / speeds[1]}
                result.append(row)
        zstd = {one["zstd"]: one["part_of_scalars"] for one in found if "zstd" in one}
        for level, part in zstd.items():
            result.append({"name": f"{name}/size/zstd -{level}", "value": part, "unit": "of 1"})
        sizes = {"lossless": turns[0]["part_of_scalars"]}
        if value_range:
            sizes["1/255"] = measured(volume, "--turns", "1", "--max-error", str(value_range / 255))[0]["part_of_scalars"]
        for kind, part in sizes.items():
            result.append({"name": f"{name}/size/{kind}", "value": part, "unit": "of 1", "ratio_to": f"{name}/size/zstd -19",
                           "ratio": part / zstd[19]})
    return result
