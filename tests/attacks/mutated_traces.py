# SPDX-License-Identifier: Apache-2.0
"""Mutated traces through replay, trim and print: no crash of Understudy, no hang, no excessive memory.

    mutated_traces.py UNDERSTUDY COUNT SEED TRACE...

A crash of the driver is reported by status 5 and the call (apps/understudy/gl_server/guarded_player.h); such runs are counted
and listed. Any result other than success, a refusal or a driver crash is a failure, and so is a process that takes 1 GiB more
than the largest process takes for the unmodified traces.
"""

import collections
import os
import random
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from trace_blocks import Trace

MOST_KIB_MORE = 1 << 20
LIMIT_S = 120  # detects hangs; nothing here takes a second
REFUSED = (0, 1, 2)
DRIVER_CRASHED = 5

EXTREMES = [0, 1, 2, 3, 2**64 - 1, 2**31 - 1, 2**31, 2**32 - 1, 2**63 - 1, 2**63, 2**32, 2**20, 2**16, 65535, 4096, 16384, 2**40,
            *(kind << 56 for kind in range(1, 7)), 0x0DE1, 0x806F, 0x1401, 0x1406, 0x8892, 0x88EC]


def bytes_changed(data, chance):
    changed = bytearray(data)
    for _ in range(chance.choice([1, 2, 8, 64])):
        changed[chance.randrange(len(changed))] = chance.randrange(256)
    if chance.random() < 0.3:
        del changed[chance.randrange(len(changed)):]
    return bytes(changed)


def other_word(word, chance):
    return chance.choice([
        chance.choice(EXTREMES), word ^ 1 << chance.randrange(64), word + chance.choice([-1, 1, 2, -2, 100, -100]),
        word * chance.choice([2, 3, 16, 1000])]) % 2**64


def change_argument(block, records, chance):
    first, length = chance.choice(records)
    if length > 1:
        at = first + 1 + chance.randrange(min(length - 1, 12))
        block.words[at] = other_word(block.words[at], chance)


def change_id(block, records, chance):
    first, other = chance.choice(records)[0], chance.choice(records)[0]
    block.words[first] = block.words[first] >> 32 << 32 | block.words[other] & 0xFFFFFFFF


def change_length(block, records, chance):
    first, length = chance.choice(records)
    wrong = length + chance.choice([-1, 1, 2, 1000, 0xFFFFFFF]) & 0xFFFFFFFF
    block.words[first] = block.words[first] & 0xFFFFFFFF | wrong << 32


def remove_record(block, records, chance):
    first, length = chance.choice(records)
    del block.words[first : first + length]
    block.record_words -= length


def repeat_record(block, records, chance):
    first, length = chance.choice(records)
    at = chance.choice(records)[0]
    block.words[at:at] = block.words[first : first + length]
    block.record_words += length


def change_word(block, records, chance):
    at = chance.randrange(len(block.words))
    block.words[at] = other_word(block.words[at], chance)


CHANGES = [(change_argument, 45), (change_id, 10), (change_length, 7), (remove_record, 6), (repeat_record, 7), (change_word, 25)]


def mutated(data, chance):
    if chance.random() < 0.12:
        return bytes_changed(data, chance)
    trace = Trace(data)
    block = chance.choice(trace.blocks)
    for _ in range(chance.choice([1, 1, 1, 2, 4, 16])):
        records = block.records()
        if not records:
            break
        change, = chance.choices([c for c, _ in CHANGES], [w for _, w in CHANGES])
        change(block, records, chance)
    return trace.packed()


def ended(process):
    """(exit status or "hangs", peak memory in KiB of the process or its children)"""
    give_up = time.monotonic() + LIMIT_S
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            process.returncode = os.waitstatus_to_exitcode(status)
            return process.returncode, usage.ru_maxrss
        if time.monotonic() > give_up:
            process.kill()
            process.wait()
            return "hangs", 0
        time.sleep(0.01)


def ending(program, command):
    # LeakSanitizer would report the driver's leaks; only crashes are of interest here.
    environment = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0:intercept_tls_get_addr=0"}
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen([program, *command], stdout=subprocess.DEVNULL, stderr=output, env=environment)
        status, kib = ended(process)
        output.seek(0)
        said = output.read().decode(errors="replace")
    if "AddressSanitizer" in said or "runtime error" in said:
        status = "sanitizer"
    return status, said, kib


def play(program, data, name, folder):
    """(name, command, ending, output, KiB) of the three commands."""
    trace, out = folder / f"{name}.ust", folder / f"{name}.out"
    trace.write_bytes(data)
    commands = [["replay", "--native", trace], ["trim", trace, "--frames", "2-2", "-o", out], ["print", trace]]
    endings = [(name, command[0], *ending(program, command)) for command in commands]
    trace.unlink()
    out.unlink(missing_ok=True)
    return endings


def play_mutated(program, data, seed, folder):
    return play(program, mutated(data, random.Random(seed)), seed, folder)


def main():
    program, count, seed = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    traces = [Path(name).read_bytes() for name in sys.argv[4:]]
    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor(2) as pool:
        folder = Path(name)
        usual_kib = max(kib for trace in traces for *_, kib in play(program, trace, "whole", folder))
        jobs = [pool.submit(play_mutated, program, traces[i % len(traces)], seed + i, folder) for i in range(count)]
        endings = []
        for number, job in enumerate(jobs, 1):
            endings += job.result()
            if number % 100 == 0:
                print(f"{number} of {count} traces", flush=True)
    totals = collections.Counter((command, status) for _, command, status, _, _ in endings)
    for (command, status), number in sorted(totals.items(), key=str):
        print(f"{command}: {number} times {status}")
    for number, command, status, said, _ in endings:
        if status == DRIVER_CRASHED:
            print(f"seed {number}, {command}: {next(line for line in said.splitlines() if 'with signal' in line)}")
    number, command, _, _, kib = max(endings, key=lambda ending: ending[4])
    print(f"the largest process: {kib >> 10} MiB (seed {number}, {command}); for the traces as they are {usual_kib >> 10} MiB")
    wrong = [ending for ending in endings if ending[2] not in (*REFUSED, DRIVER_CRASHED) or ending[4] > usual_kib + MOST_KIB_MORE]
    for number, command, status, said, kib in wrong[:5]:
        print(f"seed {number}, {command}: {status}, {kib >> 10} MiB\n{said[-4000:]}")
    if wrong:
        raise SystemExit(f"{len(wrong)} of {len(endings)} runs ended as none should")


main()
