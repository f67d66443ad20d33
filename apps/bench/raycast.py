# SPDX-License-Identifier: Apache-2.0
"""Ray casting alone, in processor time per full sample: a sample inside the volume, whether taken or skipped.

With --sizes 256,512,1024 it renders cubes of these sizes instead (multiples of 256; 1024 takes 2.7 GiB), with one ray a
voxel, of real voxels and of noise.

256^3 voxels on 512^2 pixels, one sample a voxel, one thread unless the row says otherwise. Beside each time are the error
against the same samples in double precision (rms_arithmetic), and the error against the volume rendering integral, which is
independent of samples (rms_total; not for surfaces and light, which the integral does not support). If the prototype at
UNDERSTUDY_YARDSTICK (default: ../shared/yardstick beside the checkout) can run, its program renders the same images of the
same volume in turn.
"""

import json
import math
import os
import re
import statistics
import subprocess
import sys
from pathlib import Path

import display
import viewer_slices
import viewers
from frame import SIDE, cube

ROUNDS = 5
FRAMES = 5
EPSILON = 1e-5
FULL = f"{SIDE}x{SIDE}x{SIDE}"
# By row name: the options of the program, and the arguments of the prototype.
CASES = {
    "cpu/post-classified/dense": (["--table", "dense"], ("dense", 1)),
    "cpu/post-classified/sparse": (["--table", "sparse"], ("sparse", 1)),
    "cpu/post-classified/u16": (["--table", "dense", "--type", "u16"], None),
    "cpu/post-classified/dense/2 threads": (["--table", "dense", "--threads", "2"], ("dense", 2)),
    "cpu/post-classified/brain": (["--table", "sparse"], None),
    "cpu/pre-integrated/dense": (["--table", "dense", "--method", "pre-integrated"], None),
    "cpu/adaptive/sparse": (["--table", "sparse", "--method", "adaptive"], None),
    "cpu/pre-integrated/sparse": (["--table", "sparse", "--method", "pre-integrated"], None),
    "cpu/shaded/dense": (["--table", "dense", "--light"], None),
    "cpu/iso/surface": (["--table", "clear", "--surfaces", "0.6", "--light"], None),
    "cpu/iso/dense": (["--table", "dense", "--surfaces", "0.6,0.8"], None),
    "gl/post-classified/dense": (["--table", "dense", "--backend", "gl"], None),
    "gl/post-classified/sparse": (["--table", "sparse", "--backend", "gl"], None),
    "gl-osmesa/post-classified/dense": (["--table", "dense", "--backend", "gl-osmesa"], None),
    "gl-osmesa/post-classified/sparse": (["--table", "sparse", "--backend", "gl-osmesa"], None),
}
YARDSTICK_LINE = re.compile(r"^(\S+)\s+post float4\s+ert1 skip1 .* ([0-9.]+) ns/full\.core", re.MULTILINE)
YARDSTICK = Path(os.environ.get("TMPDIR", "/tmp")) / "yardstick"  # folder in which its script keeps its output


def compiled(program, source, *options):
    if not program.exists() or program.stat().st_mtime < source.stat().st_mtime:
        subprocess.run(["g++", *options, "-o", str(program), str(source), "-lpthread"], check=True)


def yardstick():
    """Returns the prototype as a function of table and threads that returns nanoseconds, or None if it cannot run.

    Its script requires AVX-512. Where there is only AVX2, a program of ours times the prototype's AVX2 kernel.
    """
    folder = Path(os.environ.get("UNDERSTUDY_YARDSTICK", viewers.ROOT.parent / "shared" / "yardstick"))
    if not os.access(folder / "run", os.X_OK):
        print(f"raycast: nothing to compare with, there is no {folder / 'run'}", file=sys.stderr)
        return None
    processor = Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace")
    if "avx512f" in processor:
        def timed(table, threads):
            return [str(folder / "run"), str(SIDE), "512", "1", table, str(threads), str(FRAMES), "0", str(EPSILON)]
    elif "avx2" in processor:
        YARDSTICK.mkdir(parents=True, exist_ok=True)
        compiled(YARDSTICK / "volume", folder / "volume.cpp", "-O2")
        compiled(YARDSTICK / "avx2", Path(__file__).with_name("yardstick_avx2.cc"), "-O3", "-march=native", "-w",
                 f"-I{folder}")
        volume = YARDSTICK / f"{SIDE}.raw"
        if not volume.exists():
            volume.write_bytes(subprocess.run([str(YARDSTICK / "volume"), str(SIDE)], stdout=subprocess.PIPE,
                                              check=True).stdout)

        def timed(table, threads):
            return [str(YARDSTICK / "avx2"), str(volume), str(SIDE), "512", table, str(threads), str(FRAMES), str(EPSILON)]
    else:
        print("raycast: nothing to compare with, the prototype needs AVX2", file=sys.stderr)
        return None

    def nanoseconds(table, threads):
        text = subprocess.run(timed(table, threads), stdout=subprocess.PIPE, text=True, check=True).stdout
        return min(float(ns) for _, ns in YARDSTICK_LINE.findall(text))
    return nanoseconds


