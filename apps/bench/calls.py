# SPDX-License-Identifier: Apache-2.0
"""The cost that Understudy adds to a call: bare, through the entry library alone, with track, with units that only pass calls
on, and with track answering queries itself.

The program understudy-bench-calls measures single calls and a frame of 5,000 calls with Google Benchmark; glxgears counts its
frames. In each round all ways run one after the other; a value is the median over the rounds.
"""

import json
import os
import re
import statistics
import subprocess
import sys

import viewers
from display import VirtualDisplay

WAYS = {
    "bare": None,
    "door": "driver",
    "track": "track driver",
    "3 pass, track": "pass pass pass track driver",
    "default": "track volume driver",
    "answers": "track(answer=on) driver",
}
ROUNDS = 5
SECONDS = 0.2  # minimum time for each call in each round
GEARS_SECONDS = 40


def prefix(way):
    return [] if WAYS[way] is None else viewers.understudy("--chain", WAYS[way])


def call_times(way):
    """Returns the nanoseconds of each benchmark, as processor time, because other processes may be running."""
    text = subprocess.run(
        [*prefix(way), str(viewers.PROGRAMS / "understudy-bench-calls"), "--benchmark_format=json",
         f"--benchmark_min_time={SECONDS}"],
        env={**os.environ, **viewers.SOFTWARE}, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True).stdout
    unit = {"ns": 1, "us": 1e3, "ms": 1e6}
    return {b["name"]: b["cpu_time"] * unit[b["time_unit"]] for b in json.loads(text)["benchmarks"]}


def gears_frame_ms(way, display):
    """Returns the frame time of glxgears, which reports its frames every five seconds. The first line includes its
    start-up, so the second one counts.
    """
    gears = subprocess.Popen([*prefix(way), "glxgears"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                             env={**os.environ, **viewers.SOFTWARE, "DISPLAY": display, "vblank_mode": "0"})
    try:
        gears.stdout.readline()
        line = gears.stdout.readline()
    finally:
        gears.terminate()
        gears.wait(GEARS_SECONDS)
    counted = re.match(r"(\d+) frames in ([0-9.]+) seconds", line)
    if not counted:
        raise viewers.ViewerFailed(f"glxgears did not count its frames, it said: {line!r}")
    return 1000 * float(counted[2]) / int(counted[1])


def rows():
    times = {way: {} for way in WAYS}
    with VirtualDisplay() as display:
        for number in range(ROUNDS):
            for way in WAYS:
                print(f"  round {number + 1} of {ROUNDS}, {way}", file=sys.stderr, flush=True)
                for name, ns in call_times(way).items():
                    times[way].setdefault(name, []).append(ns)
                times[way].setdefault("glxgears frame", []).append(1e6 * gears_frame_ms(way, display))
    result = []
    for name in times["bare"]:
        bare = statistics.median(times["bare"][name])
        for way in WAYS:
            value = statistics.median(times[way][name])
            row = {"name": f"calls/{name}/{way}", "value": value, "unit": "ns"}
            if way != "bare":
                row |= {"ratio_to": f"calls/{name}/bare", "ratio": value / bare, "difference": value - bare}
            result.append(row)
    return result
