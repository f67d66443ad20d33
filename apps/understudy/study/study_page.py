#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""study_page.py DIR: makes the self-contained DIR/index.html from DIR/study.json. Called by `understudy study`."""

import base64
import html
import io
import json
import math
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot as plt, ticker  # noqa: E402

COLOURS = {"post-classified": "tab:blue", "pre-integrated": "tab:orange", "adaptive": "tab:green"}
OTHERS = {"the bare viewer's slices": "v", "VTK's GPU mapper": "^", "VTK's fixed-point mapper": "D"}
FINEST = 1e-5  # termination thresholds below this count as none
EXPECTED = "2 on a smooth field under a smooth table; at most 2 on voxels, 1 where the table has a step"


def image(data, kind, alt):
    text = base64.b64encode(data).decode()
    return f'<img alt="{html.escape(alt)}" src="data:image/{kind};base64,{text}">'


def plot(draw, alt):
    figure, axes = plt.subplots(figsize=(6.2, 5.2))
    draw(axes)
    axes.grid(True, which="both", alpha=0.25)
    for axis in (axes.xaxis, axes.yaxis):  # label minor ticks: less than two decades would have hardly any label
        low, high = axis.get_view_interval()
        if high < 100 * low:
            axis.set_minor_formatter(ticker.LogFormatterSciNotation(minor_thresholds=(2, 0.5)))
            axis.set_tick_params(which="minor", labelsize=7)
    axes.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.14), ncol=2)
    figure.tight_layout()
    out = io.BytesIO()
    figure.savefig(out, format="svg")
    plt.close(figure)
    return image(out.getvalue(), "svg+xml", alt)


def timed(scene):
    return [point for point in scene["points"] if point["time_ms"] is not None]


def of_scheme(points, scheme):
    return sorted((point for point in points if point["scheme"] == scheme), key=lambda point: point["step"])


def work_precision(scene):
    """Plots the RMS error of colour over time, log-log. Lines join the steps of one scheme; small marks use early ray
    termination.
    """
    def draw(axes):
        for scheme, colour in COLOURS.items():
            points = of_scheme(timed(scene), scheme)
            whole = [point for point in points if point["termination"] < FINEST]
            early = [point for point in points if point["termination"] >= FINEST]
            axes.loglog([p["time_ms"] for p in whole], [p["rms_colour"] for p in whole], "o-", color=colour, label=scheme)
            for p in whole:
                axes.loglog(p["time_quartiles_ms"], [p["rms_colour"]] * 2, "-", color=colour, linewidth=4, alpha=0.3)
            for p in whole:
                axes.annotate(f"{p['step']:g}", (p["time_ms"], p["rms_colour"]), fontsize=7, textcoords="offset points",
                              xytext=(4, 4), color=colour)
            axes.loglog([p["time_ms"] for p in early], [p["rms_colour"] for p in early], "x", color=colour, markersize=5,
                        label=f"{scheme}, early ray termination")
        front = sorted((p for p in timed(scene) if p["front"]), key=lambda p: p["time_ms"])
        axes.loglog([p["time_ms"] for p in front], [p["rms_colour"] for p in front], "s", color="black", fillstyle="none",
                    markersize=10, label="Pareto front")
        for point in scene["points"]:
            if point["scheme"] in OTHERS:
                axes.loglog([point["time_ms"]], [point["rms_colour"]], OTHERS[point["scheme"]], color="tab:red", markersize=8,
                            label=point["scheme"])
            elif point["time_ms"] is None:
                axes.axhline(point["rms_colour"], color="grey", linestyle="--" if point["step"] == 1 else ":", linewidth=1,
                             label=f"{point['scheme']}, step {point['step']:g}")
        axes.set_xlabel("ms per image")
        axes.set_ylabel("RMS error of colour against the integral")
    return plot(draw, f"{scene['name']}: error over time")


def range_of(order):
    return f"{order['steps'][0]:g} to {order['steps'][1]:g}"


def convergence(scene):
    def draw(axes):
        for scheme, colour in COLOURS.items():
            points = [point for point in of_scheme(timed(scene), scheme) if point["termination"] < FINEST]
            order = scene["orders"].get(scheme)
            label = scheme + (f", slope {order['slope']:.2f} over {range_of(order)}" if order is not None else "")
            axes.loglog([p["step"] for p in points], [p["rms"] for p in points], "o-", color=colour, label=label)
            axes.loglog([p["step"] for p in points], [p["quantiles"][2] for p in points], "--", color=colour, linewidth=1,
                        label="99th percentile of rays")
            axes.loglog([p["step"] for p in points], [p["max"] for p in points], ":", color=colour, label="maximum")
            bounded = [p for p in points if p["bound"]]
            if bounded:
                axes.loglog([p["step"] for p in bounded], [p["bound"] for p in bounded], "-.", color=colour, linewidth=1,
                            label="certified bound of the maximum")
        axes.set_xlabel("step in voxels")
        axes.set_ylabel("error against the integral")
    return plot(draw, f"{scene['name']}: error over step")


