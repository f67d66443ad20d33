#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""./run viewers [NAME…] [--install]: real viewers, bare and under Understudy, as a table.

Runs every viewer that is known to the script at UNDERSTUDY_VIEWERS (../shared/clients/viewer beside the checkout, if the
variable is not set) in five ways, one after the other in every round: bare, under `understudy run` (embedded), under
`understudy run -n 2`, with only LD_PRELOAD=libunderstudy.so, and under `understudy run --remote -n 2` without OpenGL of its
own (GL server), whose image is compared with that of `run -n 2`. The script is called as

    [WITH="command…"] viewer NAME IMAGE.png FRAMES

and prints a line "FRAME ms median X" if the viewer measures itself. Otherwise frame times are Understudy's own; for the bare
viewer, they come from a run whose volume is handed back after the first frame, because the required PSNR is unreachable.

Images, reports and the viewers' output are kept in out/viewers, together with table.json and table.md.
"""

import argparse
import json
import os
import re
import shutil
import signal
import statistics
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
OUT = ROOT / "out" / "viewers"
UNDERSTUDY = ROOT / "build" / "bin" / "understudy"
LIBRARY = ROOT / "build" / "lib" / "libunderstudy.so"
WAYS = ("bare", "embedded", "2 ranks", "preload", "gl-server")

# Requirements of a viewer, by the beginning of its name: programs and modules that exist when it is installed, and the
# Debian packages that provide them. Some of the packages conflict with each other.
NEEDS = {
    "osgvolume": (["osgvolume"], [], ["openscenegraph"]),
    "pyqtgraph": ([], ["pyqtgraph", "OpenGL", "PyQt5.QtOpenGL"],
                  ["python3-pyqtgraph", "python3-opengl", "python3-pyqt5.qtopengl"]),
    "pymol": (["pymol"], [], ["pymol"]),
    "vtk": ([], ["vtkmodules"], ["python3-vtk9"]),
    "vispy": ([], ["vispy", "PyQt5.QtOpenGL"], ["python3-vispy", "python3-pyqt5.qtopengl"]),
    "paraview": (["pvpython"], [], ["paraview", "python3-paraview"]),
    "mrview": (["mrview"], [], ["mrtrix3"]),
}
ALL_NEED = ["xvfb", "imagemagick", "python3-numpy", "mricron-data"]


def say(text):
    print(text, file=sys.stderr, flush=True)


def viewer_script():
    path = Path(os.environ.get("UNDERSTUDY_VIEWERS", ROOT.parent / "shared" / "clients" / "viewer"))
    if not os.access(path, os.X_OK):
        sys.exit(f"viewers: there is no script at {path} that runs viewers; "
                 "set UNDERSTUDY_VIEWERS to one that takes NAME IMAGE.png FRAMES (tests/clients/viewers.py says how)")
    return path


def known_names(script):
    """The names that the script's opening comment lists after "NAME:"."""
    comment = "".join(line[1:] for line in script.read_text(encoding="utf-8").splitlines(keepends=True)[1:]
                      if line.startswith("#"))
    listed = re.search(r"^.*NAME:((?:.*\n)(?:\s{20,}\S.*\n)*)", comment, re.MULTILINE)
    names = listed.group(1).split() if listed else []
    if not names:
        sys.exit(f"viewers: {script} lists no names after \"NAME:\" in its opening comment; name the viewers to run")
    return names


def needs(name):
    return NEEDS.get(name.split("-")[0], ([], [], []))


def missing(name):
    """Message that names what a viewer lacks; empty if it can run."""
    programs, modules, packages = needs(name)
    absent = [program for program in programs if shutil.which(program) is None]
    for module in modules:
        probe = f"import importlib.util, sys; sys.exit(importlib.util.find_spec({module!r}) is None)"
        if subprocess.run(["/usr/bin/python3", "-c", probe], stderr=subprocess.DEVNULL, check=False).returncode != 0:
            absent.append(f"python module {module}")
    return f"not installed ({', '.join(absent)}): --install, or apt-get install {' '.join(packages)}" if absent else ""


def installed(packages):
    text = subprocess.run(["dpkg-query", "-W", "-f", "${db:Status-Status} ${Package}\n", *packages],
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=False).stdout
    return [line.split()[1] for line in text.splitlines() if line.startswith("installed ")]


