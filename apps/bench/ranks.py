# SPDX-License-Identifier: Apache-2.0
"""The same scene on one rank and on four: the difference of the two images, in units of 1/255 (RMS over pixels and colours of
the 8-bit images), with a transfer function narrower than a sample and with a smooth one.

64^3 floats, 256^2 pixels. If Debian's paraview is installed, its pvbatch renders the same scene from the same camera.
paraview and python3-vtk9 exclude each other, so rows of ParaView and rows of VTK cannot come from one installation.
"""

import array
import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path

import display
import viewers

SIDE = 64
PIXELS = 256
CAMERA = {"azimuth": 31, "elevation": 29, "distance": 2.3}
TABLES = {"narrow": (0.6, 0.002, 0.9), "smooth": (0.5, 0.5, 0.05)}  # centre, half width, opacity at the centre
METHODS = ["post-classified", "pre-integrated"]


def waves():
    """Writes a gyroid around 0.5 to a raw file of floats."""
    path = viewers.OUT / "data" / f"waves_{SIDE}x{SIDE}x{SIDE}_f32.raw"
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        at = [12 * i / (SIDE - 1) - 6 for i in range(SIDE)]
        sine, cosine = [math.sin(a) for a in at], [math.cos(a) for a in at]
        values = array.array("f", (0.5 + (sine[x] * cosine[y] + sine[y] * cosine[z] + sine[z] * cosine[x]) / 6
                                   for z in range(SIDE) for y in range(SIDE) for x in range(SIDE)))
        path.write_bytes(values.tobytes())
    return path


def scene_of(table, folder):
    """Writes the scene for both programs to a file, which `understudy render --transfer-function` can read, too."""
    middle, half, opacity = TABLES[table]
    low, high = {"colour": [0.2, 0.4, 1], "opacity": 0}, {"colour": [1, 0.4, 0.2], "opacity": 0}
    control_points = [{"at": 0, **low}, {"at": middle - half, **low}, {"at": middle, "colour": [1, 0.9, 0.5], "opacity": opacity},
             {"at": middle + half, **high}, {"at": 1, **high}]
    path = folder / f"{table}.json"
    path.write_text(json.dumps({"volume": str(waves()), "side": SIDE, "pixels": PIXELS, **CAMERA, "positions": "values",
                                "knots": control_points}), encoding="utf-8")
    return path


def ours(scene, method, ranks, image):
    camera = ",".join(str(CAMERA[key]) for key in ("azimuth", "elevation", "distance"))
    exact = image.with_suffix(".pfm")
    subprocess.run([str(viewers.PROGRAMS / "understudy"), "render", str(waves()), "--transfer-function", str(scene), "-n", str(ranks),
                    "--method", method, "--camera", camera, "--size", f"{PIXELS}x{PIXELS}", "--out", str(image),
                    "--save-float", str(exact)], stdout=subprocess.DEVNULL, check=True)
    return exact


def paraview(scene, ranks, image, name_of_display):
    environment = os.environ | viewers.SOFTWARE | {"DISPLAY": name_of_display, "OMPI_ALLOW_RUN_AS_ROOT": "1",
                                                   "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    several = ["mpirun", "--oversubscribe", "-n", str(ranks)] if ranks > 1 else []
    subprocess.run([*several, "pvbatch", str(Path(__file__).with_name("paraview_image.py")), str(scene), str(image)],
                   stdout=subprocess.DEVNULL, check=True, env=environment, timeout=viewers.RUN_SECONDS)


def apart(name, one, four):
    compared = viewers.compare(one, four)
    return {"name": name, "value": 255 * compared["rms"], "unit": "/255", "psnr": compared["psnr"], "max": compared["max"]}


def rows():
    folder = viewers.OUT / "bench" / "images"
    folder.mkdir(parents=True, exist_ok=True)
    result = []
    for table in TABLES:
        scene = scene_of(table, folder)
        for method in METHODS:
            images = [folder / f"ranks-{table}-{method}-{ranks}.png" for ranks in (1, 4)]
            floats = [ours(scene, method, ranks, image) for ranks, image in zip((1, 4), images)]
            result.append(apart(f"ranks/{table}/{method}", *images)
                          | {"max_before_rounding": viewers.compare(*floats)["max"]})
        if shutil.which("pvbatch") is None:
            print("ranks: no rows for ParaView, install paraview", file=sys.stderr)
            continue
        images = [folder / f"ranks-{table}-paraview-{ranks}.png" for ranks in (1, 4)]
        with display.VirtualDisplay() as name_of_display:
            for ranks, image in zip((1, 4), images):
                paraview(scene, ranks, image, name_of_display)
        result.append(apart(f"ranks/{table}/paraview", *images))
    return result
