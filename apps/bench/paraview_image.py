# SPDX-License-Identifier: Apache-2.0
"""Renders the images of `ranks.py` and `paraview_frames.py` with ParaView: run by Debian's pvbatch, on one rank or under
mpirun.

If the scene specifies frames, prints the milliseconds of each; the camera turns by one degree per frame.
"""

import json
import math
import sys
import time

from paraview import simple


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        scene = json.load(file)
    side = scene["side"]
    simple._DisableFirstRenderCameraReset()
    reader = simple.ImageReader(FileNames=[scene["volume"]])
    reader.DataScalarType = scene.get("scalars", "float")
    reader.DataByteOrder = "LittleEndian"
    reader.DataExtent = [0, side - 1] * 3
    view = simple.CreateView("RenderView")
    view.ViewSize = [scene["pixels"]] * 2
    view.UseColorPaletteForBackground = 0
    view.BackgroundColorMode = "Single Color"
    view.Background = [0, 0, 0]
    view.OrientationAxesVisibility = 0
    display = simple.Show(reader, view)
    display.SetRepresentationType("Volume")
    display.VolumeRenderingMode = scene.get("mode", "Smart")
    name = reader.PointData.GetArray(0).Name
    simple.ColorBy(display, ("POINTS", name))
    colours, opacities = simple.GetColorTransferFunction(name), simple.GetOpacityTransferFunction(name)
    colours.ColorSpace = "RGB"
    colours.RGBPoints = [x for point in scene["knots"] for x in (point["at"], *point["colour"])]
    opacities.Points = [x for point in scene["knots"] for x in (point["at"], point["opacity"], 0.5, 0)]
    display.ScalarOpacityUnitDistance = 1
    display.SetScalarBarVisibility(view, False)
    middle = (side - 1) / 2
    view.CameraFocalPoint = [middle] * 3
    away = scene["distance"] * side * math.sqrt(3) / 2  # half diagonals, as for understudy render --camera

    def look(azimuth):
        around, above = math.radians(azimuth), math.radians(scene["elevation"])
        back = (math.cos(above) * math.sin(around), -math.cos(above) * math.cos(around), math.sin(above))
        view.CameraPosition = [middle + away * d for d in back]

    view.CameraViewUp = [0, 0, 1]
    view.CameraViewAngle = 30
    simple.GetSettingsProxy("RenderViewSettings").RemoteRenderThreshold = 0
    for frame in range(scene.get("frames", 0)):
        look(scene["azimuth"] + frame)
        start = time.perf_counter()
        simple.Render(view)
        print(f"frame {1000 * (time.perf_counter() - start):.3f} ms", flush=True)
    look(scene["azimuth"])
    simple.Render(view)
    simple.SaveScreenshot(sys.argv[2], view, ImageResolution=[scene["pixels"]] * 2)


main()
