# SPDX-License-Identifier: Apache-2.0
"""Viewers whose nodes or OpenGL are at the other end of a network connection: milliseconds and bytes a frame.

Lines: none (one machine, Unix sockets); TCP on this machine; and two hosts, which are network namespaces of this machine,
joined by 1 Gbit/s with a round-trip time of 0.5 ms, or by 100 Mbit/s with 20 ms (tests/hosts). Ways: the viewer's own OpenGL
with remote nodes, also with bytes for the nodes' images; and everything on a remote GL server, also with JPEG images while
the view turns. The bundled viewer turns 256^3 voxels in 512^2 pixels, or is at rest; glxgears has no volume. Each round runs
every line, and each line every way; times and ratios are medians over the rounds. Traffic is the difference between a longer
and a shorter run: upwards before compression, because the volume, which is compressed according to the estimated bandwidth,
is sent in both runs; downwards as sent. The cost of encryption is measured on noise sent between two threads, with and
without encryption in turns, at the full speed of this machine's network and limited to 1 Gbit/s (encryption.cc). Only root
can create such connections.
"""

import contextlib
import json
import os
import re
import statistics
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "demo")]
import frame  # noqa: E402
import viewers  # noqa: E402
from display import VirtualDisplay  # noqa: E402

HOSTS = viewers.ROOT / "tests" / "hosts"
SWITCH = viewers.ROOT / "build" / "tests" / "hosts" / "delaying_switch"
LINES = {"one machine": None, "loopback": None, "1 Gbit/s 0.5 ms": ("1gbit", 250), "100 Mbit/s 20 ms": ("100mbit", 10000)}
WAYS = {"nodes": [], "nodes, bytes": ["--pixels", "byte"], "stage": ["--remote"],
        "stage, quality 80": ["--remote", "--quality", "80"]}
GIGABIT = "1 Gbit/s"
PORT = 7070
ROUNDS = 3
FRAMES = (6, 26)  # the shorter and the longer run
GEARS_SECONDS = 8
SIDE = 512


def on(host):
    return ["ip", "netns", "exec", host] if host else []


@contextlib.contextmanager
def server(folder, host, options=()):
    """Runs `understudy serve` with two nodes and a GL server; yields the options that connect to it."""
    secret = folder / "secret"
    where = f"10.77.0.1:{PORT}" if host else f"127.0.0.1:{PORT}"
    with open(folder / "serve.log", "w+", encoding="utf-8") as log:
        process = subprocess.Popen(
            [*on(host), str(viewers.PROGRAMS / "understudy"), "serve", "-n", "2", "--socket", str(folder / "nodes.sock"),
             "--listen", where, "--secret-file", str(secret), "--gl-server", *options], stdout=log, stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL, env={**os.environ, **viewers.SOFTWARE, "DISPLAY": ""})
        try:
            until = time.monotonic() + 30
            while "also at" not in (folder / "serve.log").read_text(encoding="utf-8"):
                if process.poll() is not None or time.monotonic() > until:
                    raise viewers.ViewerFailed((folder / "serve.log").read_text(encoding="utf-8"))
                time.sleep(0.1)
            yield ["--connect", where, "--secret-file", str(secret)]
        finally:
            process.terminate()
            process.wait()


