# SPDX-License-Identifier: Apache-2.0
"""Ray casting of volumes in NumPy arrays, and viewers under Understudy.

    import numpy, understudy

    scan = numpy.load("scan.npy")                       # (z, y, x)
    image = understudy.render(scan, transfer_function="ct", camera=(30, 20, 4), size=(800, 600))

    volume = understudy.Volume(scan, spacing=(0.5, 0.5, 1.0))
    for azimuth in range(0, 360, 5):                    # the texels are converted once
        frame = volume.render(camera=(azimuth, 20, 4), surfaces=["40%,#e8c090,0.5"], light="all")

    report = understudy.run(["osgvolume", "scan.nrrd"], nodes=4)
    print(report.frames_substituted, report.time_ms["substituted_median"])

Images are float32 arrays of shape (height, width, 4): premultiplied RGBA, the top row first, without rounding. Invalid
arguments raise ValueError, with the message of the command line; lost render nodes raise NodesLost.
"""

import contextlib
import json
import operator as operator_module
import os
import shutil
import subprocess
import tempfile
import time
import weakref
from pathlib import Path

import numpy

from . import _native

__version__ = _native.__version__
__all__ = ["Nodes", "NodesLost", "Report", "Volume", "over", "read_report", "render", "run", "transfer_functions"]

_CHOICES = {
    "method": ("post-classified", "pre-integrated", "adaptive"),
    "operator": ("over", "max", "add", "first-hit"),
    "light": ("", "all", "surfaces"),
    "texels": ("", "u8", "u16", "f32"),
}


#: The render nodes do not answer, or could not be started. The next image tries to connect again.
NodesLost = _native.NodesLost


def transfer_functions():
    """Returns the names of the built-in transfer functions."""
    return _native.transfer_functions()


def _words(numbers, separator=","):
    return numbers if isinstance(numbers, str) else separator.join(repr(float(number)) for number in numbers)


def _control_points(table, value_range):
    """Returns the JSON of a transfer function: of a dict, as in a file, or of an (N, 4) array of plain RGBA over the value
    range.
    """
    if isinstance(table, dict):
        try:
            return json.dumps(table, allow_nan=False, default=float)
        except (TypeError, ValueError) as error:
            raise ValueError(f"transfer_function: {error}") from None
    rows = numpy.asarray(table, dtype=float)
    if not numpy.isfinite(rows).all():
        raise ValueError("transfer_function: an array with entries that are not finite")
    if rows.ndim != 2 or rows.shape[1] != 4 or len(rows) < 2:
        raise ValueError(f"transfer_function: an array of shape {rows.shape}; give (N, 4): red, green, blue and the opacity of "
                         "one voxel's length, each 0 to 1")
    low, high = (0.0, 1.0) if value_range is None else map(float, value_range)
    points = [{"at": low + (high - low) * i / (len(rows) - 1), "colour": row[:3].tolist(), "opacity": float(row[3])}
              for i, row in enumerate(rows)]
    return json.dumps({"positions": "range" if value_range is None else "values", "knots": points})


