# SPDX-License-Identifier: Apache-2.0
"""Modelled images on 1 to 1,024 ranks, and 1 to 8 real ranks of this machine compared with the model.

In the model, partition, rays and the bytes of every message are the nodes' own, and time is modelled (frame_time.h): a node
takes a sample in SAMPLE_NS, the network carries 100 Gbit/s between nodes, a small message takes 5 us. Strong: the same cube
on more ranks; weak: a cube that grows with the ranks, once with an image that grows, too. `value` is rendering on the slowest
rank plus the cheapest exchange. Beside it are the speed-up over all samples on one rank, the speed-up divided by the number
of ranks (efficiency), and the traffic. The check against real ranks runs first: bytes and messages must be equal; of times,
both and their ratio are listed. Plots and tables go to out/bench/scaling/.
"""

import json
import os
import subprocess
from pathlib import Path

import viewers

SAMPLE_NS = 2.0
EXCHANGES = ("serial", "tree", "direct-send", "binary-swap", "radix-k")
SIDES = (512, 1024, 2048, 4096, 8192)
CUBES = {**{f"strong/{side}": ["--side", str(side)] for side in SIDES}, "weak/512": ["--side", "512", "--weak"],
         "weak/512-growing": ["--side", "512", "--weak", "--growing-image", "--pixels", "512"]}
PARTITIONS = {"blocks": [], "cost": ["--by-cost"]}
CAST = {"side": 256, "ranks": 8}
VESSELS = viewers.ROOT.parent / "shared" / "data" / "aneurism_256x256x256_uint8.raw.gz"
REAL_RANKS = 8


def lines_of(program, options):
    text = subprocess.run([str(viewers.PROGRAMS / program), *map(str, options)], stdout=subprocess.PIPE, text=True,
                          check=True).stdout
    return [json.loads(line) for line in text.splitlines()]


def message_cost():
    """Returns the costs of messages, bytes and blending between two ranks of this machine, in the form that real_ranks.cc
    takes.
    """
    environment = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    return subprocess.run(["mpirun", "-n", "2", "--oversubscribe", "--bind-to", "none", "--mca", "mpi_yield_when_idle", "1",
                           "--mca", "plm", "isolated", "--mca", "btl", "self,vader",
                           str(viewers.PROGRAMS / "understudy-bench-messages")],
                          stdout=subprocess.PIPE, text=True, check=True, env=environment).stdout.strip()


def checked(folder):
    """Returns the rows of real ranks. Raises RuntimeError if bytes, messages or samples differ from the prediction."""
    costs, *images = lines_of("understudy-bench-real-ranks", ["--most-ranks", REAL_RANKS, "--costs", message_cost()])
    for key in ("bytes", "messages", "samples"):
        wrong = [image for image in images if image[key] != image[f"{key}_counted"]]
        if wrong:
            raise RuntimeError(f"{key} of {len(wrong)} images on real ranks are not those predicted: {wrong[0]}")
    print(f"scaling: {len(images)} images on real ranks: bytes, messages and samples are those predicted")
    print("scaling: " + ", ".join(f"{key} {value:.3g}" for key, value in costs.items()))
    (folder / "real.json").write_text(json.dumps({"costs": costs, "images": images}), encoding="utf-8")
    (folder / "real.md").write_text(real_table(images), encoding="utf-8")
    return [{"name": f"scaling/real/{image['scene']}/{image['exchange']}/{image['gather']}/{image['ranks']} ranks",
             "value": image["frame_ms_measured"], "unit": "ms", "predicted_ms": image["frame_ms"],
             "measured_to_predicted": image["frame_ms_measured"] / image["frame_ms"],
             **{key: image[key] for key in ("render_ms", "render_ms_measured", "exchange_ms", "exchange_ms_measured",
                                              "bytes", "bytes_counted", "messages", "messages_counted")}}
            for image in images]


