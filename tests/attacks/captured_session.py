# SPDX-License-Identifier: Apache-2.0
"""Captured packets of a session must reveal nothing: no texel, no path, no call, no shader.

    captured_session.py UNDERSTUDY UNDERSTUDY-VIEWER

Runs in a network namespace whose packets are all captured: `render`, a viewer with its own OpenGL, and a viewer with remote
OpenGL. The same runs with --plain show that the search would find the data.
"""

import os
import random
import socket
import struct
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

from attacked_server import port_of, server
from own_namespaces import go_on_inside

SIDE = 48
ETH_P_ALL = 3
PROBE = 16  # consecutive bytes
# Text in the streams of calls: shader sources, and names in queries.
CALL_WORDS = [b"uniform", b"gl_FragColor", b"gl_TexCoord", b"#version"]


class Capture:
    """All packets of the loopback device, with their TCP payloads in order of arrival."""

    def __init__(self):
        self.socket = socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM, socket.htons(ETH_P_ALL))
        self.socket.setsockopt(socket.SOL_SOCKET, 33, 256 << 20)  # SO_RCVBUFFORCE
        self.socket.settimeout(0.2)
        self.streams = {}
        self.stopped = False
        self.thread = threading.Thread(target=self.take_all)
        self.thread.start()

    def take_all(self):
        while not self.stopped:
            try:
                packet, address = self.socket.recvfrom(1 << 18)
            except TimeoutError:
                continue
            # Each packet of this device is seen twice, when leaving and when arriving.
            if address[2] != socket.PACKET_OUTGOING and packet[0] >> 4 == 4 and packet[9] == socket.IPPROTO_TCP:
                self.take(packet)

    def take(self, packet):
        segment = packet[(packet[0] & 15) * 4 : struct.unpack_from(">H", packet, 2)[0] or None]
        self.streams.setdefault(segment[:4], bytearray()).extend(segment[(segment[12] >> 4) * 4 :])

    def finish(self, port):
        """Ends the capture; returns the payloads to and from `port`."""
        self.stopped = True
        self.thread.join()
        self.socket.close()
        return [bytes(payload) for ports, payload in self.streams.items() if port in struct.unpack(">HH", ports)]


def sessions(understudy, viewer, folder, volume, texels, options):
    """Runs sessions; returns the number of captured bytes and how often each kind of content was found in them."""
    process = server(understudy, folder, "--gl-server", "--data", volume.parent, *options, **forwarded())
    try:
        port = port_of(process, folder)
        connect = ["--connect", f"127.0.0.1:{port}", "--secret-file", folder / "secret", *options]
        capture = Capture()
        shown = [viewer, volume, "--mode", "table", "--offscreen", "--window-size", "64", "64"]
        for command in ([understudy, "render", volume, "--size", "64x64", "--out", folder / "a.png", *connect],
                        [understudy, "run", *connect, "--", *shown],
                        [understudy, "run", "--remote", *connect, "--", *shown]):
            done = subprocess.run(command, cwd=folder, env=forwarded() | {"PATH": "/usr/bin:/bin", "HOME": str(folder)},
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
            if done.returncode != 0 or "wrong" in done.stdout:
                raise SystemExit(f"{command[1:3]}: status {done.returncode}\n{done.stdout}")
        captured = capture.finish(port)
    finally:
        process.terminate()
        process.wait(30)
    found = {}
    found["path"] = sum(str(volume).encode() in stream for stream in captured)
    found["head of a message"] = sum(b"USDY" in stream for stream in captured)
    found["shader or call"] = sum(any(word in stream for word in CALL_WORDS) for stream in captured)
    probes = [texels[at : at + PROBE] for at in range(0, len(texels), 997)]
    found["texels"] = sum(probe in stream for stream in captured for probe in probes)
    return sum(map(len, captured)), found


def forwarded():
    return {name: value for name, value in os.environ.items() if name.startswith(("OMPI_", "LIBGL_", "MESA_", "PRTE_"))}


def main():
    go_on_inside(["ip", "link", "set", "lo", "up"])
    understudy, viewer = sys.argv[1:3]
    # Incompressible, so that the texels are transmitted unchanged.
    texels = random.Random(1).randbytes(SIDE**3)
    results = {}
    for options in (["--plain"], []):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "data").mkdir()
            volume = folder / "data" / f"the_scan_of_somebody.{SIDE}x{SIDE}x{SIDE}"
            volume.write_bytes(texels)
            total, found = sessions(understudy, viewer, folder, volume, texels, options)
            print(f"{options or 'encrypted'}: {total} bytes captured; readable: {found}")
            results[bool(options)] = total, found
    plain_bytes, plain = results[True]
    encrypted_bytes, encrypted = results[False]
    if not all(plain.values()):
        raise SystemExit(f"without encryption the capture does not find what it looks for: {plain}")
    if any(encrypted.values()):
        raise SystemExit(f"read in a session that is encrypted: {encrypted}")
    if encrypted_bytes < len(texels):
        raise SystemExit(f"only {encrypted_bytes} bytes were captured, of {plain_bytes}")


main()
