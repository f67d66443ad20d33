#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""calibration.py [CURVE.png]: how well the bound on tiles (docs/verification.md) separates correct images from wrong ones.

Correct images are those of substituted rows that `./run modes` kept in out/modes, compared with the bare viewer's. Wrong images
are the same images with a fault: in one tile (16 × 16 pixels), in a tenth of the window, or everywhere. The bound is
multiplied by several factors. For each factor, the script prints the share of correct images that would be refused (false
alarms) and of wrong ones that would be detected, and draws both into CURVE.png.
"""

import json
import random
import sys

import numpy

from modes import OUT, SLICES, TILE, pixels, severity

FACTORS = (0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.4, 2.0, 3.0, 5.0, 10.0)


def visible_tile(image, size, choice):
    """A square from a random pixel on that shows the volume, that is, differs from the image's corner."""
    shown = numpy.argwhere((numpy.abs(image - image[2, 2]).max(axis=2) > 24))
    if len(shown) == 0:
        return None
    y, x = shown[choice.randrange(len(shown))]
    return (slice(max(0, min(y, image.shape[0] - size)), None), slice(max(0, min(x, image.shape[1] - size)), None))


def part(image, size, choice):
    place = visible_tile(image, size, choice)
    if place is None:
        return None
    y, x = place[0].start, place[1].start
    return slice(y, y + size), slice(x, x + size)


def faults(image, choice):
    """Yields names of faults and images with them."""
    height, width = image.shape[:2]
    tenth = int((height * width / 10) ** 0.5)
    background = image[2, 2]
    for name, size in (("one tile", TILE), ("a tenth", tenth), ("everywhere", None)):
        where = (slice(None), slice(None)) if size is None else part(image, size, choice)
        if where is None:
            continue

        def wrong(change):
            copy = image.copy()
            copy[where] = numpy.clip(change(copy)[where], 0, 255)
            return copy

        yield f"missing, {name}", wrong(lambda pixels: numpy.broadcast_to(background, pixels.shape))
        yield f"a tenth darker, {name}", wrong(lambda pixels: background + (pixels - background) * 9 // 10)
        yield f"a third fainter, {name}", wrong(lambda pixels: background + (pixels - background) * 2 // 3)
        yield f"moved by 4 pixels, {name}", wrong(lambda pixels: numpy.roll(pixels, 4, axis=1))
        yield f"red and blue exchanged, {name}", wrong(lambda pixels: pixels[:, :, ::-1])


def main():
    rows = [row for row in json.loads((OUT / "table.json").read_text(encoding="utf-8")) if row.get("substituted")]
    choice = random.Random(1)
    right, wrong = [], {}
    for row in rows:
        if any(name in "-".join(row["row"]) for name in SLICES):
            continue  # blended in the viewer's 8-bit framebuffer, while the library compares floats
        stem = ".".join(part_of_name.replace(",", "_").replace(":", "_") for part_of_name in row["row"])
        for end in (".a.png", ".b.png", ".png"):
            bare, ours = OUT / f"{stem}.bare{end}", OUT / f"{stem}.substituted{end}"
            if not (bare.exists() and ours.exists()):
                continue
            a, b = pixels(bare), pixels(ours)
            if a.shape != b.shape or numpy.array_equal(a, b):
                continue  # the viewer's own image
            right.append(severity(a, b))
            for name, image in faults(b, choice):
                if numpy.abs(image - b).max() > 8:  # otherwise the fault is not visible
                    wrong.setdefault(name, []).append(severity(a, image))
    everything = [value for values in wrong.values() for value in values]
    print(f"{len(right)} right images, {len(everything)} wrong ones")
    print("| bound × | right images refused | wrong images found |\n|---|---|---|")
    curve = []
    for factor in FACTORS:
        refused = sum(value > factor for value in right) / len(right)
        found = sum(value > factor for value in everything) / len(everything)
        curve.append((factor, refused, found))
        print(f"| {factor} | {100 * refused:.1f} % | {100 * found:.1f} % |")
    print("\n| fault | found |\n|---|---|")
    for name, values in sorted(wrong.items()):
        print(f"| {name} | {100 * sum(value > 1 for value in values) / len(values):.0f} % of {len(values)} |")
    if len(sys.argv) > 1:
        draw(curve, sys.argv[1])


def draw(curve, path):
    import matplotlib
    matplotlib.use("agg")
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(figsize=(5, 3.2))
    factors = [factor for factor, _, _ in curve]
    axes.semilogx(factors, [100 * found for _, _, found in curve], "o-", label="wrong images found")
    axes.semilogx(factors, [100 * refused for _, refused, _ in curve], "s-", label="right images refused")
    axes.axvline(1, color="grey", linewidth=0.8)
    axes.set_xlabel("bound, as a multiple of the one that is used")
    axes.set_ylabel("%")
    axes.set_ylim(-3, 103)
    axes.legend(loc="center right")
    figure.tight_layout()
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main()