def real_table(images):
    """Makes the table by number of ranks: direct-send, gathered directly; in brackets, the range of the ratios over all
    exchanges and both ways to gather.
    """
    lines = ["| ranks | messages | bytes | render ms: predicted | measured | ratio | exchange ms: predicted | measured | ratio "
             "| frame ms: predicted | measured | ratio |", "|---|---|---|---|---|---|---|---|---|---|---|---|"]
    for ranks in range(1, REAL_RANKS + 1):
        chosen = [image for image in images if image["ranks"] == ranks and image["scene"] == "lobes"]
        usual = next(image for image in chosen if (image["exchange"], image["gather"]) == ("direct-send", "direct"))
        cells = [str(ranks), str(usual["messages"]), str(usual["bytes"])]
        for key in ("render_ms", "exchange_ms", "frame_ms"):
            predicted, measured = usual[key], usual[f"{key}_measured"]
            ratios = sorted(image[f"{key}_measured"] / image[key] for image in chosen if image[key] > 0)
            among = f" ({ratios[0]:.2f} to {ratios[-1]:.2f})" if ratios and ratios[0] < ratios[-1] else ""
            cells += [f"{predicted:.2f}", f"{measured:.2f}", f"{measured / predicted:.2f}{among}" if predicted else "-"]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def simulated(options):
    return lines_of("understudy-bench-scaling", ["--sample", SAMPLE_NS * 1e-9, *options])


def check_rays():
    """Raises RuntimeError if really cast boxes differ from those derived from their rays, in samples or in bytes sent."""
    options = ["--side", CAST["side"], "--most-ranks", CAST["ranks"]]
    for cast, told in zip(simulated([*options, "--cast-ranks", CAST["ranks"]]), simulated(options)):
        if {**cast, "parts": ""} != {**told, "parts": ""}:
            raise RuntimeError(f"what {cast['ranks']} ranks cast is not what their rays tell")
    print(f"scaling: boxes of 1 to {CAST['ranks']} ranks, really cast, take the samples and send the bytes that their rays tell")


def row_of(name, frame):
    exchange = min(EXCHANGES, key=lambda which: frame[which]["ms"])
    chosen = frame[exchange]
    total = frame["render_ms"] + chosen["ms"]
    speed_up = frame["one_rank_ms"] / total
    return {"name": f"scaling/{name}/{frame['ranks']} ranks", "value": total, "unit": "ms", "render_ms": frame["render_ms"],
            "exchange": exchange, "exchange_ms": chosen["ms"], "speed_up": speed_up,
            "efficiency": speed_up / frame["ranks"], "imbalance": frame["imbalance"], "messages": chosen["messages"],
            "bytes": chosen["bytes"], "bytes_a_rank": chosen["bytes_a_rank"],
            "bytes_of_the_busiest": chosen["bytes_of_the_busiest"]}


def table(result):
    lines = ["| scene | partition | ranks | render ms | exchange ms | speed-up | efficiency | imbalance | messages | MB in all "
             "| MB a rank | MB of the busiest |", "|---|---|---|---|---|---|---|---|---|---|---|---|"]
    for row in result:
        _, kind, case, partition, ranks = row["name"].split("/")
        if int(ranks.split()[0]) in (1, 8, 64, 512, 1024):
            lines.append(f"| {kind} {case} | {partition} | {ranks.split()[0]} | {row['render_ms']:.2f} | "
                         f"{row['exchange']} {row['exchange_ms']:.2f} | {row['speed_up']:.1f} | {row['efficiency']:.2f} | "
                         f"{row['imbalance']:.2f} | {row['messages']} | {row['bytes'] / 1e6:.1f} | "
                         f"{row['bytes_a_rank'] / 1e6:.2f} | {row['bytes_of_the_busiest'] / 1e6:.2f} |")
    return "\n".join(lines) + "\n"


def rows():
    folder = viewers.OUT / "bench" / "scaling"
    folder.mkdir(parents=True, exist_ok=True)
    result = checked(folder)
    check_rays()
    runs = {f"{case}/{partition}": simulated([*options, *further])
            for case, options in CUBES.items() for partition, further in PARTITIONS.items()}
    if VESSELS.exists():
        for partition, further in PARTITIONS.items():
            runs[f"sparse/vessels/{partition}"] = simulated(["--volume", VESSELS, "--most-ranks", 256, *further])
    else:
        print(f"scaling/sparse: left out, {VESSELS} is not there")
    on_paper = [row_of(name, frame) for name, frames in runs.items() for frame in frames]
    (folder / "table.md").write_text(table(on_paper), encoding="utf-8")
    (folder / "runs.json").write_text(json.dumps(runs), encoding="utf-8")
    # Use Debian's python, which has Matplotlib, whatever python runs this script.
    subprocess.run(["/usr/bin/python3", "-B", str(Path(__file__).with_name("scaling_plot.py")), str(folder)],
                   input=json.dumps(runs), text=True, check=True)
    return result + on_paper
