# SPDX-License-Identifier: Apache-2.0
"""Kills a rank, mpirun, the GL server or the launcher at a random moment of a run: nothing of the run may remain.

    killed_processes.py UNDERSTUDY UNDERSTUDY-VIEWER RUNS SEED

Makes RUNS runs for each of them, in separate namespaces for processes and /dev/shm. The run must end in every case.
"""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from own_namespaces import go_on_inside

SIDE = 32
FRAMES = 20
PATIENCE_SECONDS = 120
YOUNG_SECONDS = 10  # apps/understudy/launch/run_folder.cc
SHARED_MEMORY = Path("/dev/shm")
# Identified by their command lines; None: the launcher, which is started here.
VICTIMS = {"rank": "understudy-node", "mpirun": "mpirun", "GL server": "gl-server", "launcher": None}


def processes():
    """The command lines of all running processes but this one."""
    found = {}
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit() and int(folder.name) != os.getpid():
            try:
                words = (folder / "cmdline").read_bytes().split(b"\0")
            except OSError:
                continue
            if words[0]:  # zombies have none
                found[int(folder.name)] = b" ".join(words).decode(errors="replace")
    return found


def victims_of(word, launcher):
    """Process ids of possible victims, by the program that runs, not by the arguments of programs that start it."""
    if word is None:
        return [launcher]
    if word == "gl-server":
        return [pid for pid, line in processes().items() if line.split(" ")[1:2] == [word]]
    return [pid for pid, line in processes().items() if Path(line.split(" ")[0]).name == word]


class Runs:
    def __init__(self, understudy, viewer, folder):
        self.understudy, self.viewer, self.folder = understudy, viewer, folder
        self.volume = folder / f"volume.{SIDE}x{SIDE}x{SIDE}"
        self.volume.write_bytes(random.Random(1).randbytes(SIDE**3))
        self.runtime = folder / "runtime"
        self.runtime.mkdir(mode=0o700)

    def environment(self):
        kept = {name: value for name, value in os.environ.items() if name.startswith(("OMPI_", "LIBGL_", "MESA_", "PRTE_"))}
        return kept | {"PATH": "/usr/bin:/bin", "HOME": str(self.folder), "XDG_RUNTIME_DIR": str(self.runtime)}

    def start(self, *options, frames=FRAMES):
        with open(self.folder / "out", "w", encoding="utf-8") as out:
            return subprocess.Popen(
                [self.understudy, "run", "-n", "2", "--speed-guard", "off", *options, "--", self.viewer, self.volume, "--mode",
                 "table", "--offscreen", "--window-size", "64", "64", "--frames", str(frames), "--orbit", "3"],
                env=self.environment(), cwd=self.folder, stdout=out, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)

    def said(self):
        return (self.folder / "out").read_text(errors="replace")

    def options(self, victim):
        return ["--remote"] if victim == "GL server" else []

    def duration(self, victim):
        begun = time.monotonic()
        process = self.start(*self.options(victim))
        if process.wait(PATIENCE_SECONDS) != 0:
            raise SystemExit(f"a run in which nobody is killed fails:\n{self.said()}")
        return time.monotonic() - begun

    def kill_in(self, victim, moment):
        """Runs and kills; returns how many processes were killed."""
        process = self.start(*self.options(victim))
        time.sleep(moment)
        killed = victims_of(VICTIMS[victim], process.pid)[:1] if process.poll() is None else []
        for pid in killed:
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                killed = []
        process.wait(PATIENCE_SECONDS)
        return len(killed)

    def clean_up(self):
        """Leftovers of a killed launcher are removed by the next launcher that starts when they are old enough."""
        time.sleep(YOUNG_SECONDS + 2)
        if self.start(frames=1).wait(PATIENCE_SECONDS) != 0:
            raise SystemExit(f"the run after killed launchers fails:\n{self.said()}")

    def left(self, *folders):
        """What is left of a run after some time to end."""
        for _ in range(100):
            left = [f"process {pid}: {line}" for pid, line in processes().items()]
            left += [str(path) for folder in folders for path in folder.rglob("*")]
            if not left:
                break
            time.sleep(0.1)
        return left


def main():
    go_on_inside(["ip", "link", "set", "lo", "up"], ["mount", "-t", "tmpfs", "tmpfs", "/dev/shm"])
    understudy, viewer, runs, seed = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
    moments = random.Random(seed)
    with tempfile.TemporaryDirectory() as name:
        here = Runs(understudy, viewer, Path(name))
        for victim in VICTIMS:
            longest = here.duration(victim)
            if left := here.left(SHARED_MEMORY, here.runtime):
                raise SystemExit(f"a run in which nobody is killed leaves {left}")
            killed = 0
            for _ in range(runs):
                moment = moments.uniform(0, longest)
                killed += here.kill_in(victim, moment)
                folders = [SHARED_MEMORY] if victim == "launcher" else [SHARED_MEMORY, here.runtime]
                if left := here.left(*folders):
                    raise SystemExit(f"{victim} killed after {moment:.3f} s (seed {seed}): left are\n" +
                                     "\n".join([*left, here.said()]))
            if victim == "launcher":
                here.clean_up()
                if left := here.left(SHARED_MEMORY, here.runtime):
                    raise SystemExit("the run after killed launchers leaves\n" + "\n".join(left))
            print(f"{victim}: {killed} killed in {runs} runs of {longest:.1f} s, nothing left", flush=True)


main()