def install(packages):
    """Installs packages; apt removes packages that conflict with them. Returns an error message, or ""."""
    command = ["env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "-y", "-q", "--no-install-recommends", "install",
               *packages]
    if os.geteuid() != 0:
        command.insert(0, "sudo")
    say(f"installing {' '.join(packages)}")
    log = OUT / "install.log"
    with log.open("ab") as text:
        done = subprocess.run(command, stdout=text, stderr=subprocess.STDOUT, check=False)
    return "" if done.returncode == 0 else f"{' '.join(packages)} could not be installed: see {log}"


def run_group(command, environment, log, seconds):
    """Runs `command` in a separate process group, and ends what is left of it after `seconds`. None: the time was up."""
    with log.open("wb") as text:
        child = subprocess.Popen(command, env=environment, stdout=text, stderr=subprocess.STDOUT, start_new_session=True)
        try:
            return child.wait(seconds)
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGTERM)
            try:
                child.wait(10)
            except subprocess.TimeoutExpired:
                pass
            return None
        finally:
            try:
                os.killpg(child.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass


class Run:
    """One run of a viewer in one way."""

    def __init__(self, script, name, way, frames, seconds, watched=False):
        stem = f"{name}.{way.replace(' ', '_')}{'.watched' if watched else ''}"
        self.image = OUT / f"{stem}.png"
        report, saved = OUT / f"{stem}.json", OUT / f"{stem}.frames"
        for old in (self.image, report):
            old.unlink(missing_ok=True)
        shutil.rmtree(saved, ignore_errors=True)
        environment = dict(os.environ)
        environment["PATH"] = f"{UNDERSTUDY.parent}:{environment['PATH']}"
        environment["WITH"] = {
            "bare": f"{UNDERSTUDY} run --report {report} --" if watched else "",
            "embedded": f"{UNDERSTUDY} run --report {report} --",
            "2 ranks": f"{UNDERSTUDY} run -n 2 --report {report} --",
            # There is no report in this case; an image is saved for every run of slices that is substituted.
            "preload": f"env LD_PRELOAD={LIBRARY} UNDERSTUDY_SAVE_FRAMES={saved}",
            "gl-server": f"{UNDERSTUDY} run --remote -n 2 --report {report} -- env LIBGL_DRIVERS_PATH=/nowhere",
        }[way]
        if watched:
            environment["UNDERSTUDY_VERIFY_PSNR"] = "200"
        # Some viewers draw the same view repeatedly; times must be those of images that are actually rendered. With
        # LD_PRELOAD alone, everything is configured as for users.
        if way != "preload":
            environment["UNDERSTUDY_DISABLE_OPTIMIZATION"] = "unchanged-images"
        if way == "preload":
            saved.mkdir(parents=True)
        log = OUT / f"{stem}.log"
        status = run_group([str(script), name, str(self.image), str(frames)], environment, log, seconds)
        words = log.read_text(encoding="utf-8", errors="replace")
        self.report = json.loads(report.read_text(encoding="utf-8")) if report.exists() else None
        self.saved = len(list(saved.glob("*.pfm"))) if saved.exists() else 0
        shutil.rmtree(saved, ignore_errors=True)
        self.trouble = ""
        if status is None:
            self.trouble = f"no end after {seconds} s"
        elif not self.image.exists():
            self.trouble = f"no image (exit status {status}): see {log.relative_to(ROOT)}"
        measured = re.search(r"^FRAME ms median ([0-9.]+)", words, re.MULTILINE)
        self.own_time = measured is not None
        self.frame_ms = float(measured.group(1)) if measured else None
        if self.frame_ms is None and self.report:
            times = self.report["time_ms"]
            kind = "application_median" if watched or not self.substituted() else "substituted_median"
            self.frame_ms = times[kind] or times["frame_median"]

    def substituted(self):
        if self.report is None:
            return self.saved > 0
        return any(volume["draws"]["substituted"] for volume in self.report["volumes"])

    def reason(self):
        """The most frequent reason for which draws were left to the viewer."""
        if self.report is None:
            return ""
        counts = {}
        for volume in self.report["volumes"]:
            for reason, count in volume["left_because"].items():
                counts[reason] = counts.get(reason, 0) + count
        if counts:
            return max(counts, key=counts.get)
        return "" if self.report["volumes"] else "no draw with a 3-D texture and blending was seen"

    def recognition_ms(self):
        """Time per substituted frame for recognising what was drawn, once a volume is known."""
        return self.report["time_ms"]["recognition_median"] if self.report else None

    def depth_ms(self):
        """Time per substituted frame for reading the depth of geometry drawn before the volume."""
        return self.report["time_ms"]["depth_median"] if self.report else None

    def line(self):
        """Use of the connection to the GL server per frame."""
        return self.report.get("server_connection") if self.report else None

    def calls_a_frame(self):
        if self.report is None or not self.report["frames"]:
            return None
        return sum(process["calls"] for process in self.report["processes"]) / self.report["frames"]


def compared(a, b):
    """PSNR in dB and largest difference of two images; infinite and 0 if they are equal."""
    done = subprocess.run([UNDERSTUDY, "compare", a, b], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          check=False)
    figures = dict(re.findall(r"^(max|PSNR) ([0-9.e+-]+|inf)", done.stdout, re.MULTILINE))
    if "PSNR" not in figures:
        return None, None
    return float(figures["PSNR"]), float(figures["max"])


def median(values):
    values = [value for value in values if value is not None]
    return statistics.median(values) if values else None


def row_of(script, name, arguments):
    """The table row of one viewer."""
    row = {"viewer": name, "ways": {}, "frame_ratio": {}, "calls_a_frame": None, "recognition_ms": None,
           "depth_ms": None, "reason": ""}
    runs = {way: [] for way in WAYS}
    for number in range(arguments.rounds):
        for way in WAYS:
            begun = time.monotonic()
            run = Run(script, name, way, arguments.frames, arguments.seconds)
            if way == "bare" and not run.trouble and run.frame_ms is None:
                run.frame_ms = Run(script, name, way, arguments.frames, arguments.seconds, watched=True).frame_ms
            runs[way].append(run)
            say(f"{name}, round {number + 1} of {arguments.rounds}, {way}: "
                f"{run.trouble or ('substituted' if run.substituted() else 'drawn by the viewer')}"
                f"{f', {run.frame_ms:.1f} ms a frame' if run.frame_ms else ''}"
                f" ({time.monotonic() - begun:.0f} s)")
        if all(run.trouble for way in WAYS for run in runs[way]):
            break
    bare = next((run for run in runs["bare"] if not run.trouble), None)
    if bare is None:
        row["reason"] = f"the bare viewer: {runs['bare'][-1].trouble}"
        return row
    for way in WAYS[1:]:
        run = next((run for run in reversed(runs[way]) if not run.trouble), None)
        if run is None:
            row["ways"][way] = {"trouble": runs[way][-1].trouble}
            continue
        psnr, largest = compared(bare.image, run.image)
        row["ways"][way] = {"substituted": run.substituted(), "psnr": psnr, "max": largest}
    ranks, server = (next((run for run in reversed(runs[way]) if not run.trouble), None) for way in ("2 ranks", "gl-server"))
    if ranks and server:
        row["ways"]["gl-server"]["psnr_to_2_ranks"] = compared(ranks.image, server.image)[0]
        row["line"] = server.line()
    times = {way: median(run.frame_ms for run in runs[way]) for way in WAYS}
    row["frame_ms"] = times
    row["times_by"] = "the viewer" if bare.own_time else "Understudy"
    for way in ("embedded", "2 ranks", "gl-server"):
        if times["bare"] and times[way]:
            row["frame_ratio"][way] = times["bare"] / times[way]
    embedded = next((run for run in runs["embedded"] if not run.trouble), None)
    if embedded:
        row["calls_a_frame"] = embedded.calls_a_frame()
        row["recognition_ms"] = median(run.recognition_ms() for run in runs["embedded"] if not run.trouble)
        row["depth_ms"] = median(run.depth_ms() for run in runs["embedded"] if not run.trouble)
        row["reason"] = embedded.reason()
    return row


def cell_of_way(way):
    if way is None:
        return "–"
    if "trouble" in way:
        return way["trouble"]
    if not way["substituted"]:
        return "no, equal" if way["max"] == 0 else "no"
    return "yes" if way["psnr"] is None else f"yes, {way['psnr']:.1f} dB, max {way['max']:.3f}"


def share_cell(share, bare):
    """In milliseconds, and as a share of the frame that the viewer would draw itself."""
    if share is None:
        return "–"
    return f"{share:.1f} ms" + (f" ({100 * share / bare:.1f} %)" if bare else "")


def markdown(rows):
    drawn_here = WAYS[1:4]
    lines = ["| viewer | embedded | 2 ranks | preload | ms bare | embedded | 2 ranks | recognising | reading depth "
             "| calls a frame | left because |",
             "|---|---|---|---|---|---|---|---|---|---|---|"]
    for row in rows:
        times, ratios = row.get("frame_ms", {}), row["frame_ratio"]
        cells = [row["viewer"], *(cell_of_way(row["ways"].get(way)) for way in drawn_here),
                 f"{times['bare']:.0f}" if times.get("bare") else "–",
                 *(f"{times[way]:.0f} ({ratios[way]:.1f}×)" if way in ratios else "–" for way in ("embedded", "2 ranks")),
                 *(share_cell(row.get(share), times.get("bare")) for share in ("recognition_ms", "depth_ms")),
                 f"{row['calls_a_frame']:.0f}" if row["calls_a_frame"] else "–", row["reason"] or "–"]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join([*lines, "", *gl_server_lines(rows)]) + "\n"


def gl_server_lines(rows):
    """The same viewers without OpenGL: OpenGL and two nodes run on a GL server."""
    lines = ["| viewer without OpenGL | volume | PSNR to 2 ranks | ms | bytes up a frame, with all that is uploaded | down | round trips |",
             "|---|---|---|---|---|---|---|"]
    for row in rows:
        way, line = row["ways"].get("gl-server"), row.get("line")
        if way is None:
            continue
        if line is None:
            lines.append(f"| {row['viewer']} | {way.get('trouble', '–')} | – | – | – | – | – |")
            continue
        psnr, time_of_frame, each = way["psnr_to_2_ranks"], row["frame_ms"].get("gl-server"), line["per_frame"]
        counts = [f"{each[key]:.0f}" if each[key] is not None else "–" for key in ("bytes_up", "bytes_down")]
        trips = f"{each['round_trips']:.1f}" if each["round_trips"] is not None else "–"
        lines.append(f"| {row['viewer']} | {'by nodes' if way['substituted'] else 'by the viewer'} | "
                     f"{'–' if psnr is None else 'equal' if psnr == float('inf') else f'{psnr:.1f} dB'} | "
                     f"{f'{time_of_frame:.0f}' if time_of_frame else '–'} | {counts[0]} | {counts[1]} | {trips} |")
    return lines


def jsonable(value):
    """JSON has no infinity: the PSNR of equal images becomes null."""
    if isinstance(value, dict):
        return {key: jsonable(item) for key, item in value.items()}
    return None if value == float("inf") else value


def write(rows):
    (OUT / "table.json").write_text(json.dumps([jsonable(row) for row in rows], indent=1) + "\n", encoding="utf-8")
    (OUT / "table.md").write_text(markdown(rows), encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(prog="./run viewers", description=__doc__.split("\n\n", maxsplit=1)[0],
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="viewers; without a name all that the script knows")
    parser.add_argument("--install", action="store_true", help="install viewers that are missing, one after the other")
    parser.add_argument("--rounds", type=int, default=2, help="how often the five ways follow each other (2)")
    parser.add_argument("--frames", type=int, default=12, help="frames that a viewer shows (12)")
    parser.add_argument("--seconds", type=int, default=240, help="after these one run of a viewer is given up (240)")
    arguments = parser.parse_args()
    script = viewer_script()
    known = known_names(script)
    for name in arguments.names:
        if name not in known:
            sys.exit(f"viewers: {script} knows no viewer {name}; it knows {' '.join(known)}")
    if not UNDERSTUDY.exists():
        sys.exit("viewers: build/bin/understudy is not built; run ./run build")
    OUT.mkdir(parents=True, exist_ok=True)

    names = arguments.names or known
    removable = [package for _, _, packages in NEEDS.values() for package in packages]
    before = set(installed(removable))
    if arguments.install and (absent := sorted(set(ALL_NEED) - set(installed(ALL_NEED)))):
        install(absent)
    rows = []
    for name in names:
        reason = missing(name)
        if reason and arguments.install:
            reason = install(needs(name)[2]) or missing(name)
        if reason:
            rows.append({"viewer": name, "ways": {}, "frame_ratio": {}, "calls_a_frame": None, "reason": reason})
            say(f"{name}: {reason}")
        else:
            rows.append(row_of(script, name, arguments))
        write(rows)
    if arguments.install and (removed := sorted(before - set(installed(removable)))):
        say("putting back what excluded others")
        install(removed)
    print(markdown(rows), end="")
    say(f"the table, images, reports and the viewers' words are in {OUT.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
