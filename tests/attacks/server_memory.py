# SPDX-License-Identifier: Apache-2.0
"""A client with the secret sends addresses in its stream: no memory of the OpenGL server may be returned.

    server_memory.py UNDERSTUDY

The session continues or ends; the server reports which call was skipped.
"""

import struct
import subprocess
import sys
import tempfile
from pathlib import Path

from attacked_server import port_of, server
from link_client import Closed, LinkClient
from trace_blocks import stable_id

ADDRESS, OUTPUT = 3 << 56, 4 << 56  # spu/stream/record.h: ReferenceKind
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, STATIC_DRAW = 0x8892, 0x8893, 0x88E4
BYTES = 4096
CHUNK_WORDS, CHUNKS = 1024, 8192
WANTED = b"a secret of the server's environment"


def record(name, *arguments):
    return [stable_id(name) | len(arguments) + 1 << 32, *arguments]


class Session:
    """Makes calls on a GL server (spu/remote/gl_server_protocol.h)."""

    def __init__(self, port, secret):
        self.chunks = 0
        self.link = LinkClient(port, secret, to_server=True)
        self.link.send("hello_client")
        if self.link.receive()[0] != "accepted":
            raise SystemExit("the GL server does not accept its client")
        self.make(record("understudy.context", 1, 0, 1, 450, 2, 8, 8, 8, 8, 24, 8, 0, 1), record("understudy.current", 1, 64, 64, 0))

    def make(self, *records, answer=False):
        words = [word for each in records for word in each]
        heads = []
        for at in range(0, len(words), CHUNK_WORDS):
            heads.append(self.chunks % CHUNKS | len(words[at : at + CHUNK_WORDS]) << 32)
            self.chunks += 1
        head = struct.pack("<QQQQ", 1, int(answer), len(words), 0)
        self.link.send("calls", head + struct.pack(f"<{1 + len(heads) + len(words)}Q", len(heads), *heads, *words))
        return self.link.receive()[1] if answer else b""


def server_of_client(process):
    """Process id of the newest child of the server's GL server."""
    listed = subprocess.run(["ps", "-eo", "pid,ppid,args"], capture_output=True, text=True, check=True).stdout
    rows = [line.split(None, 2) for line in listed.splitlines()[1:]]
    servers = [int(row[0]) for row in rows if row[1] == str(process.pid) and "understudy gl-server" in row[2]]
    children = [int(row[0]) for row in rows if int(row[1]) in servers]
    return max(children)


def environment_address(pid):
    # Field 50 of proc(5), env_start, rounded down to its page, because the next page may not be mapped.
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[47]) & -BYTES


def heap_address(pid):
    return next(int(line.split("-")[0], 16) for line in Path(f"/proc/{pid}/maps").read_text().splitlines() if "[heap]" in line)


def by_buffer_data(session, address):
    session.make(record("glBindBuffer", ARRAY_BUFFER, 77), record("glBufferData", ARRAY_BUFFER, BYTES, ADDRESS | address, STATIC_DRAW))
    return session.make(record("glGetBufferSubData", ARRAY_BUFFER, 0, BYTES, OUTPUT | 0x1000), answer=True)


def by_sub_data(session, address):
    session.make(record("glBindBuffer", ARRAY_BUFFER, 78), record("glBufferData", ARRAY_BUFFER, BYTES, 0, STATIC_DRAW),
                 record("glBufferSubData", ARRAY_BUFFER, 0, BYTES, ADDRESS | address))
    return session.make(record("glGetBufferSubData", ARRAY_BUFFER, 0, BYTES, OUTPUT | 0x1000), answer=True)


def by_matrix(session, address):
    session.make(record("glLoadMatrixf", ADDRESS | address))
    return session.make(record("glGetFloatv", 0x0BA6, OUTPUT | 0x1000), answer=True)


def by_fence(session, address):
    """Sends no address, but checks that the server does not disclose one."""
    answer = session.make(record("glFenceSync", 0x9117, 0), answer=True)
    words = struct.unpack(f"<{len(answer) // 8}Q", answer[: len(answer) // 8 * 8])
    told = [word for word in words if 0x500000000000 < word < 0x7FFFFFFFFFFF]
    if told:
        raise SystemExit(f"glFenceSync answered an address: {told[0]:#x}")
    return b""


def memory_of(pid, address):
    with open(f"/proc/{pid}/mem", "rb") as memory:
        memory.seek(address)
        return memory.read(BYTES)


def attack(session, pid, attempt, address):
    """Returns how many bytes of the server's memory came back, and whether the session continues."""
    real = memory_of(pid, address)
    try:
        answer = attempt(session, address)
    except (Closed, TimeoutError) as ended:
        print(f"{attempt.__name__}: the session ended: {ended}")
        return 0, False
    pieces = {real[at : at + 16] for at in range(0, len(real) - 16, 16)} - {bytes(16)}
    found = sum(piece in answer for piece in pieces if len(set(piece)) > 4)
    return found * 16, True


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        process = server(sys.argv[1], folder, "--gl-server", SECRET_OF_THE_SERVER=WANTED.decode())
        try:
            port = port_of(process, folder)
            secret = (folder / "secret").read_bytes()
            session = Session(port, secret)
            pid = server_of_client(process)
            for address in (environment_address(pid), heap_address(pid)):
                for attempt in (by_fence, by_buffer_data, by_sub_data, by_matrix):
                    bytes_back, goes_on = attack(session, pid, attempt, address)
                    print(f"{attempt.__name__} at {address:#x}: {bytes_back} bytes of the server's memory came back")
                    if bytes_back > 0:
                        raise SystemExit("memory of the server went to its client")
                    if not goes_on:
                        session = Session(port, secret)
                        pid = server_of_client(process)
            # The next client is served normally.
            if not Session(port, secret).make(record("glGetError"), answer=True):
                raise SystemExit("the next client got no answer")
        finally:
            process.terminate()
            process.wait(30)
        said = (folder / "log").read_text(errors="replace")
        if "glBufferData: data is an address of another process" not in said:
            raise SystemExit(f"the server does not say which call was left out:\n{said}")


main()
