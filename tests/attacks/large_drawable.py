# SPDX-License-Identifier: Apache-2.0
"""Traces whose drawable is larger than any window: the record is refused, and no memory is allocated for it.

    large_drawable.py UNDERSTUDY TRACE

A mutated trace claimed 7·10^16 pixels per side. It was played with 16,384, for which the driver allocated 2 GiB.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from trace_blocks import Trace, stable_id

MOST_MIB_MORE = 256
SIZES = [(16384, 16384), (16385, 1), (1, 2**63), (2**32, 2**32), (72057594037927939, 216172782113783808)]


def claiming(data, width, height):
    """The trace with a different size of its first drawable."""
    trace = Trace(data)
    for block in trace.blocks:
        for first, _ in block.records():
            if block.words[first] & 0xFFFFFFFF == stable_id("understudy.current"):
                block.words[first + 2 : first + 4] = [width, height]
                return trace.packed()
    raise SystemExit("no drawable becomes current in this trace")


def replayed(program, data):
    """The output, and the peak memory of a process in MiB."""
    with tempfile.NamedTemporaryFile(suffix=".ust") as trace, tempfile.TemporaryFile() as output:
        trace.write(data)
        trace.flush()
        process = subprocess.Popen([program, "replay", "--native", trace.name], stdout=subprocess.DEVNULL, stderr=output)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        return output.read().decode(), usage.ru_maxrss >> 10


def main():
    program, data = sys.argv[1], Path(sys.argv[2]).read_bytes()
    said, usual = replayed(program, data)
    if "larger than windows are" in said:
        raise SystemExit(f"the trace as it is was refused: {said}")
    for width, height in SIZES:
        said, mib = replayed(program, claiming(data, width, height))
        print(f"{width} x {height}: {mib} MiB, {usual} MiB as it is")
        if f"a drawable of {width} x {height} pixels is larger than windows are" not in said:
            raise SystemExit(f"was not refused: {said}")
        if mib > usual + MOST_MIB_MORE:
            raise SystemExit("took memory for it")


main()
