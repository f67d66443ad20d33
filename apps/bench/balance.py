# SPDX-License-Identifier: Apache-2.0
"""Load balancing of four ranks, image by image: none, after Mueller et al. 2006, and by prediction.

Every image is really cast, box by box. The time of a rank is its number of samples times 2 ns times its relative cost, with
5 % of seeded noise; one time in a hundred is tripled. So the figures do not depend on the machine or its load. Blocks are
sent at 1 GB/s, with a latency of 50 us for each rebalancing. `value` is the mean time of an image: rendering on the slowest
rank, plus the transfer of blocks before it. The deviation is (max - min) / mean of the ranks' times. Of the two settings of
Mueller's balancer, the row shows the one that is faster in that scene. Plots go to out/bench/balance/.
"""

import json
import subprocess
from pathlib import Path

import viewers

DATA = viewers.ROOT.parent / "shared" / "data"
POLICIES = ("static", "muller", "predicted")
TITLES = {
    "sparse": ("turning", "vessels", "sparse vessels, the camera turns"),
    "slowed-surface": ("slowed-surface", "engine", "iso-surface, one rank slowed to a quarter at 40"),
    "slowed-volume": ("slowed-volume", "engine", "volume, one rank slowed to a quarter at 40"),
    "slowed-lit": ("slowed-lit", "engine", "lit volume, one rank slowed to a quarter at 40"),
    "switched": ("switched", "engine", "transfer function switched every 50"),
    "zooming": ("zooming", "engine", "the camera zooms in and out"),
    "changing": ("changing", "rainbow", "texels that change"),
}


def volumes(case):
    """Returns the files of the case; an empty list if they are not beside the checkout."""
    if case == "sparse":
        return [path for path in [DATA / "aneurism_256x256x256_uint8.raw.gz"] if path.exists()]
    if case == "changing":
        return sorted((DATA / "viscous_run01").glob("*.vti"))
    return [Path(viewers.engine_volume())]


def played(case, files):
    scene, table, _ = TITLES[case]
    command = [viewers.PROGRAMS / "understudy-bench-balance", scene, *files, "--table", table, "--pixels", "512"]
    command += ["--images", "200"] if case == "switched" else []
    text = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, text=True, check=True).stdout
    runs = {run["balance"]: run for run in map(json.loads, text.splitlines())}
    firm = runs.pop("muller-firm")
    runs["muller"] = min(runs["muller"], firm, key=lambda run: run["mean_ms"])
    return runs


def rows():
    folder = viewers.OUT / "bench" / "balance"
    folder.mkdir(parents=True, exist_ok=True)
    result = []
    for case in TITLES:
        files = volumes(case)
        if not files:
            print(f"balance/{case}: left out, its volume does not lie in {DATA}")
            continue
        runs = played(case, files)
        # Use Debian's python, which has Matplotlib, whatever python runs this script.
        subprocess.run(["/usr/bin/python3", "-B", str(Path(__file__).with_name("balance_plot.py")), TITLES[case][2],
                        str(folder / f"{case}.png")], input=json.dumps(runs), text=True, check=True)
        for name in POLICIES:
            run = runs[name]
            row = {"name": f"balance/{case}/{name}", "value": run["mean_ms"], "unit": "ms"}
            if name != "static":
                row |= {"ratio_to": f"balance/{case}/static", "ratio": run["mean_ms"] / runs["static"]["mean_ms"]}
            row |= {key: run[key] for key in ("ideal_ms", "mean_deviation", "end_deviation", "settling", "bytes",
                                              "planes_moved", "reversals")}
            result.append(row)
    (folder / "table.md").write_text(table(result), encoding="utf-8")
    return result


def table(result):
    lines = ["| scene | balance | ms an image | ideal | deviation | at the end | images to settle | MB moved | planes moved "
             "| back |", "|---|---|---|---|---|---|---|---|---|---|"]
    for row in result:
        _, case, name = row["name"].split("/")
        lines.append(f"| {case} | {name} | {row['value']:.2f} | {row['ideal_ms']:.2f} | {row['mean_deviation']:.2f} | "
                     f"{row['end_deviation']:.2f} | {row['settling']:.1f} | {row['bytes'] / 1e6:.1f} | {row['planes_moved']} | "
                     f"{row['reversals']} |")
    return "\n".join(lines) + "\n"