def measured(volume, size, options, frames=FRAMES, epsilon=EPSILON):
    """Runs the program; `volume` is a file, or a list of options that replaces it."""
    program = viewers.PROGRAMS / "understudy-bench-raycast"
    source = volume if isinstance(volume, list) else [str(volume)]
    text = subprocess.run([str(program), *source, "--size", size, "--frames", str(frames), "--epsilon", str(epsilon),
                           *options], stdout=subprocess.PIPE, text=True, check=True).stdout
    return json.loads(text)


# VTK's mappers render the same images if Debian's python3-vtk9 and xvfb are installed. They are slow, so one round is enough.
VTK_CASES = {f"vtk-{mapper}/{table}": (mapper, table) for mapper in ("gpu", "fixed-point") for table in ("dense", "sparse")}


def vtk_scene(volume, table):
    """Describes the camera and transfer functions of raycast.cc: two edges away, azimuth 30, elevation 25, field of view
    40 degrees.
    """
    around, above, first_visible = math.radians(30), math.radians(25), 140
    back = (math.sin(around) * math.cos(above), math.sin(above), math.cos(around) * math.cos(above))
    control_points = []
    for i in range(256):
        dense = 0.002 + 0.03 * i / 255
        sparse = 0 if i < first_visible else min(1, 0.02 + 0.3 * (i - first_visible) / 60)
        control_points.append({"at": i / 255, "opacity": sparse if table == "sparse" else dense,
                      "colour": [0.3 + 0.7 * i / 255, 0.5 + 0.5 * math.sin(i * 0.05), 1 - 0.8 * i / 255]})
    return {"volume": str(volume), "size": [SIDE] * 3, "type": "u8", "spacing": [1] * 3, "value_at_0": 0, "value_at_1": 255,
            "knots": control_points, "unit_distance": 1, "sample_distance": 1, "eye": [SIDE / 2 + 2 * SIDE * b for b in back],
            "centre": [SIDE / 2] * 3, "up": [0, 1, 0], "angle": 40, "near": 0.5 * SIDE, "far": 4 * SIDE, "pixels": 512}


def vtk_rows(volume, rows_so_far):
    if subprocess.run(["/usr/bin/python3", "-c", "import vtk, numpy"], stderr=subprocess.DEVNULL, check=False).returncode:
        print("raycast: no rows for VTK, install python3-vtk9 and python3-numpy", file=sys.stderr)
        return []
    ours = {row["name"]: row for row in rows_so_far}
    image = viewers.OUT / "bench" / "images" / "vtk.f32"
    image.parent.mkdir(parents=True, exist_ok=True)
    result = []
    with display.VirtualDisplay() as name_of_display:
        environment = os.environ | {"DISPLAY": name_of_display, "LIBGL_ALWAYS_SOFTWARE": "1", "LP_NUM_THREADS": "1"}
        for name, (mapper, table) in VTK_CASES.items():
            print(f"  {name}", file=sys.stderr, flush=True)
            scene = image.with_suffix(".json")
            scene.write_text(json.dumps(vtk_scene(volume, table)), encoding="utf-8")
            text = subprocess.run(["/usr/bin/python3", str(Path(__file__).with_name("vtk_mappers.py")), str(scene),
                                   "--mapper", mapper, "--threads", "1", "--frames", "3", "--image", str(image)],
                                  stdout=subprocess.PIPE, text=True, check=True, env=environment).stdout
            figures = measured(volume, FULL, ["--table", table, "--judge", str(image)], frames=1)
            errors = {key: figures[key] for key in figures if key.startswith(("rms_", "max_"))}
            ns = 1e9 * json.loads(text)["seconds"] / figures["samples"]
            rival = f"cpu/post-classified/{table}"
            result.append({"name": name, "value": ns, "unit": "ns", "ratio_to": rival, "ratio": ns / ours[rival]["value"],
                           "threads": 1, **errors})
    return result


