# SPDX-License-Identifier: Apache-2.0
"""A volume on two ranks: frames of `understudy render -n 2` and of ParaView's pvbatch, alternately.

256^3 bytes on 512^2 pixels, one sample a voxel, the same camera and transfer function; milliseconds of wall time, medians
over rounds. ParaView casts rays with OpenGL (Mesa's software renderer) or on the CPU: the row `paraview` is the faster one.
psnr compares our image with ParaView's. pvbatch is the one on PATH, or the program that UNDERSTUDY_PVBATCH names.
"""

import json
import os
import re
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

import display
import viewers
from frame import SIDE, cube

RANKS = 2
PIXELS = 512
ROUNDS = 3
FRAMES = 8
SETTLE = 3  # first frames, in which ParaView distributes the volume and compiles
CAMERA = {"azimuth": 31, "elevation": 29, "distance": 2.3}
MODES = {"OpenGL": "GPU Based", "CPU": "Ray Cast Only"}
# Dense: every value is slightly opaque. Sparse: only the higher ones are.
TABLES = {"dense": [(0, (0.1, 0.3, 1), 0.002), (255, (1, 0.8, 0.2), 0.03)],
          "sparse": [(0, (0, 0, 0), 0), (139, (0.2, 0.4, 1), 0), (140, (0.2, 0.4, 1), 0.02), (255, (1, 0.9, 0.5), 0.5)]}


def scene_of(table, mode, folder):
    """Writes the scene for both programs to a file, which `understudy render --transfer-function` can read, too."""
    control_points = [{"at": at, "colour": colour, "opacity": opacity} for at, colour, opacity in TABLES[table]]
    path = folder / f"paraview-{table}-{mode}.json"
    path.write_text(json.dumps({"volume": str(cube()), "side": SIDE, "scalars": "unsigned char", "pixels": PIXELS, **CAMERA,
                                "positions": "values", "knots": control_points, "mode": MODES[mode], "frames": SETTLE + FRAMES}),
                    encoding="utf-8")
    return path


def ours(scene, image):
    camera = ",".join(str(CAMERA[key]) for key in ("azimuth", "elevation", "distance"))
    report = image.with_suffix(".json")
    subprocess.run([str(viewers.PROGRAMS / "understudy"), "render", str(cube()), "--volume-size", *[str(SIDE)] * 3,
                    "--type", "u8", "--transfer-function", str(scene), "-n", str(RANKS), "--camera", camera, "--size",
                    f"{PIXELS}x{PIXELS}", "--frames", str(SETTLE + FRAMES), "--out", str(image), "--report", str(report)],
                   stdout=subprocess.DEVNULL, check=True, timeout=viewers.RUN_SECONDS)
    return json.loads(report.read_text(encoding="utf-8"))["frames_ms"][SETTLE:]


def theirs(program, scene, image, name_of_display):
    environment = os.environ | viewers.SOFTWARE | {"DISPLAY": name_of_display, "OMPI_ALLOW_RUN_AS_ROOT": "1",
                                                   "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    text = subprocess.run(["mpirun", "-n", str(RANKS), "--oversubscribe", "--bind-to", "none", "--mca",
                           "mpi_yield_when_idle", "1", program, str(Path(__file__).with_name("paraview_image.py")),
                           str(scene), str(image)], stdout=subprocess.PIPE, text=True, check=True, env=environment,
                          timeout=viewers.RUN_SECONDS).stdout
    return [float(ms) for ms in re.findall(r"^frame ([0-9.]+) ms$", text, re.MULTILINE)][SETTLE:]


def rows():
    program = os.environ.get("UNDERSTUDY_PVBATCH") or shutil.which("pvbatch")
    if program is None:
        print("paraview: nothing to compare with; install paraview, or let UNDERSTUDY_PVBATCH name a pvbatch",
              file=sys.stderr)
    folder = viewers.OUT / "bench" / "images"
    folder.mkdir(parents=True, exist_ok=True)
    result = []
    for table in TABLES:
        images = {way: folder / f"paraview-{table}-{way}.png" for way in ("ours", *MODES)}
        times = {way: [] for way in images}
        for number in range(ROUNDS):
            print(f"  {table}, round {number + 1} of {ROUNDS}", file=sys.stderr, flush=True)
            times["ours"] += ours(scene_of(table, "OpenGL", folder), images["ours"])
            if program is None:
                continue
            with display.VirtualDisplay() as name_of_display:
                for mode in MODES:
                    times[mode] += theirs(program, scene_of(table, mode, folder), images[mode], name_of_display)
        name = f"{RANKS} ranks/{table}"
        row = {"name": f"{name}/ours", "value": statistics.median(times["ours"]), "unit": "ms"}
        if program is not None:
            medians = {mode: statistics.median(times[mode]) for mode in MODES}
            best = min(medians, key=medians.get)
            result.append({"name": f"{name}/paraview", "value": medians[best], "unit": "ms", "by": best, **medians})
            row |= {"ratio_to": f"{name}/paraview", "ratio": row["value"] / medians[best],
                    "psnr": viewers.compare(images[best], images["ours"])["psnr"]}
        result.append(row)
    return result
