# SPDX-License-Identifier: Apache-2.0
"""Exchanges of partial images on 2, 4 and 8 MPI ranks of this machine, beside IceT's on the same images, alternately.

Rows are RANKS/SCENE/WAY/time (ms of the slowest rank, median over rounds), /bytes (MB that all ranks send, counted in MPI
below both libraries) and /messages. Scenes are full (every pixel touched on every rank), sparse (boxes of the kd-tree, mostly
clear) and noise (like full, of random numbers), on 1024^2 pixels, or on 512^2 where the name says so. `icet` is the best of
IceT's strategies, chosen separately for each row, which names it. max is the largest error of any component against the
product in double precision.
"""

import json
import os
import subprocess
import sys

import viewers
from frame import SIDE, cube

RANKS = (2, 4, 8)
PIXELS = (512, 1024)
ROUNDS = 15
PROGRAM = viewers.PROGRAMS / "understudy-bench-exchange"
WITHOUT_ICET = """exchange: no rows for IceT; to have them (70 MB to fetch, nothing is installed):
  mkdir -p build/icet && cd build/icet && apt-get download paraview-dev paraview &&
  for package in *.deb; do dpkg -x "$package" .; done && cd ../.. && cmake --preset release"""


def measured(ranks):
    """Runs the program on this number of ranks, started as the launcher starts nodes; returns what it prints."""
    environment = os.environ | {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    text = subprocess.run(["mpirun", "-n", str(ranks), "--oversubscribe", "--bind-to", "none", "--mca",
                           "mpi_yield_when_idle", "1", "--mca", "plm", "isolated", "--mca", "btl", "self,vader",
                           str(PROGRAM), str(cube()), "--side", str(SIDE), "--pixels", ",".join(map(str, PIXELS)),
                           "--rounds", str(ROUNDS)],
                          stdout=subprocess.PIPE, text=True, check=True, env=environment,
                          timeout=viewers.RUN_SECONDS).stdout
    return [json.loads(line) for line in text.splitlines()]


def rows_of(group, found):
    """Returns the rows of one scene; `found` is what the program printed, in the order of its ways."""
    measures = {"time": ("ms", "ms", 1), "bytes": ("bytes", "MB", 1e6), "messages": ("messages", "messages", 1)}
    ours = [one for one in found if not one["way"].startswith("icet/")]
    theirs = [one for one in found if one["way"].startswith("icet/")]
    result = []
    for measure, (key, unit, scale) in measures.items():
        name, best = f"{group}/icet/{measure}", None
        if theirs:
            best = min(theirs, key=lambda one: one[key])
            result.append({"name": name, "value": best[key] / scale, "unit": unit,
                           "strategy": best["way"].removeprefix("icet/"), "max": best["error"]})
        for one in ours:
            row = {"name": f"{group}/{one['way']}/{measure}", "value": one[key] / scale, "unit": unit, "max": one["error"]}
            if best is not None and best[key] > 0:
                row |= {"ratio_to": name, "ratio": one[key] / best[key]}
            result.append(row)
    # Also list all of IceT's strategies, so that readers can check the choice.
    result += [{"name": f"{group}/{one['way']}/time", "value": one["ms"], "unit": "ms", "bytes": one["bytes"],
                "messages": one["messages"], "max": one["error"]} for one in theirs]
    return result


def rows():
    if not PROGRAM.exists():
        print("exchange: there is no MPI here, install libopenmpi-dev and openmpi-bin", file=sys.stderr)
        return []
    result = []
    for ranks in RANKS:
        print(f"  {ranks} ranks", file=sys.stderr, flush=True)
        scenes = {}
        for one in measured(ranks):
            size = "" if one["pixels"] == max(PIXELS) else f" {one['pixels']}"
            scenes.setdefault(f"{ranks} ranks/{one['scene']}{size}", []).append(one)
        for group, found in scenes.items():
            result += rows_of(group, found)
    if not any("/icet/" in row["name"] for row in result):
        print(WITHOUT_ICET, file=sys.stderr)
    return result
