# SPDX-License-Identifier: Apache-2.0
"""The client's end of a TCP link: handshake and messages (compositor/transport/tcp/handshake.h, tcp_message_reader.h; 127.0.0.1 only)."""

import hashlib
import hmac
import os
import socket
import struct

HELLO = b"UNDERLNK"
LINK_VERSION = 2
MESSAGE_MAGIC = 0x59445355
MESSAGE_HEAD = struct.Struct("<IBBHQQ")
BLOCK_BYTES = 1 << 18
# Protocol, version, number: compositor/service/launcher_protocol.h, spu/remote/gl_server_protocol.h, line_protocol.h.
TYPES = {"hello_client": (1, 12, 1), "hello_nodes": (1, 12, 2), "accepted": (1, 12, 4), "refused": (1, 12, 5),
         "calls": (4, 12, 1), "answered": (4, 12, 2), "image": (4, 12, 3), "line_alive": (5, 1, 1)}
NAMES = {number: name for name, number in TYPES.items()}


class Closed(Exception):
    """The server ended the connection."""


class LinkClient:
    def __init__(self, port, secret, to_server):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=30)
        hello = HELLO + struct.pack("<IBBBB", LINK_VERSION, int(to_server), 0, 0, 0) + os.urandom(32)
        self.socket.sendall(hello)
        challenge = self.receive_bytes(48)
        key = hashlib.blake2b(secret, digest_size=32).digest()
        said = b"understudy link: client" + hello + challenge + struct.pack("<I", 0)
        self.socket.sendall(hmac.new(key, said, hashlib.sha512).digest()[:32])
        verdict = struct.unpack_from("<I", self.receive_bytes(40))[0]
        if verdict != 0:
            raise Closed(f"verdict {verdict}")

    def receive_bytes(self, count):
        got = b""
        while len(got) < count:
            part = self.socket.recv(count - len(got))
            if not part:
                raise Closed(f"after {len(got)} of {count} bytes")
            got += part
        return got

    def send(self, name, payload=b""):
        message = MESSAGE_HEAD.pack(MESSAGE_MAGIC, *TYPES[name], len(payload), 0)
        for at in range(0, len(payload), BLOCK_BYTES):
            block = payload[at : at + BLOCK_BYTES]
            message += struct.pack("<II", len(block), len(block)) + block
        self.socket.sendall(message)

    def receive(self):
        """(name, payload); compressed blocks, which no answer here has, as zeros."""
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
