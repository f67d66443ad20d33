# SPDX-License-Identifier: Apache-2.0
"""scaling_plot.py FOLDER: plots the runs of scaling.py, read as JSON from stdin, to strong.png, weak.png and sparse.png."""

import json
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402
from matplotlib import ticker  # noqa: E402

EXCHANGES = {"direct-send": "tab:blue", "binary-swap": "tab:orange", "radix-k": "tab:green", "tree": "tab:purple",
             "serial": "tab:red"}
PARTITIONS = {"blocks": "--", "cost": "-"}


def total_ms(frame):
    return frame["render_ms"] + min(frame[name]["ms"] for name in EXCHANGES)


def speed_up(frame):
    return frame["one_rank_ms"] / total_ms(frame)


def ranks_of(frames):
    return [frame["ranks"] for frame in frames]


def on_ranks(axes, label, most, step=2):
    axes.set_xscale("log", base=2)
    ticks = [1 << power for power in range(0, most.bit_length(), step)]
    axes.xaxis.set_major_locator(ticker.FixedLocator(ticks))
    axes.xaxis.set_major_formatter(ticker.FixedFormatter([f"{tick:,}" for tick in ticks]))
    axes.xaxis.set_minor_locator(ticker.NullLocator())
    axes.set_xlabel("ranks")
    axes.set_ylabel(label)
    axes.grid(True, color="0.92")


def plain(axis):
    axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))


def gains(axes, below, cases, most):
    """Plots speed-up and efficiency of the cases: name -> (runs by partition, colour)."""
    axes.plot([1, most], [1, most], color="0.75", linewidth=1)
    axes.annotate("ideal", (most / 4, most / 4), textcoords="offset points", xytext=(-4, 2), ha="right", fontsize=8,
                  color="0.5")
    for name, (by_partition, colour) in cases.items():
        for partition, style in PARTITIONS.items():
            frames = by_partition[partition]
            label = name if partition == "cost" else None
            axes.plot(ranks_of(frames), [speed_up(frame) for frame in frames], style, color=colour, label=label, linewidth=1.3)
            below.plot(ranks_of(frames), [speed_up(frame) / frame["ranks"] for frame in frames], style, color=colour,
                       linewidth=1.3)
    axes.set_yscale("log", base=2)
    plain(axes.yaxis)
    axes.legend(fontsize=8, loc="upper left", title="solid: boxes by cost\ndashed: by blocks", title_fontsize=8)
    on_ranks(axes, "speed-up", most)
    below.set_ylim(0, 1.05)
    on_ranks(below, "efficiency", most)


def traffic(axes, frames, most):
    """Plots the bytes of each exchange: the mean over ranks, and the busiest rank."""
    frames = [frame for frame in frames if frame["ranks"] > 1]
    for name, colour in EXCHANGES.items():
        axes.plot(ranks_of(frames), [frame[name]["bytes_a_rank"] / 1e6 for frame in frames], color=colour, label=name,
                  linewidth=1.3)
        axes.plot(ranks_of(frames), [frame[name]["bytes_of_the_busiest"] / 1e6 for frame in frames], ":", color=colour,
                  linewidth=1.3)
    axes.set_yscale("log")
    plain(axes.yaxis)
    axes.legend(fontsize=8, loc="best", title="solid: mean\ndotted: busiest rank", title_fontsize=8)
    on_ranks(axes, "MB sent or received by a rank", most)


def times(axes, frames, most):
    """Plots the parts of an image's time."""
    axes.plot(ranks_of(frames), [frame["render_ms"] for frame in frames], color="0.3", label="rendering", linewidth=1.6)
    frames = [frame for frame in frames if frame["ranks"] > 1]
    for name, colour in EXCHANGES.items():
        axes.plot(ranks_of(frames), [frame[name]["ms"] for frame in frames], color=colour, label=name, linewidth=1.1)
    axes.set_yscale("log")
    plain(axes.yaxis)
    axes.legend(fontsize=8, ncol=2, loc="best")
    on_ranks(axes, "ms", most)


def image(path, title, cases, frames, of):
    figure, ((a, b), (c, d)) = plt.subplots(2, 2, figsize=(9, 7), constrained_layout=True)
    figure.suptitle(title, fontsize=11)
    most = max(ranks_of(frames))
    gains(a, b, cases, most)
    traffic(c, frames, most)
    c.set_title(f"bytes, {of}", fontsize=9)
    times(d, frames, most)
    d.set_title(f"time, {of}", fontsize=9)
    figure.savefig(path, dpi=80)
    plt.close(figure)


def by_partition(runs, case):
    return {partition: runs[f"{case}/{partition}"] for partition in PARTITIONS}


def main(runs, folder):
    sides = [case.split("/")[1] for case in runs if case.startswith("strong/") and case.endswith("/cost")]
    shades = plt.get_cmap("viridis")
    strong = {f"{side}³": (by_partition(runs, f"strong/{side}"), shades(0.9 * i / max(1, len(sides) - 1)))
              for i, side in enumerate(sides)}
    image(folder / "strong.png", "One dense cube on more and more ranks (1024² pixels)", strong, runs["strong/2048/cost"],
            "2048³ by cost")
    weak = {"image of 1024²": (by_partition(runs, "weak/512"), "tab:blue"),
            "image grows from 512²": (by_partition(runs, "weak/512-growing"), "tab:orange")}
    image(folder / "weak.png", "512³ dense voxels for each rank", weak, runs["weak/512-growing/cost"],
            "growing image, by cost")
    if "sparse/vessels/cost" in runs:
        sparse = {"aneurism, 256³": (by_partition(runs, "sparse/vessels"), "tab:red")}
        image(folder / "sparse.png", "Vessels, 99 % empty (1024² pixels)", sparse, runs["sparse/vessels/cost"], "by cost")


main(json.load(sys.stdin), Path(sys.argv[1]))
