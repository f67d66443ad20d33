# SPDX-License-Identifier: Apache-2.0
"""The client's end of a TCP connection: handshake, records and messages (compositor/transport/tcp/handshake.h,
session_keys.h, record.h, tcp_message_reader.h; 127.0.0.1 only)."""

import ctypes
import hashlib
import hmac
import os
import re
import socket
import struct
from pathlib import Path

HELLO = b"UNDERLNK"
ONLY_ASKS, PLAIN = 1, 2
MESSAGE_MAGIC = 0x59445355
MESSAGE_HEAD = struct.Struct("<IBBHQQ")
BLOCK_BYTES = 1 << 18
RECORD_BYTES = 1 << 16
STREAM_HEAD_BYTES, SEAL_BYTES = 24, 17
ROOT = Path(__file__).resolve().parents[2]


def protocol(header):
    """(number, version), as given in the header."""
    found = re.search(r"return \{(\d+), (\d+), ", (ROOT / header).read_text(encoding="utf-8"))
    return int(found[1]), int(found[2])


HANDSHAKE = (ROOT / "compositor/transport/tcp/handshake.h").read_text(encoding="utf-8")
LINK_VERSION = int(re.search(r"tcp_protocol_version = (\d+);", HANDSHAKE)[1])
LAUNCHER = protocol("compositor/service/launcher_protocol.h")
GL_SERVER = protocol("spu/remote/gl_server_protocol.h")
LINE = protocol("compositor/transport/tcp/line_protocol.h")
# Protocol, version, number.
TYPES = {"hello_client": (*LAUNCHER, 1), "hello_nodes": (*LAUNCHER, 2), "accepted": (*LAUNCHER, 4), "refused": (*LAUNCHER, 5),
         "calls": (*GL_SERVER, 1), "answered": (*GL_SERVER, 2), "image": (*GL_SERVER, 3), "line_alive": (*LINE, 1)}
NAMES = {number: name for name, number in TYPES.items()}

SODIUM = ctypes.CDLL("libsodium.so.23")
SODIUM.sodium_init()
SODIUM_STREAM = "crypto_secretstream_xchacha20poly1305_"


def stream(name, *arguments):
    return getattr(SODIUM, SODIUM_STREAM + name)(*arguments)


class Closed(Exception):
    """The server closed the connection."""


class Sealer:
    """Encrypts the records of one direction; `seal` returns what is to be sent."""

    def __init__(self, key):
        self.state = ctypes.create_string_buffer(stream("statebytes"))
        head = ctypes.create_string_buffer(STREAM_HEAD_BYTES)
        stream("init_push", self.state, head, key)
        self.head = head.raw

    def seal(self, plain):
        length = struct.pack("<I", len(plain) + SEAL_BYTES)
        sealed = ctypes.create_string_buffer(len(plain) + SEAL_BYTES)
        stream("push", self.state, sealed, None, plain, ctypes.c_ulonglong(len(plain)), length, ctypes.c_ulonglong(4), 0)
        head, self.head = self.head, b""
        return head + length + sealed.raw


class Opener:
    def __init__(self, key, head):
        self.state = ctypes.create_string_buffer(stream("statebytes"))
        stream("init_pull", self.state, head, key)

    def open(self, length, sealed):
        plain = ctypes.create_string_buffer(len(sealed))
        if stream("pull", self.state, plain, None, None, sealed, ctypes.c_ulonglong(len(sealed)), length, ctypes.c_ulonglong(4)):
            raise Closed("a record does not open")
        return plain.raw[: len(sealed) - SEAL_BYTES]


class LinkClient:
    def __init__(self, port, secret, to_server, flags=0, pretends=0):
        """`pretends`: flags that the proof covers but the server does not receive, as after tampering in transit."""
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=30)
        self.opener = self.sealer = None
        self.opened = b""
        public, private = ctypes.create_string_buffer(32), ctypes.create_string_buffer(32)
        SODIUM.crypto_kx_keypair(public, private)
        hello = HELLO + struct.pack("<IBBBB", LINK_VERSION, int(to_server), 0, 0, flags) + os.urandom(32) + public.raw + bytes(32)
        self.socket.sendall(hello)
        challenge = self.receive_raw(48 + 32)
        key = hashlib.blake2b(secret, digest_size=32).digest()
        proved = hello[:15] + bytes([flags ^ pretends]) + hello[16:] + challenge
        said = b"understudy link: client" + proved + struct.pack("<I", 0)
        self.socket.sendall(hmac.new(key, said, hashlib.sha512).digest()[:32])
        self.verdict = struct.unpack_from("<I", self.receive_raw(40))[0]
        if self.verdict != 0:
            raise Closed(f"verdict {self.verdict}")
        if flags & PLAIN:
            return
        receive, send = ctypes.create_string_buffer(32), ctypes.create_string_buffer(32)
        if SODIUM.crypto_kx_client_session_keys(receive, send, public, private, challenge[-32:]):
            raise Closed("the server's key is none")
        self.sealer = Sealer(bound(send.raw, key, proved))
        self.receive_key = bound(receive.raw, key, proved)

    def receive_raw(self, count):
        got = b""
        while len(got) < count:
            part = self.socket.recv(count - len(got))
            if not part:
                raise Closed(f"after {len(got)} of {count} bytes")
            got += part
        return got

    def receive_bytes(self, count):
        if self.sealer is None:
            return self.receive_raw(count)
        if self.opener is None:
            self.opener = Opener(self.receive_key, self.receive_raw(STREAM_HEAD_BYTES))
        while len(self.opened) < count:
            length = self.receive_raw(4)
            self.opened += self.opener.open(length, self.receive_raw(struct.unpack("<I", length)[0]))
        got, self.opened = self.opened[:count], self.opened[count:]
        return got

    def send(self, name, payload=b""):
        message = MESSAGE_HEAD.pack(MESSAGE_MAGIC, *TYPES[name], len(payload), 0)
        for at in range(0, len(payload), BLOCK_BYTES):
            block = payload[at : at + BLOCK_BYTES]
            message += struct.pack("<II", len(block), len(block)) + block
        self.socket.sendall(self.sealed(message))

    def sealed(self, plain):
        if self.sealer is None:
            return plain
        return b"".join(self.sealer.seal(plain[at : at + RECORD_BYTES]) for at in range(0, len(plain), RECORD_BYTES))

    def receive(self):
        """(name, payload); compressed blocks, which do not occur in these answers, as zeros."""
        while True:
            _, *number, size, _ = MESSAGE_HEAD.unpack(self.receive_bytes(MESSAGE_HEAD.size))
            number = tuple(number)
            payload = b""
            while len(payload) < size:
                plain, travelling = struct.unpack("<II", self.receive_bytes(8))
                block = self.receive_bytes(travelling & 0xFFFFFF)
                payload += block if travelling >> 24 == 0 else bytes(plain)
            if NAMES.get(number) != "line_alive":
                return NAMES.get(number, number), payload


def bound(agreed, key, said):
    return hashlib.blake2b(b"understudy session key" + agreed + said, key=key, digest_size=32).digest()
