# SPDX-License-Identifier: Apache-2.0
"""Data in transit is changed, repeated or omitted, or encryption is declined in the client's name: all of this is refused.

    tampered_session.py UNDERSTUDY

The session ends, the server reports why, and the next client is served.
"""

import sys
import tempfile
from pathlib import Path

from attacked_server import comes_to_say, port_of, said, server
from link_client import ONLY_ASKS, PLAIN, RECORD_BYTES, Closed, LinkClient

TAMPERED = "a record does not open: what came was changed, replayed or left out on its way"
NO_LENGTH = "a record has a length that none has"
WRONG_SECRET, NOT_PLAIN = 1, 4  # compositor/transport/tcp/handshake.h: AdmissionVerdict


def hello_record(link):
    """The record with which an application greets the nodes, without sending it."""
    sent = []
    link.socket, socket = type("Kept", (), {"sendall": lambda _, record: sent.append(record)})(), link.socket
    link.send("hello_client")
    link.socket = socket
    return sent[0]


def flipped_byte(link):
    record = bytearray(hello_record(link))
    record[-1] ^= 1
    link.socket.sendall(record)
    return TAMPERED


def replayed_record(link):
    link.send("line_alive")
    record = hello_record(link)
    link.socket.sendall(record + record)
    return TAMPERED


def left_out_record(link):
    link.send("line_alive")
    hello_record(link)
    link.send("line_alive")
    return TAMPERED


def unencrypted_message(link):
    link.sealer = None
    link.socket.sendall(bytes(24))
    link.send("hello_client")
    return NO_LENGTH


def endless_record(link):
    link.socket.sendall(bytes(24) + (RECORD_BYTES + 18).to_bytes(4, "little"))
    return NO_LENGTH


def ends(link):
    link.socket.settimeout(30)
    try:
        while link.socket.recv(1 << 16):
            pass
    except ConnectionError:
        pass


def expect_verdict(port, secret, verdict, **how):
    try:
        LinkClient(port, secret, to_server=False, **how)
    except Closed as closed:
        if str(closed) == f"verdict {verdict}":
            return
        raise SystemExit(f"{how}: {closed} instead of verdict {verdict}") from closed
    raise SystemExit(f"{how}: was let in")


def greeted(port, secret, flags=0):
    link = LinkClient(port, secret, to_server=False, flags=flags)
    link.send("hello_client")
    return link.receive()[0] == "accepted"


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        process = server(sys.argv[1], folder)
        try:
            port = port_of(process, folder)
            secret = (folder / "secret").read_bytes()
            for attack in (flipped_byte, replayed_record, left_out_record, unencrypted_message, endless_record):
                before = len(said(folder))
                link = LinkClient(port, secret, to_server=False)
                reason = attack(link)
                ends(link)
                if not comes_to_say(folder, f"dropped a client: {reason}", before):
                    raise SystemExit(f"{attack.__name__}: the server does not say why:\n{said(folder)[before:]}")
                print(f"{attack.__name__}: {said(folder)[before:].strip()}")
                if not greeted(port, secret):
                    raise SystemExit(f"{attack.__name__}: the next client is not served")
            # Encryption is used unless both ends decline it; forged flags invalidate the proof.
            expect_verdict(port, secret, NOT_PLAIN, flags=PLAIN)
            expect_verdict(port, secret, WRONG_SECRET, flags=PLAIN, pretends=PLAIN)
            expect_verdict(port, secret, WRONG_SECRET, flags=ONLY_ASKS, pretends=PLAIN)
            expect_verdict(port, b"what somebody made up", WRONG_SECRET)
            if not greeted(port, secret):
                raise SystemExit("the next client is not served")
        finally:
            process.terminate()
            process.wait(30)


main()