def factor(ratio):
    if ratio is None:
        return "–"
    value = ratio["value"]
    return ("≥ " if ratio["at_least"] else "") + (f"{value:.0f}×" if value >= 100 else f"{value:.3g}×")


def advantages(study):
    """Returns a table of time and error of the other programs, and of the factors by which our front is better."""
    rows = ["<tr><th>scene<th class=name>program<th>ms<th>RMS of colour<th>its time / ours, at equal error"
            "<th>its error / ours, at equal time</tr>"]
    for scene in study["scenes"]:
        points = {point["scheme"]: point for point in scene["points"]}
        for name, ratios in scene["advantages"].items():
            rows.append(f"<tr><td>{html.escape(scene['name'])}<td class=name>{html.escape(name)}"
                        f"<td>{points[name]['time_ms']:.1f}<td>{points[name]['rms_colour']:.1e}"
                        f"<td>{factor(ratios['time_ratio'])}<td>{factor(ratios['error_ratio'])}</tr>")
        rows += [f"<tr><td>{html.escape(scene['name'])}<td class=name>{html.escape(name)}<td colspan=4 class=name>absent: "
                 f"{html.escape(why)}</tr>" for name, why in scene["absent"].items()]
    return "<table>" + "\n".join(rows) + "</table>"


def table(scene):
    rows = ["<tr><th>setting<th>RMS<th>95 % interval<th>median<th>95 %<th>99 %<th>max<th>certified bound<th>PSNR<th>ms<th>quartiles<th>ns per ray"
            "<th>samples taken<th>samples skipped</tr>"]
    for point in sorted(scene["points"], key=lambda p: (p["time_ms"] is None, p["time_ms"])):
        psnr = f"{-20 * math.log10(point['rms']):.1f} dB" if point["rms"] > 0 else "∞"
        left_out = f"{100 * (1 - point['samples_taken'] / point['samples']):.0f} %" if point["samples"] else "–"
        ending = f", ends below {point['termination']:g}" if point["termination"] >= FINEST else ""
        quartiles = " to ".join(f"{time:.2f}" for time in point["time_quartiles_ms"])
        time = ("–<td>–<td>–" if point["time_ms"] is None
                else f"{point['time_ms']:.2f}<td>{quartiles if point['scheme'] not in OTHERS else '–'}<td>{point['ns_per_ray']:.0f}")
        interval = " to ".join(f"{bound:.1e}" for bound in point["rms_interval"])
        bound = f"{point['bound']:.1e} ({point['bound'] / point['max']:.1f}×)" if point["bound"] and point["max"] > 0 else "–"
        quantiles = "".join(f"<td>{quantile:.1e}" for quantile in point["quantiles"])
        setting = html.escape(point["scheme"])
        if point["scheme"] not in OTHERS:
            setting += f", step {point['step']:g}{ending}"
        rows.append(f"<tr{' class=front' if point['front'] else ''}><td>{setting}"
                    f"<td>{point['rms']:.1e}<td>{interval}{quantiles}<td>{point['max']:.1e}<td>{bound}<td>{psnr}<td>{time}"
                    f"<td>{point['samples_taken'] or '–'}<td>{left_out}</tr>")
    return "<table>" + "\n".join(rows) + "</table>"


def section(scene, folder):
    maps = "".join(f"<figure>{image((folder / file).read_bytes(), 'png', name)}<figcaption>{html.escape(name)}"
                   "</figcaption></figure>" for name, file in sorted(scene["error_maps"].items()))
    size = "×".join(str(n) for n in scene["size"])
    rate = scene["rays"] / max(scene["reference_seconds"], 1e-9)
    return (f"<h2>{html.escape(scene['name'])}</h2><p>{html.escape(scene['shows'])}. "
            f"{html.escape(Path(scene['volume']).name)}, {size} voxels; {scene['rays']} rays compared, their reference "
            f"took {scene['reference_seconds']:.1f} s ({rate:.0f} rays per second). A voxel's optical depth is up to "
            f"{scene['stiffness']['depth']:.3g}, and the opacity in the table changes by up to {scene['stiffness']['change']:.3g} "
            "from one voxel to the next.</p>"
            f"{work_precision(scene)}{convergence(scene)}<div>{maps}</div>"
            f"<details><summary>all settings</summary>{table(scene)}</details>")


