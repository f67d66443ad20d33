#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the diagrams of docs/architecture as SVG, beside this file or into a folder that is named.

    python3 docs/diagrams/draw.py [FOLDER]

Python's standard library only. A diagram is a function below; coordinates are pixels, y downwards."""

import sys
from html import escape
from pathlib import Path

VIEWER, ENTRY, UNITS, SERVICE, NODES, DRIVER, PAPER = (
    "#fde9c9", "#e7ddf5", "#d9e8fb", "#d8f0ea", "#dff0d0", "#e6e6e6", "#ffffff")
INK = "#222222"


class Drawing:
    def __init__(self, width, height, title):
        self.width, self.height, self.title, self.parts = width, height, title, []

    def text(self, x, y, text, size=13, anchor="middle", weight="normal", style="normal"):
        self.parts.append(f'<text x="{x}" y="{y}" font-size="{size}" text-anchor="{anchor}" font-weight="{weight}" '
                          f'font-style="{style}" fill="{INK}">{escape(text)}</text>')

    def box(self, x, y, width, height, lines, fill=PAPER, dashed=False):
        """The first line is the name, the others say what it does."""
        dash = ' stroke-dasharray="6 4"' if dashed else ""
        self.parts.append(f'<rect x="{x}" y="{y}" width="{width}" height="{height}" rx="5" fill="{fill}" '
                          f'stroke="{INK}" stroke-width="1.2"{dash}/>')
        top = y + height / 2 - 8 * (len(lines) - 1) + 5
        for number, line in enumerate(lines):
            self.text(x + width / 2, top + 16 * number, line, 13 if number == 0 else 12, weight="bold" if number == 0 else "normal")

    def frame(self, x, y, width, height, label):
        self.parts.append(f'<rect x="{x}" y="{y}" width="{width}" height="{height}" rx="8" fill="none" stroke="#888888" '
                          'stroke-width="1" stroke-dasharray="3 3"/>')
        self.text(x + 10, y + 18, label, 12, "start", style="italic")

    def arrow(self, points, label="", at=None, anchor="middle", dashed=False, both=False):
        path = " ".join(f"{x},{y}" for x, y in points)
        dash = ' stroke-dasharray="5 4"' if dashed else ""
        start = ' marker-start="url(#tip)"' if both else ""
        self.parts.append(f'<polyline points="{path}" fill="none" stroke="{INK}" stroke-width="1.4"{dash} '
                          f'marker-end="url(#tip)"{start}/>')
        if label:
            (x0, y0), (x1, y1) = points[0], points[-1]
            x, y = at or ((x0 + x1) / 2, (y0 + y1) / 2 - 6)
            for number, line in enumerate(label.split("\n")):
                self.text(x, y + 15 * number, line, 12, anchor)

    def svg(self):
        body = "\n".join(self.parts)
        return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{self.width}" height="{self.height}" '
                f'viewBox="0 0 {self.width} {self.height}" font-family="DejaVu Sans, Helvetica, sans-serif">\n'
                f"<title>{escape(self.title)}</title>\n"
                '<defs><marker id="tip" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" markerHeight="7" '
                f'orient="auto-start-reverse"><path d="M0,0 L10,5 L0,10 z" fill="{INK}"/></marker></defs>\n'
                f'<rect width="{self.width}" height="{self.height}" fill="{PAPER}"/>\n{body}\n</svg>\n')


def layers():
    d = Drawing(860, 470, "Modules; a module may include those below it, never one above")
    rows = [("apps/", "programs: understudy, understudy-node, understudy-view, understudy-viewer", "hold no logic that a module could hold", VIEWER),
            ("interceptor/", "exported OpenGL functions, real driver, life of contexts", "does not know what a volume is", ENTRY),
            ("spu/", "dispatch table, chain, stream processing units, recogniser, report", "calls OpenGL through dispatch tables only", UNITS),
            ("compositor/", "blending, exchanges, nodes, render service, connections", "does not know OpenGL", SERVICE),
            ("volume/", "bricks, partition, classification, ray casters, files, references", "does not know MPI", NODES)]
    for number, (name, what, never, fill) in enumerate(rows):
        y = 45 + 82 * number
        d.box(60, y, 620, 60, [name, what, never], fill)
        if number:
            d.arrow([(370, y - 22), (370, y - 1)])
    d.box(720, 45, 110, 388, ["tests/", "may use all,", "used by none"], PAPER, dashed=True)
    d.text(370, 28, "Includes point down only; tests/architecture checks it", 13, style="italic")
    d.text(370, 457, "MPI is linked by understudy-node alone; the bundled viewer uses no module", 12, style="italic")
    return d


