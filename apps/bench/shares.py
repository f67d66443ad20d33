# SPDX-License-Identifier: Apache-2.0
"""What a client of `understudy serve` gets beside others: images a second alone, beside a client whose requests exceed the
limit and are refused, and beside one that continuously requests as much as the limit allows.

Each round runs all turns one after another. A value is the median over the rounds; a ratio is the median of the rounds'
ratios.
"""

import json
import statistics
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import viewers

NODES = 2
ROUNDS = 3
PATIENCE_SECONDS = 60


def wait_for_nodes(server):
    """Waits until `serve` prints where its nodes are, which it does once they are ready."""
    timer = threading.Timer(PATIENCE_SECONDS, server.kill)
    timer.start()
    try:
        line = server.stdout.readline()
    finally:
        timer.cancel()
    if "nodes at" not in line:
        sys.exit(f"bench: understudy serve has started no nodes within {PATIENCE_SECONDS} s: {line.strip()}")


def measured_turns():
    turns = []
    with tempfile.TemporaryDirectory() as folder:
        socket = Path(folder) / "nodes.sock"
        server = subprocess.Popen([viewers.PROGRAMS / "understudy", "serve", "-n", str(NODES), "--socket", socket],
                                  stdout=subprocess.PIPE, text=True)
        try:
            wait_for_nodes(server)
            command = [viewers.PROGRAMS / "understudy-bench-shares", "--socket", socket, "--rounds", str(ROUNDS)]
            with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as client:
                for line in client.stdout:
                    turns.append(json.loads(line))
                    turn = turns[-1]
                    print(f"  {turn['size']} images beside {turn['beside']}: {turn['images']} in {turn['seconds']:.1f} s",
                          file=sys.stderr, flush=True)
            if client.returncode:
                sys.exit("bench: understudy-bench-shares has failed")
        finally:
            server.terminate()
            server.wait()
    return turns


def rows():
    turns = measured_turns()
    rates = {}
    for turn in turns:
        if turn["refused"]:
            sys.exit(f"bench: {turn['refused']} images of the client itself were refused: the machine is too busy")
        rates.setdefault((turn["size"], turn["beside"]), []).append(turn["images"] / turn["seconds"])
    found = []
    for (size, beside), of_rounds in rates.items():
        row = {"name": f"shares/{size}/{beside}", "value": statistics.median(of_rounds), "unit": "images/s"}
        alone = rates[size, "nobody"]
        if of_rounds is not alone:
            ratios = [rate / reference for rate, reference in zip(of_rounds, alone, strict=True)]
            row |= {"ratio_to": f"shares/{size}/nobody", "ratio": statistics.median(ratios), "ratios": ratios}
        of_neighbour = [turn for turn in turns if (turn["size"], turn["beside"]) == (size, beside)]
        row |= {key: sum(turn[key] for turn in of_neighbour) for key in ("images_of_neighbour", "refused_to_neighbour")}
        found.append(row)
    return found