def savings(study):
    """Returns a table of the work skipped in frames of the viewer, with frame times with and without skipping it."""
    rows = ["<tr><th>scene<th class=name>item<th>skipped<th class=name>of<th>ms per frame<th>ms without<th>ratio"
            "<th>images differ by<th>tolerance<th class=name>shown with</tr>"]
    for scene in study["scenes"]:
        for saving in scene["savings"]:
            start = f"<tr><td>{html.escape(scene['name'])}<td class=name>{html.escape(saving['item'])}"
            if saving["absent"]:
                rows.append(f"{start}<td colspan=8 class=name>absent: {html.escape(saving['absent'])}</tr>")
                continue
            part = 100 * saving["left_out"] / max(saving["all"], 1)
            rows.append(f"{start}<td>{part:.1f} %<td class=name>{saving['all']:,} {html.escape(saving['unit'])}"
                        f"<td>{saving['time_ms']:.2f}<td>{saving['time_ms_without']:.2f}"
                        f"<td>{saving['time_ms_without'] / max(saving['time_ms'], 1e-9):.2f}"
                        f"<td>{saving['difference']:.1e}<td>{saving['tolerance']:.0e}"
                        f"<td class=name>{html.escape(saving['shown'])}</tr>")
    return "<table>" + "\n".join(rows) + "</table>"


def main():
    folder = Path(sys.argv[1])
    study = json.loads((folder / "study.json").read_text(encoding="utf-8"))
    orders = "".join(f"<tr><td>{html.escape(scene['name'])}<td>{scene['stiffness']['depth']:.3g}"
                     f"<td>{scene['stiffness']['change']:.3g}"
                     + "".join(f"<td>{order['slope']:.2f} ({range_of(order)})" if order else "<td>–"
                               for order in (scene["orders"].get(scheme) for scheme in COLOURS))
                     + "</tr>" for scene in study["scenes"])
    origin = study["origin"]
    machine = origin["machine"]
    text = f"""<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>Error against run time</title>
<style>body {{ font: 15px/1.45 sans-serif; max-width: 1300px; margin: 2em auto; padding: 0 1em }}
table {{ border-collapse: collapse }} td, th {{ padding: 2px 9px; text-align: right; border-bottom: 1px solid #ddd }}
td:first-child, th:first-child, .name {{ text-align: left }} .front {{ font-weight: bold }}
figure {{ display: inline-block; margin: 4px }} figcaption {{ font-size: 12px; text-align: center }}
figure img {{ image-rendering: pixelated; width: 200px }}</style>
<h1>Error against run time</h1>
<p>{html.escape(machine['processor'])}, {machine['processors']} processors, {study['instruction_set']}; Understudy
{html.escape(origin['version'])}, {html.escape(origin['commit'])}, {html.escape(origin['compiler'])}; {html.escape(origin['time'])}.</p>
<p>{study['edge']}² pixels from {len(study['cameras'])} cameras. Errors are those of premultiplied colour and opacity in float,
against the integral of the transfer function in double precision; intervals of the RMS are bootstrapped over rays. Times are medians
on all cores, with prepared tables; settings take turns, and a light bar extends from quartile to quartile. Numbers at points are
steps in voxels. Dashed: slices that are blended with eight bits, without their time. Red: other programs on the same scene from
the first camera, with one sample per voxel; their errors are of colour alone. Error maps are of the first camera: black 1e-6,
red 1e-4, white 0.1 and more.</p>
<h2>Comparison with other programs</h2>
{advantages(study)}
<p>Both factors are read from our Pareto front, interpolated between two settings in logarithms; ≥ means that the front ends
earlier, and – that none of our settings is as exact, or as fast. The bare viewer draws slices by OpenGL in software (Mesa's llvmpipe).</p>
<h2>Skipped work</h2>
{savings(study)}
<p>Frames of the bundled viewer under Understudy, with all optimizations and with one of them disabled. Samples are counted over
all rays; differences are the greatest of any channel of any frame, in float.</p>
<h2>Stiffness, and observed order of accuracy</h2>
<table><tr><th>scene<th>optical depth of a voxel<th>change of opacity per voxel{"".join(f"<th>{scheme}" for scheme in COLOURS)}</tr>{orders}</table><p>Theory: {EXPECTED}.
An order is the slope over the steps in parentheses, in voxels: the asymptotic range, in which the slopes between steps agree.</p>
{"".join(section(scene, folder) for scene in study["scenes"])}</html>
"""
    part = folder / "index.html.part"
    part.write_text(text, encoding="utf-8")
    part.rename(folder / "index.html")


if __name__ == "__main__":
    main()
