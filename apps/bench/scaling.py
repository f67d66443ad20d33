"""Frames on 1 to 1,024 ranks, on paper: real partition, footprints and messages, modelled time (scaling.cc says how).

Strong: the same cube on more ranks; weak: a cube that grows with them. A node samples in SAMPLE_NS, the line between nodes
carries 100 Gbit/s with 5 us a message. `value` is rendering on the slowest rank and then the cheapest exchange; beside it
the speed-up over one rank, its part that every rank really gives (efficiency), and what travels.
"""

import json
import subprocess

import viewers

SAMPLE_NS = 2.0
CASES = {"strong/512": ["--side", "512"], "strong/2048": ["--side", "2048"], "strong/8192": ["--side", "8192"],
         "weak/512": ["--side", "512", "--weak"]}
EXCHANGES = ("serial", "tree", "direct-send", "binary-swap", "radix-k")


def simulated(options):
    text = subprocess.run([str(viewers.PROGRAMS / "understudy-bench-scaling"), "--ns-per-sample", str(SAMPLE_NS), *options],
                          stdout=subprocess.PIPE, text=True, check=True).stdout
    return [json.loads(line) for line in text.splitlines()]


def rows():
    result = []
    for case, options in CASES.items():
        for frame in simulated(options):
            exchange = min(EXCHANGES, key=lambda name: frame[name]["ms"])
            chosen = frame[exchange]
            total = frame["render_ms"] + chosen["ms"]
            speed_up = frame["one_rank_ms"] / total
            result.append({"name": f"scaling/{case}/{frame['ranks']} ranks", "value": total, "unit": "ms",
                           "render_ms": frame["render_ms"], "exchange": exchange, "exchange_ms": chosen["ms"],
                           "speed_up": speed_up, "efficiency": speed_up / frame["ranks"],
                           "imbalance": frame["imbalance"], "messages": chosen["messages"], "bytes": chosen["bytes"],
                           "most_bytes_of_a_rank": chosen["most_bytes"]})
    return result