def frame():
    d = Drawing(900, 560, "The walk of a frame")
    d.frame(20, 20, 430, 520, "the viewer's process")
    d.box(60, 50, 340, 46, ["viewer", "draws slices, or a box with a ray casting shader"], VIEWER)
    d.arrow([(230, 96), (230, 128)], "1  gl* calls", (240, 116), "start")
    d.box(60, 128, 340, 46, ["entry library", "one dispatch table for each thread"], ENTRY)
    d.arrow([(230, 174), (230, 206)], "2  the chain's head", (240, 194), "start")
    d.box(60, 206, 340, 40, ["track"], UNITS)
    d.arrow([(230, 246), (230, 272)])
    d.box(60, 272, 340, 124, ["volume", "3  keeps the run of draws", "4  recognises, classifies, uploads", "5  composes the request",
                              "8  verifies and presents the image", "(refusal: replays the run)"], UNITS)
    d.arrow([(230, 396), (230, 440)], "all other calls,\nand the image", (240, 414), "start")
    d.box(60, 440, 340, 46, ["driver", "the real OpenGL; then the swap"], DRIVER)
    d.frame(528, 20, 352, 520, "render nodes (MPI), or threads in the viewer")
    d.box(540, 120, 300, 46, ["rank 0", "tells all ranks what to do"], NODES)
    d.arrow([(690, 166), (690, 210)], "broadcast", (700, 192), "start")
    d.box(540, 210, 300, 60, ["every rank", "6  casts rays through its bricks:", "a partial image, footprint only"], NODES)
    d.arrow([(690, 270), (690, 310)])
    d.box(540, 310, 300, 60, ["exchange", "7  composites N images to one", "in visibility order"], NODES)
    d.arrow([(690, 370), (690, 420)])
    d.box(540, 420, 300, 46, ["image buffer", "shared memory; floats, premultiplied"], SERVICE)
    d.arrow([(400, 300), (470, 300), (470, 143), (540, 143)], "texels,\nrequest", (476, 200), "start")
    d.arrow([(540, 443), (470, 443), (470, 370), (400, 370)], "image", (476, 405), "start")
    return d


def texel():
    d = Drawing(900, 500, "The walk of a texel")
    d.frame(20, 20, 270, 460, "the viewer's process")
    d.box(45, 50, 220, 46, ["glTexImage3D", "goes to the driver at once"], VIEWER)
    d.arrow([(155, 96), (155, 134)], "noted by track", (165, 120), "start")
    d.box(45, 134, 220, 46, ["slice ranges", "read back from the driver"], UNITS)
    d.arrow([(155, 180), (155, 218)])
    d.box(45, 218, 220, 60, ["block hashes", "64 bits for 16³ texels;", "equal: the block stays here"], UNITS)
    d.arrow([(155, 278), (155, 316)], "texels that differ", (165, 302), "start")
    d.box(45, 316, 220, 46, ["render service", "socket, or a call"], SERVICE)
    d.frame(320, 20, 270, 460, "rank 0")
    d.box(345, 316, 220, 46, ["partition", "a box of cells for each rank"], NODES)
    d.arrow([(265, 339), (345, 339)])
    d.box(345, 190, 220, 60, ["texels shown", "of the rank's box and its ghost", "layer; sent by MPI"], NODES)
    d.arrow([(455, 316), (455, 250)])
    d.frame(620, 20, 260, 460, "every rank")
    d.arrow([(565, 220), (600, 220), (600, 76), (645, 76)])
    d.box(645, 50, 210, 60, ["brick store", "blocks of 8³ cells", "with their 9³ texels"], NODES)
    d.arrow([(750, 110), (750, 144)])
    d.box(645, 144, 210, 46, ["ranges", "least and greatest of a block"], NODES)
    d.arrow([(750, 190), (750, 224)])
    d.box(645, 224, 210, 46, ["occupancy map", "distance to what shows"], NODES)
    d.arrow([(750, 270), (750, 304)])
    d.box(645, 304, 210, 60, ["ray caster", "trilinear sample, transfer", "function, over"], NODES)
    d.arrow([(750, 364), (750, 404)])
    d.box(645, 404, 210, 46, ["pixel", "premultiplied float RGBA"], PAPER)
    return d