class Volume:
    """A volume of scalars that can be rendered.

    array    shape (z, y, x), of any integer or float type. A C-contiguous array in native byte order is not copied, and must
             not change while the volume is in use; others are copied once.
    spacing  distances between voxels along x, y and z, in any unit.
    nodes    a group of render nodes (Nodes); None: render in this process, on all cores.

    Integers of 8 and 16 bits keep their type, all other types become float32. NaN is transparent.
    """

    def __init__(self, array, spacing=(1.0, 1.0, 1.0), nodes=None):
        array = numpy.asarray(array)
        if array.ndim != 3 or 0 in array.shape:
            raise ValueError(f"an array of shape {array.shape}; give a volume of shape (z, y, x)")
        if array.dtype.kind == "b":
            array = array.view(numpy.uint8)
        if array.dtype.kind not in "uif" or array.dtype.itemsize > 8:
            raise ValueError(f"an array of {array.dtype}; give integers or floats of up to 64 bits")
        if array.dtype.kind == "f" and array.dtype.itemsize == 2:  # in either byte order
            array = array.astype(numpy.float32)
        array = numpy.ascontiguousarray(array, dtype=array.dtype.newbyteorder("="))
        if len(spacing) != 3 or not all(float(distance) > 0 for distance in spacing):
            raise ValueError(f"spacing {spacing}; give three positive distances, along x, y and z")
        if not (nodes is None or isinstance(nodes, Nodes)):
            raise ValueError(f"nodes={nodes!r}: give understudy.Nodes(RANKS), or None")
        self.shape = array.shape
        self._nodes = nodes  # keeps the nodes alive as long as this volume
        self._native = _native.Volume(array, [float(distance) for distance in spacing], "" if nodes is None else nodes.socket)

    def render(self, transfer_function="grey", camera=(30, 20, 4), size=(512, 512), step=1.0, *, value_range=None,
               operator="over", method="post-classified", tolerance=1e-3, termination=5e-6, surfaces=(), show_volume=True,
               light="", light_from=None, material=None, texels="", texel_range=None):
        """Returns an image of the volume: float32, (height, width, 4), premultiplied RGBA, the top row first.

        transfer_function  a built-in name (transfer_functions()), a path to a JSON file, such a file as a dict, or an (N, 4)
                           array of plain RGBA over `value_range`, whose alpha is the opacity of one voxel's length
        camera             azimuth and elevation in degrees, distance in half diagonals of the volume, and, if given, roll
        size               (width, height) in pixels
        step               distance between samples, in voxels
        value_range        values of the volume at the first and last row of an array; None: the volume's minimum and maximum
        operator           "over", "max", "add" or "first-hit"
        method             "post-classified", "pre-integrated" or "adaptive" (steps divided until each is within `tolerance`)
        termination        a ray ends where its transparency falls below this value
        surfaces           iso-surfaces: a value, or "VALUE[,COLOUR[,OPACITY]]" as "40%,#e8c090,0.5"
        show_volume        False: only the surfaces
        light              "all" or "surfaces"; the light is at the eye unless light_from=(azimuth, elevation)
        material           (ambient, diffuse, specular, shininess)
        texels             "u8", "u16" or "f32": type that scalars are converted to; texel_range=(low, high): the values it spans
        """
        for name, value in {"operator": operator, "method": method, "light": light, "texels": texels}.items():
            if value not in _CHOICES[name]:
                raise ValueError(f"{name}={value!r}: give one of {', '.join(repr(word) for word in _CHOICES[name] if word)}")
        named = isinstance(transfer_function, (str, os.PathLike))
        if named and value_range is not None:
            raise ValueError("value_range belongs to a transfer function that is an array")
        surfaces = [surfaces] if isinstance(surfaces, (str, int, float)) else surfaces
        settings = {
            "transfer_function": os.fspath(transfer_function) if named else "grey",
            "camera": _words(camera), "size": size if isinstance(size, str) else "x".join(str(int(side)) for side in size),
            "step": float(step), "termination": float(termination), "operator": operator, "method": method,
            "tolerance": float(tolerance), "surfaces": [str(surface) for surface in surfaces], "no_volume": not show_volume,
            "light": light, "texels": texels,
        }
        for name, numbers in {"light_from": light_from, "material": material, "range": texel_range}.items():
            if numbers is not None:
                settings[name] = _words(numbers)
        try:
            return self._native.render(settings, "" if named else _control_points(transfer_function, value_range))
        except NodesLost as error:
            raise NodesLost(f"{error}; is there a group of nodes still? understudy.Nodes starts another") from None
        except RuntimeError as error:
            raise ValueError(str(error)) from None


def render(array, transfer_function="grey", camera=(30, 20, 4), size=(512, 512), step=1.0, *, spacing=(1.0, 1.0, 1.0), nodes=None,
           **settings):
    """Returns one image of an array: Volume(array, spacing, nodes).render(…). `nodes` may also be a number of ranks, which are
    started for this image only.
    """
    with contextlib.ExitStack() as stack:
        if nodes is not None and not isinstance(nodes, Nodes):
            ranks = operator_module.index(nodes)
            nodes = stack.enter_context(Nodes(ranks)) if ranks > 0 else None
        return Volume(array, spacing, nodes).render(transfer_function, camera, size, step, **settings)


