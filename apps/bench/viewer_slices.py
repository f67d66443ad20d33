# SPDX-License-Identifier: Apache-2.0
"""The bundled viewer's slices on Mesa's llvmpipe: what the image of `raycast.py` costs a program without Understudy."""

import json
import os
import resource
import subprocess
from array import array

import viewers

FRAMES = 4  # timed frames; as many untimed ones come first


def turned_upright(volume, turned, side):
    """Rotates the volume, because the viewer's z axis points up where the benchmark's y does: x stays, y becomes z, and z
    becomes -y.
    """
    voxels = volume.read_bytes()
    with turned.open("wb") as file:
        for up in range(side):
            for away in range(side):
                begin = ((side - 1 - away) * side + up) * side
                file.write(voxels[begin:begin + side])


def processor_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def drawn(command, frames, background, screenshot):
    """Returns the processor time of this number of frames, including everything before the first."""
    before = processor_seconds()
    subprocess.run([*command, "--frames", str(frames), "--background", *[background] * 3, "--screenshot", str(screenshot)],
                   stdout=subprocess.DEVNULL, check=True,
                   env=os.environ | {"LIBGL_ALWAYS_SOFTWARE": "1", "LP_NUM_THREADS": "1"})
    return processor_seconds() - before


def colours(screenshot):
    return subprocess.run(["convert", str(screenshot), "-depth", "8", "rgb:-"], stdout=subprocess.PIPE, check=True).stdout


def write_premultiplied(on_black, on_white, pixels, image):
    """Writes RGBA floats, rows bottom up. The volume's transparency is the difference between the images on white and on
    black.
    """
    floats = array("f")
    for row in range(pixels - 1, -1, -1):
        for pixel in range(row * pixels, (row + 1) * pixels):
            rgb = on_black[3 * pixel:3 * pixel + 3]
            through = (sum(on_white[3 * pixel:3 * pixel + 3]) - sum(rgb)) / 3
            floats.extend([channel / 255 for channel in rgb] + [1 - through / 255])
    image.write_bytes(floats.tobytes())


def seconds_and_image(volume, scene, image):
    """Returns the seconds of one frame; `scene` is as described by raycast.py to VTK. Writes the image for raycast.cc to
    judge.
    """
    side, pixels = scene["size"][0], scene["pixels"]
    upright, table = image.with_name(f"upright.{side}x{side}x{side}"), image.with_suffix(".json")
    turned_upright(volume, upright, side)
    table.write_text(json.dumps({"knots": scene["knots"]}), encoding="utf-8")
    diagonals = 2 / 3**0.5  # two edges, in half diagonals
    command = [str(viewers.PROGRAMS / "understudy-viewer"), str(upright), "--offscreen", "--mode", "table", "--table",
               str(table), "--no-frame", "--azimuth", "30", "--elevation", "25", "--distance", f"{diagonals:.17g}",
               "--field-of-view", str(scene["angle"]), "--window-size", str(pixels), str(pixels)]
    black, white = image.with_suffix(".black.png"), image.with_suffix(".white.png")
    fewer = drawn(command, FRAMES, "1", white)
    more = drawn(command, 2 * FRAMES, "0", black)
    write_premultiplied(colours(black), colours(white), pixels, image)
    upright.unlink()
    return (more - fewer) / FRAMES
