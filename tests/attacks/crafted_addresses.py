# SPDX-License-Identifier: Apache-2.0
"""Traces whose calls contain crafted addresses: replay, trim and print must refuse them and name the call.

    crafted_addresses.py UNDERSTUDY TRACE
"""

import subprocess
import sys
import tempfile
from pathlib import Path

from trace_blocks import Trace, stable_id

ADDRESS = 3 << 56  # spu/stream/record.h: ReferenceKind::address
EVIL = 0x414141414141

# Position of the pointer argument, counted from 1.
CALLS = [("glTexImage3D", 10), ("glLoadMatrixf", 1), ("glGenTextures", 2), ("glShaderSource", 3), ("glGetUniformLocation", 2)]


def crafted(data, call, argument):
    """The trace with that pointer in every such call, and the number of these calls."""
    trace, count = Trace(data), 0
    for block in trace.blocks:
        for first, length in block.records():
            if block.words[first] & 0xFFFFFFFF == stable_id(call) and length > argument:
                block.words[first + argument] = ADDRESS | EVIL
                count += 1
    return trace.packed(), count


def check(program, folder, call):
    trace, out = folder / "crafted.ust", folder / "out.ust"
    for command in (["replay", "--native", trace], ["trim", trace, "--frames", "1-2", "-o", out], ["print", trace]):
        ended = subprocess.run([program, *command], capture_output=True, text=True, timeout=120)
        said = ended.stdout + ended.stderr
        if ended.returncode != 0 or not any(f"{call}: " in line for line in said.splitlines()):
            # Print shows such arguments as offsets, because it does not know what is bound.
            if command[0] == "print" and ended.returncode == 0 and f"{call}(" in said:
                continue
            raise SystemExit(f"{command[0]}, {call}: status {ended.returncode}\n{said[-2000:]}")


def main():
    program, data = sys.argv[1], Path(sys.argv[2]).read_bytes()
    tried = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for call, argument in CALLS:
            packed, count = crafted(data, call, argument)
            if count == 0:
                continue
            (folder / "crafted.ust").write_bytes(packed)
            check(program, folder, call)
            tried += 1
    print(f"{tried} of {len(CALLS)} calls are in the trace; each was refused by name")
    if tried < 3:
        raise SystemExit("the trace has too few of these calls")


main()