def slice_rows(volume, rows_so_far):
    ours = {row["name"]: row for row in rows_so_far}
    image = viewers.OUT / "bench" / "images" / "slices.f32"
    image.parent.mkdir(parents=True, exist_ok=True)
    result = []
    for table in ("dense", "sparse"):
        print(f"  viewer-slices/{table}", file=sys.stderr, flush=True)
        seconds = viewer_slices.seconds_and_image(Path(volume), vtk_scene(volume, table), image)
        figures = measured(volume, FULL, ["--table", table, "--judge", str(image)], frames=1)
        errors = {key: figures[key] for key in figures if key.startswith(("rms_", "max_"))}
        ns = 1e9 * seconds / figures["samples"]
        rival = f"cpu/post-classified/{table}"
        result.append({"name": f"viewer-slices/{table}", "value": ns, "unit": "ns", "ratio_to": rival,
                       "ratio": ns / ours[rival]["value"], "threads": 1, **errors})
    return result


def enough_memory(side):
    """Checks for memory for a cube's bytes, for bricks that store 9^3 texels for each 8^3, and for an image."""
    needed = 2.5 * side**3 + 16 * side**2
    free = 1024 * int(re.search(r"MemAvailable:\s+(\d+)", Path("/proc/meminfo").read_text(encoding="ascii")).group(1))
    if needed > 0.9 * free:
        print(f"raycast: no rows of {side}^3, which needs {needed / 2**30:.1f} GiB of memory where "
              f"{free / 2**30:.1f} GiB are available", file=sys.stderr)
    return needed <= 0.9 * free


def size_rows(volume, sizes):
    """Larger cubes, one ray a voxel, in turn: the time per sample compared with that of the smallest.

    The voxels are those of the same volume, magnified, or noise from a hash, whose blocks all differ. Rays through noise are
    not terminated early, so every noise block is read.
    """
    kinds, times = {"dense": ("dense", False), "sparse": ("sparse", False), "dense/noise": ("dense", True)}, {}
    sizes = [side for side in sizes if enough_memory(side)]
    for number in range(ROUNDS):
        for kind, (table, noisy) in kinds.items():
            for side in sizes:
                print(f"  round {number + 1} of {ROUNDS}, {side}^3, {kind}", file=sys.stderr, flush=True)
                source = ["--noise", "1"] if noisy else [str(volume), "--magnify", str(side // SIDE)]
                figures = measured(source, f"{side}x{side}x{side}", ["--pixels", str(side), "--table", table, "--unjudged"],
                                   frames=3, epsilon=0 if noisy else EPSILON)
                times.setdefault((kind, side), []).append(figures["ns"])
    return [{"name": f"cpu/post-classified/{kind}/{side}", "value": statistics.median(times[kind, side]), "unit": "ns",
             "ratio_to": f"cpu/post-classified/{kind}/{sizes[0]}", "threads": 1,
             "ratio": statistics.median(times[kind, side]) / statistics.median(times[kind, sizes[0]])}
            for kind in kinds for side in sizes]


def rows(sizes=()):
    prototype = yardstick()
    if prototype:
        prototype("dense", 1)  # builds the prototype and its volume
    volume = YARDSTICK / f"{SIDE}.raw" if prototype else cube()
    if sizes:
        return size_rows(volume, sizes)
    brain = next(iter(sorted(Path("/usr/share/doc").glob("tachyon*/examples/scenes/vol/brain.256x256x109"))), None)
    times, theirs, last = {}, {}, {}
    for number in range(ROUNDS):
        for name, (options, rival) in CASES.items():
            if name.endswith("brain") and brain is None:
                continue
            print(f"  round {number + 1} of {ROUNDS}, {name}", file=sys.stderr, flush=True)
            file, size = (brain, "256x256x109") if name.endswith("brain") else (volume, FULL)
            last[name] = measured(file, size, options)
            times.setdefault(name, []).append(last[name]["ns"])
            if prototype and rival:
                theirs.setdefault(name, []).append(prototype(*rival))
    result = []
    for name, values in times.items():
        figures = {key: value for key, value in last[name].items() if key != "ns"}
        row = {"name": name, "value": statistics.median(values), "unit": "ns", **figures}
        if name in theirs:
            row |= {"ratio_to": "yardstick", "ratio": row["value"] / statistics.median(theirs[name])}
        result.append(row)
    return result + slice_rows(volume, result) + vtk_rows(volume, result)
