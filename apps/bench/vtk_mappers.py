"""The pictures of `raycast.py` by VTK's two volume mappers, for comparison: run by /usr/bin/python3, which knows Debian's
python3-vtk9. Writes one picture of floats and prints the processor time of a frame.

The same voxels, camera, table of 256 colours and one sample a voxel. VTK's box ends at the outermost voxels' centres, its
pictures have 8 bits.
"""

import argparse
import json
import math
import resource
import sys

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy


def transfer_function(name):
    """Colours, not multiplied by opacity, and opacities of one voxel's way, as in raycast.cc."""
    colours, opacities = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    first_visible = 140
    for i in range(256):
        dense = 0.002 + 0.03 * i / 255
        sparse = 0 if i < first_visible else min(1, 0.02 + 0.3 * (i - first_visible) / 60)
        opacities.AddPoint(i, sparse if name == "sparse" else dense)
        colours.AddRGBPoint(i, 0.3 + 0.7 * i / 255, 0.5 + 0.5 * math.sin(i * 0.05), 1 - 0.8 * i / 255)
    return colours, opacities


def volume_of(arguments):
    voxels = numpy.fromfile(arguments.volume, dtype=numpy.uint8)
    image = vtk.vtkImageData()
    image.SetDimensions(*arguments.size)
    image.GetPointData().SetScalars(numpy_to_vtk(voxels, deep=False))
    if arguments.mapper == "gpu":
        mapper = vtk.vtkOpenGLGPUVolumeRayCastMapper()
        mapper.SetUseJittering(False)
    else:
        mapper = vtk.vtkFixedPointVolumeRayCastMapper()
        mapper.SetNumberOfThreads(1)
    mapper.SetInputData(image)
    mapper.SetAutoAdjustSampleDistances(False)
    mapper.SetSampleDistance(1)
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    colours, opacities = transfer_function(arguments.table)
    volume.GetProperty().SetColor(colours)
    volume.GetProperty().SetScalarOpacity(opacities)
    volume.GetProperty().SetScalarOpacityUnitDistance(1)
    volume.GetProperty().SetInterpolationTypeToLinear()
    volume.GetProperty().ShadeOff()
    return volume, voxels


def window_with(volume, arguments):
    """From two edges away, 30 degrees around and 25 above, with an opening of 40 degrees, as in raycast.cc."""
    side = max(arguments.size)
    around, above = math.radians(30), math.radians(25)
    back = (math.sin(around) * math.cos(above), math.sin(above), math.cos(around) * math.cos(above))
    centre = [(n - 1) / 2 for n in arguments.size]
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(0, 0, 0)
    renderer.AddVolume(volume)
    camera = renderer.GetActiveCamera()
    camera.SetViewAngle(40)
    camera.SetFocalPoint(*centre)
    camera.SetPosition(*(c + 2 * side * b for c, b in zip(centre, back)))
    camera.SetViewUp(0, 1, 0)
    camera.SetClippingRange(0.5 * side, 4 * side)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetAlphaBitPlanes(1)
    window.SetSize(arguments.pixels, arguments.pixels)
    window.AddRenderer(renderer)
    return window


def processor_seconds():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def picture_of(window):
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.SetInputBufferTypeToRGBA()
    grab.ReadFrontBufferOff()
    grab.Update()
    return vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).astype(numpy.float32) / 255


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("volume")
    parser.add_argument("--size", type=lambda text: [int(n) for n in text.split("x")], required=True)
    parser.add_argument("--table", choices=("dense", "sparse"), required=True)
    parser.add_argument("--mapper", choices=("gpu", "fixed-point"), required=True)
    parser.add_argument("--pixels", type=int, default=512)
    parser.add_argument("--frames", type=int, default=5)
    parser.add_argument("--picture", required=True, help="floats, RGBA, rows bottom up")
    arguments = parser.parse_args()
    volume, voxels = volume_of(arguments)
    window = window_with(volume, arguments)
    window.Render()
    picture_of(window)
    times = []
    for _ in range(arguments.frames):
        volume.GetMapper().Modified()
        before = processor_seconds()
        window.Render()
        window.WaitForCompletion()
        times.append(processor_seconds() - before)
    picture_of(window).tofile(arguments.picture)
    del voxels
    json.dump({"seconds": sorted(times)[len(times) // 2]}, sys.stdout)


if __name__ == "__main__":
    main()