def over(image, background=(0.0, 0.0, 0.0)):
    """Composites an image over an opaque colour; returns uint8 RGB, which Pillow and matplotlib can save."""
    image = numpy.asarray(image)
    colours = image[..., :3] + (1 - image[..., 3:]) * numpy.asarray(background, dtype=numpy.float32)
    return (numpy.clip(colours, 0, 1) * 255 + 0.5).astype(numpy.uint8)


def program(name="understudy"):
    """Returns the path of an installed program: in UNDERSTUDY_BIN, in the folder of programs beside this module, or on
    PATH.
    """
    beside = [parent / "bin" / name for parent in Path(__file__).resolve().parents]
    chosen = [Path(os.environ["UNDERSTUDY_BIN"]) / name] if "UNDERSTUDY_BIN" in os.environ else []
    for path in chosen + beside:
        if os.access(path, os.X_OK) and path.is_file():
            return str(path)
    found = shutil.which(name)
    if found is None:
        raise FileNotFoundError(f"{name} is neither beside the module 'understudy' nor on PATH; set UNDERSTUDY_BIN to its folder")
    return found


class Nodes:
    """A group of render nodes, started by mpirun on this machine or on the hosts of a hostfile.

        with understudy.Nodes(4) as nodes:
            volume = understudy.Volume(scan, nodes=nodes)

    The nodes end with close(), at the end of the `with` block, or with this process.
    """

    def __init__(self, ranks, hostfile=None, options=()):
        self._folder = tempfile.TemporaryDirectory(prefix="understudy-")
        folder = Path(self._folder.name) / "nodes"
        folder.mkdir(mode=0o700)
        words = [program(), "serve", "-n", str(int(ranks)), "--folder", str(folder), "--image-time", "0", "--while", str(os.getpid())]
        words += ["--hostfile", os.fspath(hostfile)] if hostfile else []
        log_path = Path(self._folder.name) / "log"
        with log_path.open("wb") as log:
            # In a session of their own, because Python may continue after the terminal's Ctrl-C.
            self._process = subprocess.Popen(words + list(options), stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                                             start_new_session=True)
        self._end = weakref.finalize(self, Nodes._ended, self._process, self._folder)
        self.socket = str(folder / "nodes.sock")
        try:
            patience = time.monotonic() + 60
            while self.running() and not os.path.exists(self.socket) and time.monotonic() < patience:
                time.sleep(0.01)
            if not os.path.exists(self.socket):
                raise NodesLost(log_path.read_text(errors="replace").strip() or "the render nodes could not be started")
        except BaseException:
            self.close()
            raise

    @staticmethod
    def _ended(process, folder):
        process.terminate()
        process.wait()
        folder.cleanup()

    def running(self):
        return self._process.poll() is None

    def close(self):
        self._end()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


class Report(dict):
    """The figures of a run, by the keys of docs/report.md. Keys are also attributes, unless dict has an attribute of that name:
    report.volumes[0].draws.substituted."""

    def __getattr__(self, name):
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"the report has no '{name}'; it has {', '.join(self)}") from None


def read_report(path):
    """Reads a report written by `understudy run --report` or `understudy render --report`."""
    return json.loads(Path(path).read_text(encoding="utf-8"), object_hook=Report)


def run(command, nodes=0, options=(), check=True, **more):
    """Runs a viewer under Understudy, and returns its Report, with the viewer's exit status as `exit_status`.

    command  the viewer and its arguments
    nodes    MPI ranks; 0: volumes are rendered inside the viewer
    options  further options of `understudy run`, as ["--error", "1/255"]
    check    raise subprocess.CalledProcessError if the viewer's exit status is not 0
    more     arguments of subprocess.run(), such as cwd and env
    """
    with tempfile.TemporaryDirectory(prefix="understudy-") as folder:
        path = Path(folder) / "report.json"
        words = [program(), "run", "-n", str(int(nodes)), "--report", str(path), *options, "--", *map(os.fspath, command)]
        status = subprocess.run(words, check=check, **more).returncode
        report = read_report(path)
    report["exit_status"] = status
    return report
