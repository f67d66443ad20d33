# SPDX-License-Identifier: Apache-2.0
"""Renders a scene with one of VTK's two volume mappers, for comparison; run by /usr/bin/python3, which has Debian's
python3-vtk9.

Writes an image of floats and prints the time of a frame. Called by `raycast.py` and `understudy study`.

The scene is a JSON file: volume (raw), size, type (u8, u16 or f32), spacing, "knots" (control points: at, where 0 is
value_at_0 and 1 is value_at_1; plain colour; and opacity of one unit_distance), sample_distance, eye, centre, up, angle,
near, far, and pixels. VTK's box ends at the centres of the outermost voxels; its images have 8 bits.
"""

import argparse
import json
import resource
import sys
import time

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

TYPES = {"u8": numpy.uint8, "u16": numpy.uint16, "f32": numpy.float32}


def transfer_function(scene):
    colours, opacities = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    low, high = scene["value_at_0"], scene["value_at_1"]
    for point in scene["knots"]:
        value = low + point["at"] * (high - low)
        opacities.AddPoint(value, point["opacity"])
        colours.AddRGBPoint(value, *point["colour"])
    return colours, opacities


def volume_of(scene, mapper_name, threads):
    voxels = numpy.fromfile(scene["volume"], dtype=TYPES[scene["type"]])
    image = vtk.vtkImageData()
    image.SetDimensions(*scene["size"])
    image.SetSpacing(*scene["spacing"])
    image.SetOrigin(*(distance / 2 for distance in scene["spacing"]))
    image.GetPointData().SetScalars(numpy_to_vtk(voxels, deep=False))
    if mapper_name == "gpu":
        mapper = vtk.vtkOpenGLGPUVolumeRayCastMapper()
        mapper.SetUseJittering(False)
    else:
        mapper = vtk.vtkFixedPointVolumeRayCastMapper()
        if threads > 0:
            mapper.SetNumberOfThreads(threads)
    mapper.SetInputData(image)
    mapper.SetAutoAdjustSampleDistances(False)
    mapper.SetSampleDistance(scene["sample_distance"])
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    colours, opacities = transfer_function(scene)
    volume.GetProperty().SetColor(colours)
    volume.GetProperty().SetScalarOpacity(opacities)
    volume.GetProperty().SetScalarOpacityUnitDistance(scene["unit_distance"])
    volume.GetProperty().SetInterpolationTypeToLinear()
    volume.GetProperty().ShadeOff()
    return volume, voxels


def window_with(volume, scene):
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(0, 0, 0)
    renderer.AddVolume(volume)
    camera = renderer.GetActiveCamera()
    camera.SetViewAngle(scene["angle"])
    camera.SetFocalPoint(*scene["centre"])
    camera.SetPosition(*scene["eye"])
    camera.SetViewUp(*scene["up"])
    camera.SetClippingRange(scene["near"], scene["far"])
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetAlphaBitPlanes(1)
    window.SetSize(scene["pixels"], scene["pixels"])
    window.AddRenderer(renderer)
    return window


def processor_seconds():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def image_of(window):
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.SetInputBufferTypeToRGBA()
    grab.ReadFrontBufferOff()
    grab.Update()
    return vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).astype(numpy.float32) / 255


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene")
    parser.add_argument("--mapper", choices=("gpu", "fixed-point"), required=True)
    parser.add_argument("--threads", type=int, default=0, help="of the fixed-point mapper; 0: as many as it likes")
    parser.add_argument("--frames", type=int, default=5)
    parser.add_argument("--image", required=True, help="floats, RGBA, rows bottom up")
    arguments = parser.parse_args()
    with open(arguments.scene, encoding="utf-8") as file:
        scene = json.load(file)
    volume, voxels = volume_of(scene, arguments.mapper, arguments.threads)
    window = window_with(volume, scene)
    window.Render()
    image_of(window)
    processor, wall = [], []
    for _ in range(arguments.frames):
        volume.GetMapper().Modified()
        before, begin = processor_seconds(), time.monotonic()
        window.Render()
        window.WaitForCompletion()
        processor.append(processor_seconds() - before)
        wall.append(time.monotonic() - begin)
    image_of(window).tofile(arguments.image)
    del voxels
    middle = len(wall) // 2
    json.dump({"seconds": sorted(processor)[middle], "wall_seconds": sorted(wall)[middle]}, sys.stdout)


if __name__ == "__main__":
    main()
