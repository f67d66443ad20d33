# SPDX-License-Identifier: Apache-2.0
"""How the demo and the benchmarks run a viewer: bare, or under `understudy run`."""

import json
import os
import re
import shutil
import statistics
import subprocess
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAMS = ROOT / "build" / "bin"
OUT = ROOT / "out"

ENGINE = "engine.256x256x110"
ENGINE_FOLDER = Path("/usr/share/doc/tachyon/examples/scenes/vol")

# Variables of the viewers and of Mesa, not of Understudy.
SOFTWARE = {"LIBGL_ALWAYS_SOFTWARE": "1"}
OSG = {"OSG_WINDOW": "0 0 512 512", "OSG_THREADING": "SingleThreaded"}

IMAGE_SECONDS = 90
RUN_SECONDS = 600


class ViewerFailed(RuntimeError):
    """A viewer ended with an error; the message contains its command and the end of its output."""


def understudy(*options):
    """Returns the words that precede a viewer's command."""
    return [str(PROGRAMS / "understudy"), "run", *map(str, options), "--"]


def engine_volume():
    """Returns the path of the CT of an engine, 256 x 256 x 110 bytes, from Debian's tachyon-doc."""
    installed = ENGINE_FOLDER / ENGINE
    if installed.exists():
        return installed
    # Slim container images install packages without /usr/share/doc: take the file from the package itself.
    kept = OUT / "data"
    unpacked = kept / str(ENGINE_FOLDER).lstrip("/") / ENGINE
    if not unpacked.exists():
        kept.mkdir(parents=True, exist_ok=True)
        subprocess.run(["apt-get", "download", "tachyon-doc"], cwd=kept, check=True, stdout=subprocess.DEVNULL)
        package = next(kept.glob("tachyon-doc_*.deb"))
        subprocess.run(["dpkg-deb", "--extract", str(package), str(kept)], check=True)
    return unpacked


def run(command, environment=None, seconds=RUN_SECONDS):
    """Runs a command to its end; returns both outputs as text. Raises ViewerFailed if it fails."""
    done = subprocess.run([str(word) for word in command], env={**os.environ, **(environment or {})},
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=seconds,
                          stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        raise ViewerFailed(f"{' '.join(map(str, command))} ended with status {done.returncode}:\n{done.stdout[-2000:]}")
    return done.stdout


def bundled_viewer(prefix, volume, mode, frames, orbit, image, extra=()):
    """Runs understudy-viewer off screen; returns the milliseconds of every frame."""
    text = run([*prefix, PROGRAMS / "understudy-viewer", volume, "--offscreen", "--mode", mode, "--frames", frames,
                "--orbit", orbit, "--screenshot", image, "--print-times", *extra], SOFTWARE)
    times = [float(ms) for ms in re.findall(r"^frame \d+: ([0-9.]+) ms$", text, re.MULTILINE)]
    if len(times) != frames:
        raise ViewerFailed(f"understudy-viewer printed {len(times)} frame times instead of {frames}:\n{text[-2000:]}")
    return times


def steady_median(times, settle=3):
    """Returns the median without the first frames, in which drivers compile and volumes are sent."""
    return statistics.median(times[settle:] or times)


def osgvolume(volume, size):
    """Returns the command of OpenSceneGraph's volume viewer with its fixed-function technique."""
    return ["osgvolume", "--no-shader", "--replace-alpha-with-luminance",
            "--raw", *map(str, size), "1", "1", "little", str(volume)]


def photograph_window(command, display, image):
    """Runs a viewer that cannot save screenshots until its window stops changing, saves the window's image, and ends the
    viewer.
    """
    environment = {**os.environ, **SOFTWARE, **OSG, "DISPLAY": display}
    part = Path(image).with_suffix(".part.png")
    log = Path(image).with_suffix(".log")
    with open(log, "w", encoding="utf-8") as output:
        viewer = subprocess.Popen([str(word) for word in command], env=environment, stdin=subprocess.DEVNULL,
                                  stdout=output, stderr=subprocess.STDOUT)
    try:
        before = None
        until = time.monotonic() + IMAGE_SECONDS
        while time.monotonic() < until and viewer.poll() is None:
            time.sleep(0.5)
            if subprocess.run(["import", "-window", "root", "-crop", "512x512+0+0", "+repage", str(part)],
                              env=environment, stderr=subprocess.DEVNULL).returncode != 0:
                continue
            seen = subprocess.run(["identify", "-format", "%# %k", str(part)], stdout=subprocess.PIPE, text=True).stdout
            if seen == before and int(seen.split()[1]) > 16:
                shutil.move(part, image)
                log.unlink()
                return
            before = seen
    finally:
        part.unlink(missing_ok=True)
        viewer.terminate()
        viewer.wait()
    raise ViewerFailed(f"{command[0]} showed no image:\n{log.read_text(encoding='utf-8')[-2000:]}")


def osgvolume_frame_ms(prefix, volume, size, display, frames=20):
    """Returns the milliseconds of a frame. osgvolume prints none, so the time of a short run is subtracted from that of a
    longer one. Its view does not change, so the reuse of unchanged images is disabled.
    """
    def seconds(count):
        start = time.monotonic()
        run([*prefix, *osgvolume(volume, size)],
            {**SOFTWARE, **OSG, "DISPLAY": display, "OSG_RUN_FRAME_COUNT": str(count),
             "UNDERSTUDY_DISABLE_OPTIMIZATION": "unchanged-images"})
        return time.monotonic() - start
    warm_up = 4
    return 1000 * (seconds(warm_up + frames) - seconds(warm_up)) / frames


def compare(a, b, image=None):
    """Returns {'max', 'rms', 'psnr'} of two images; psnr is None if they are equal."""
    text = run([PROGRAMS / "understudy", "compare", a, b, *(["--map", image] if image else [])])
    found = dict(re.findall(r"^(max|RMS|PSNR) (\S+)", text, re.MULTILINE))
    psnr = float(found["PSNR"])
    return {"max": float(found["max"]), "rms": float(found["RMS"]), "psnr": None if psnr == float("inf") else psnr}


def read_report(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)
