# SPDX-License-Identifier: Apache-2.0
"""balance_plot.py TITLE PNG: plots the runs of one scene, read as JSON from stdin. Called by balance.py."""

import json
import sys

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402

COLOURS = {"static": "0.6", "muller": "tab:orange", "predicted": "tab:blue"}


def plot(runs, title, path):
    figure, (above, below) = plt.subplots(2, 1, figsize=(6.4, 4.2), sharex=True, constrained_layout=True)
    for name, colour in COLOURS.items():
        run = runs[name]
        times = [a + b for a, b in zip(run["render_ms"], run["transfer_ms"])]
        above.plot(run["deviation"], color=colour, label=name, linewidth=1.1)
        below.plot(times, color=colour, linewidth=0.9)
    above.set_title(title, fontsize=10)
    above.set_ylabel("(max - min) / mean")
    above.set_ylim(bottom=0)
    above.legend(fontsize=8, ncol=3, loc="upper right")
    below.set_ylabel("image, ms")
    below.set_xlabel("image")
    # Clip the single tripled times, which would flatten the rest of the plot.
    times = sorted(time for run in runs.values() for time in run["render_ms"])
    below.set_ylim(0, 1.15 * times[int(0.985 * len(times))])
    figure.savefig(path, dpi=72)


plot(json.load(sys.stdin), sys.argv[1], sys.argv[2])
