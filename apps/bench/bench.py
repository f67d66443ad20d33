#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""./run bench [NAME…]: runs benchmarks, prints their rows, and writes out/bench/NAME.json.

Every row has name, value and unit. Where they apply, it also has ratio_to (the name of another row), ratio (value / that
row's value), difference (value - that row's value), and rms (error against that row's image). Each benchmark explains its
other fields.
"""

import json
import os
import platform
import re
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(HERE.parent / "demo")]
import balance  # noqa: E402
import blend  # noqa: E402
import calls  # noqa: E402
import exchange  # noqa: E402
import frame  # noqa: E402
import hierarchy  # noqa: E402
import paraview_frames  # noqa: E402
import ranks  # noqa: E402
import raycast  # noqa: E402
import remote  # noqa: E402
import scaling  # noqa: E402
import shares  # noqa: E402
import sort  # noqa: E402
import view  # noqa: E402

BENCHMARKS = {"frame": frame.rows, "raycast": raycast.rows, "calls": calls.rows, "scaling": scaling.rows,
              "ranks": ranks.rows, "balance": balance.rows, "blend": blend.rows, "exchange": exchange.rows,
              "paraview": paraview_frames.rows, "shares": shares.rows, "sort": sort.rows, "remote": remote.rows, "hierarchy": hierarchy.rows, "view": view.rows}

INSTRUCTION_SETS = [("avx512f", "AVX-512"), ("avx2", "AVX2"), ("sse4_1", "SSE4"), ("asimd", "NEON")]  # best first


def processor():
    """Returns the model name and the flags, from /proc/cpuinfo."""
    text = Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace")
    model = re.search(r"^model name\s*:\s*(.*)$", text, re.MULTILINE)
    flags = re.search(r"^(?:flags|Features)\s*:\s*(.*)$", text, re.MULTILINE)
    return model.group(1) if model else platform.machine(), flags.group(1).split() if flags else []


def machine():
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return f"{processor()[0]}, {os.cpu_count()} cores, {memory:.0f} GiB, {platform.system()} {platform.release()}"


def instruction_set():
    flags = processor()[1]
    return next((name for flag, name in INSTRUCTION_SETS if flag in flags), platform.machine())


def compiler():
    cache = (ROOT / "build" / "CMakeCache.txt").read_text(encoding="utf-8")
    program = re.search(r"^CMAKE_CXX_COMPILER:\w+=(.*)$", cache, re.MULTILINE).group(1)
    return subprocess.run([program, "--version"], stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()[0]


def text_of(row):
    text = f"{row['name']:40} {row['value']:12.3f} {row['unit']}"
    if "ratio" in row:
        text += f"   {row['ratio']:7.3f} x {row['ratio_to']}"
    if "difference" in row:
        text += f"   {row['difference']:+.1f} {row['unit']}"
    if "bytes_up" in row:
        text += f"   {row['bytes_up']:9.0f} bytes up {row['bytes_down']:9.0f} down {row['round_trips']:5.1f} round trips"
    if "rms" in row:
        text += f"   RMS {row['rms']:.2e}"
    if "rms_arithmetic" in row:
        text += f"   RMS {row['rms_arithmetic']:.1e} of arithmetic"
    if "rms_total" in row:
        text += f", {row['rms_total']:.1e} in all"
    return text


def main(names):
    sizes = []
    if "--sizes" in names:
        at = names.index("--sizes")
        text = ",".join(names[at + 1:at + 2])
        if not re.fullmatch(r"\d+(,\d+)*", text) or any(int(side) % frame.SIDE or not int(side) for side in text.split(",")):
            sys.exit(f"bench: --sizes {text}: give multiples of {frame.SIDE}, as in --sizes 256,512")
        sizes = sorted(int(side) for side in text.split(","))
        names = ["raycast"]
    unknown = [name for name in names if name not in BENCHMARKS]
    if unknown:
        sys.exit(f"bench: no benchmark named {', '.join(unknown)}; there are: {', '.join(BENCHMARKS)}")
    folder = ROOT / "out" / "bench"
    folder.mkdir(parents=True, exist_ok=True)
    for name in names or BENCHMARKS:
        print(f"{name}: {machine()}; {instruction_set()}; {compiler()}", flush=True)
        rows = []
        for row in BENCHMARKS[name](sizes) if sizes else BENCHMARKS[name]():
            print(text_of(row), flush=True)
            rows.append(row)
        path = folder / (f"{name}-sizes.json" if sizes else f"{name}.json")
        path.write_text(json.dumps({"machine": machine(), "compiler": compiler(), "instruction_set": instruction_set(),
                                    "rows": rows}, indent=1), encoding="utf-8")
        print(path)


if __name__ == "__main__":
    main(sys.argv[1:])