def remote_call():
    d = Drawing(900, 520, "The walk of a remote call")
    d.frame(20, 20, 270, 480, "viewer's machine, no OpenGL")
    d.box(45, 56, 220, 46, ["viewer", "gl*, glX*, egl*"], VIEWER)
    d.arrow([(155, 102), (155, 134)])
    d.box(45, 134, 220, 60, ["entry library", "answers GLX and EGL", "from the X server's visuals"], ENTRY)
    d.arrow([(155, 194), (155, 226)])
    d.box(45, 226, 220, 46, ["pack", "a call becomes a record"], UNITS)
    d.arrow([(155, 272), (155, 304)])
    d.box(45, 304, 220, 60, ["remote", "client state is answered here;", "only real questions wait"], UNITS)
    d.box(45, 420, 220, 46, ["window", "shown by X, MIT-SHM"], PAPER)
    d.arrow([(155, 364), (155, 420)], "changed rectangle", (165, 396), "start")
    d.frame(320, 240, 250, 190, "only between machines")
    d.box(345, 270, 200, 46, ["relay", "blocks, LZ4 or zstd"], SERVICE)
    d.box(345, 366, 200, 46, ["relay", "after the handshake"], SERVICE)
    d.arrow([(445, 316), (445, 366)], "TCP", (455, 345), "start", both=True)
    d.arrow([(265, 325), (345, 293)], both=True)
    d.frame(600, 20, 280, 480, "GL server's machine")
    d.arrow([(545, 389), (580, 389), (580, 80), (630, 80)], both=True)
    d.box(630, 56, 220, 46, ["GL server", "a process for each viewer"], SERVICE)
    d.arrow([(740, 102), (740, 130)])
    d.box(630, 130, 220, 60, ["decoder", "measures every length;", "believes no pointer"], UNITS)
    d.arrow([(740, 190), (740, 218)])
    d.box(630, 218, 220, 46, ["track, volume", "as in a viewer's process"], UNITS)
    d.arrow([(740, 264), (740, 292)])
    d.box(630, 292, 220, 46, ["driver", "EGL, or OSMesa"], DRIVER)
    d.arrow([(740, 338), (740, 366)])
    d.box(630, 366, 220, 46, ["swap", "what changed of the image"], UNITS)
    d.box(630, 436, 220, 46, ["render nodes", "as for any viewer"], NODES)
    d.arrow([(850, 241), (868, 241), (868, 459), (850, 459)], both=True)
    return d


def trace():
    d = Drawing(900, 400, "The walk of a trace")
    d.frame(20, 20, 260, 360, "understudy run --trace")
    d.box(45, 56, 210, 46, ["viewer", "calls"], VIEWER)
    d.arrow([(150, 102), (150, 134)])
    d.box(45, 134, 210, 60, ["trace", "records each call with what", "it read and what it answered"], UNITS)
    d.arrow([(150, 194), (150, 226)], "the same call", (160, 215), "start")
    d.box(45, 226, 210, 46, ["track, volume, driver", "as without a trace"], UNITS)
    d.box(325, 134, 190, 60, ["t.ust", "blocks of whole frames,", "zstd"], PAPER)
    d.arrow([(255, 164), (325, 164)])
    d.box(325, 250, 190, 60, ["print, trim", "read the same records"], UNITS)
    d.arrow([(420, 194), (420, 250)], both=True)
    d.frame(560, 20, 320, 360, "understudy replay")
    d.arrow([(515, 164), (540, 164), (540, 79), (600, 79)])
    d.box(600, 56, 240, 46, ["decoder", "as for a stream from elsewhere"], UNITS)
    d.arrow([(720, 102), (720, 134)])
    d.box(600, 134, 240, 60, ["player", "one context for each recorded;", "names are translated"], UNITS)
    d.arrow([(720, 194), (720, 226)])
    d.box(600, 226, 240, 46, ["any chain", "default: track volume driver"], UNITS)
    d.arrow([(720, 272), (720, 304)])
    d.box(600, 304, 240, 46, ["offscreen context", "EGL, or OSMesa"], DRIVER)
    return d


def exchange():
    d = Drawing(900, 450, "The walk of an exchange: direct-send between four ranks")
    names = ["rank 2 (front)", "rank 0", "rank 3", "rank 1 (back)"]
    for number, name in enumerate(names):
        x = 30 + 215 * number
        d.box(x, 50, 190, 60, [name, "casts its own box:", "image and footprint"], NODES)
        d.box(x, 300, 190, 60, [f"region {number + 1}", "blended front to back,", "pieces in visibility order"], NODES)
    d.text(450, 30, "Boxes in visibility order, from the kd-tree", 13, style="italic")
    for source in range(4):
        for target in range(4):
            x0, x1 = 125 + 215 * source, 125 + 215 * target
            if source == target:
                d.arrow([(x0, 110), (x1, 299)], dashed=True)
            else:
                d.arrow([(x0, 110), (x1 + 18 * (source - target), 299)])
    d.parts.append(f'<rect x="250" y="187" width="400" height="44" fill="{PAPER}" stroke="#888888"/>')
    d.text(450, 205, "a piece is the part of an image in a region;", 12)
    d.text(450, 222, "pixels without a sample do not travel", 12)
    d.box(240, 395, 420, 40, ["image buffer in the viewer's memory"], SERVICE)
    for number in range(4):
        d.arrow([(125 + 215 * number, 360), (300 + 100 * number, 394)])
    return d


DIAGRAMS = [layers, frame, texel, remote_call, trace, exchange]


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent
    for diagram in DIAGRAMS:
        (folder / f"{diagram.__name__}.svg").write_text(diagram().svg(), encoding="utf-8")


if __name__ == "__main__":
    main()