class Client:
    """Runs viewers at one end of a line."""

    def __init__(self, folder, host, link, display):
        self.folder, self.host, self.display = folder, host, display
        self.link = link or ["-n", "2"]
        self.local = link is None

    def prefix(self, options):
        if self.local:
            options = [option for option in options if option == "--remote"]
        return [*on(self.host), *viewers.understudy(*options, *self.link, "--report", self.folder / "report.json")]

    def environment(self):
        return {**viewers.SOFTWARE, "DISPLAY": self.display, "vblank_mode": "0"}

    def travelled(self):
        """Returns the bytes up and down, the round trips and the frames of the last run."""
        report = viewers.read_report(self.folder / "report.json")
        connection, remote = report.get("connection"), report.get("server_connection")
        return {"up": connection["up"]["payload_bytes"] if connection else 0,
                "down": connection["down"]["bytes"] if connection else 0,
                "round_trips": remote["round_trips"] if remote else connection["up"]["messages"] if connection else 0,
                "frames": remote["frames"] if remote else report["frames"]}

    def viewer(self, options, frames, orbit):
        text = viewers.run([*self.prefix(options), viewers.PROGRAMS / "understudy-viewer", frame.cube(), "--mode", "table",
                            "--window-size", SIDE, SIDE, "--frames", frames, "--orbit", orbit, "--print-times"],
                           self.environment())
        return [float(ms) for ms in re.findall(r"^frame \d+: ([0-9.]+) ms$", text, re.MULTILINE)]

    def turning(self, options, orbit=4):
        """Returns the milliseconds of a frame, and its traffic."""
        counts = []
        for frames in FRAMES:
            times = self.viewer(options, frames, orbit)
            counts.append(self.travelled())
        between = FRAMES[1] - FRAMES[0]
        return {"ms": statistics.fmean(times[FRAMES[0]:])} | {
            what: (counts[1][what] - counts[0][what]) / between for what in ("up", "down", "round_trips")}

    def gears(self, options):
        """Returns the same for glxgears, which draws until it is terminated."""
        command = ["timeout", GEARS_SECONDS, *self.prefix(options), "glxgears", "-geometry", f"{SIDE}x{SIDE}"]
        subprocess.run([str(word) for word in command], env={**os.environ, **self.environment()}, stdin=subprocess.DEVNULL,
                       stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        total = self.travelled()
        frames = max(total["frames"], 1)
        return {"ms": 1000 * GEARS_SECONDS / frames} | {what: total[what] / frames for what in ("up", "down", "round_trips")}


def measure(line, folder, display, host_of_server=None, host_of_client=None):
    """Measures each figure of one line once; returns them by name."""
    with contextlib.ExitStack() as stack:
        link = None if line == "one machine" else stack.enter_context(server(folder, host_of_server))
        client = Client(folder, host_of_client, link, display)
        figures = {}
        for way in ["nodes", "stage"] if link is None else WAYS:
            print(f"  {line}, {way}", file=sys.stderr, flush=True)
            figures[f"turning/{way}"] = client.turning(WAYS[way])
        figures["resting/stage"] = client.turning(["--remote"], orbit=0)
        figures["glxgears/stage"] = client.gears(["--remote"])
        return figures


def encryption():
    """Returns processor time a byte at both ends and bytes a second, with and without encryption in turns."""
    text = subprocess.run([str(viewers.PROGRAMS / "understudy-bench-encryption")], stdout=subprocess.PIPE, text=True, check=True).stdout
    return [json.loads(line) for line in text.splitlines()]


def rows_of_encryption(place, turns):
    """Returns the rows; each ratio compares neighbouring turns."""
    pairs = list(zip(turns[::2], turns[1::2]))
    result = []
    for what, unit, scale in (("send_ns_per_byte", "ns/B", 1), ("receive_ns_per_byte", "ns/B", 1), ("bytes_per_second", "MB/s", 1e-6)):
        name = f"remote/encryption/{what}/{place}"
        for at, way in enumerate(("plain", "encrypted")):
            row = {"name": f"{name}/{way}", "value": scale * statistics.median(pair[at][what] for pair in pairs), "unit": unit}
            if way == "encrypted":
                row |= {"ratio_to": f"{name}/plain", "ratio": statistics.median(pair[1][what] / pair[0][what] for pair in pairs)}
            result.append(row)
    return result


def in_namespaces(line, folder, display):
    """Measures the same between two hosts, in a process whose namespaces end with it."""
    rate, one_way = LINES.get(line, ("1gbit", 0))
    text = subprocess.run(
        ["unshare", "--mount", "--net", "--pid", "--fork", "--mount-proc", "--propagation", "private", sys.executable, "-B",
         str(HERE / "remote.py"), line, rate, str(one_way), str(folder), display],
        stdout=subprocess.PIPE, text=True, check=True, stdin=subprocess.DEVNULL).stdout
    return json.loads(text)


def rows():
    folder = viewers.OUT / "bench" / "remote"
    folder.mkdir(parents=True, exist_ok=True)
    lines = [line for line, hosts in LINES.items() if not hosts or (os.geteuid() == 0 and SWITCH.exists())]
    for line in LINES.keys() - lines:
        print(f"  {line}: needs root, and {SWITCH}", file=sys.stderr)
    rounds = []
    with VirtualDisplay() as display:
        for number in range(ROUNDS):
            print(f"  round {number + 1} of {ROUNDS}", file=sys.stderr)
            rounds.append({line: (in_namespaces if LINES[line] else measure)(line, folder, display) for line in lines})
    result = []
    for line in lines:
        for name in rounds[0][line]:
            row = {"name": f"remote/{name}/{line}", "value": median_of(rounds, line, name, "ms"), "unit": "ms"}
            row |= {f"bytes_{way}": median_of(rounds, line, name, way) for way in ("up", "down")}
            row["round_trips"] = median_of(rounds, line, name, "round_trips")
            if line != "one machine" and name in rounds[0]["one machine"]:
                row |= {"ratio_to": f"remote/{name}/one machine",
                        "ratio": statistics.median(each[line][name]["ms"] / each["one machine"][name]["ms"] for each in rounds)}
            result.append(row)
    result += rows_of_encryption("loopback", encryption())
    if os.geteuid() == 0:
        result += rows_of_encryption(GIGABIT, in_namespaces(GIGABIT, folder, ""))
    return result


def median_of(rounds, line, name, what):
    return statistics.median(each[line][name][what] for each in rounds)


def main(line, rate, one_way, folder, display):
    if line == GIGABIT:
        for command in (["ip", "link", "set", "lo", "up", "mtu", "1500"],
                        ["tc", "qdisc", "add", "dev", "lo", "root", "tbf", "rate", rate, "burst", "256k", "latency", "20ms"]):
            subprocess.run(command, check=True)
        json.dump(encryption(), sys.stdout)
        return
    subprocess.run(["sh", str(HOSTS / "network.sh"), str(SWITCH), one_way, "2", folder, rate], check=True,
                   stdout=sys.stderr)
    time.sleep(1)
    json.dump(measure(line, Path(folder), display, "host1", "host2"), sys.stdout)


if __name__ == "__main__":
    main(*sys.argv[1:])
