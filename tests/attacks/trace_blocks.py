# SPDX-License-Identifier: Apache-2.0
"""Traces as lists of blocks: parsed, modified, and packed again with valid checksums (spu/stream/trace_file.h)."""

import ctypes
import struct

HEAD_BYTES = 32
BLOCK_HEAD = struct.Struct("<IIQQQQQQQ")

zstd = ctypes.CDLL("libzstd.so.1")
for function in ("ZSTD_compressBound", "ZSTD_compress", "ZSTD_decompress"):
    getattr(zstd, function).restype = ctypes.c_size_t


def compressed(data):
    room = zstd.ZSTD_compressBound(ctypes.c_size_t(len(data)))
    to = ctypes.create_string_buffer(room)
    size = zstd.ZSTD_compress(to, ctypes.c_size_t(room), data, ctypes.c_size_t(len(data)), 3)
    return to.raw[:size]


def decompressed(data, size):
    to = ctypes.create_string_buffer(size + 8)
    found = zstd.ZSTD_decompress(to, ctypes.c_size_t(size + 8), data, ctypes.c_size_t(len(data)))
    if found != size:
        raise ValueError(f"a block has {found} bytes, not {size}")
    return to.raw[:size]


def fnv64(data):
    value = 0xCBF29CE484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return value


def stable_id(name):
    """The id of a call or event: FNV-1a of its name."""
    value = 0x811C9DC5
    for byte in name.encode():
        value = (value ^ byte) * 0x01000193 & 0xFFFFFFFF
    return value


class Block:
    def __init__(self, magic, frames, number, record_words, words):
        self.magic, self.frames, self.number = magic, frames, number
        self.record_words = record_words  # the remaining words are payload
        self.words = words

    def records(self):
        """(first word, number of words) of every record."""
        found, at = [], 0
        while at < self.record_words:
            length = self.words[at] >> 32
            if length == 0 or at + length > self.record_words:
                break
            found.append((at, length))
            at += length
        return found


class Trace:
    def __init__(self, data):
        self.head, self.blocks = data[:HEAD_BYTES], []
        at = HEAD_BYTES
        while at < len(data):
            magic, frames, number, records, payload, size, _, _, _ = BLOCK_HEAD.unpack_from(data, at)
            at += BLOCK_HEAD.size
            raw = decompressed(data[at : at + size], (records + payload) * 8)
            self.blocks.append(Block(magic, frames, number, records, list(struct.unpack(f"<{records + payload}Q", raw))))
            at += size

    def packed(self):
        parts = [self.head]
        for block in self.blocks:
            body = compressed(struct.pack(f"<{len(block.words)}Q", *block.words))
            payload = len(block.words) - block.record_words
            head = struct.pack("<IIQQQQ", block.magic, block.frames, block.number, block.record_words, payload, len(body))
            parts += [head, struct.pack("<Q", fnv64(head)), bytes(16), body]
        return b"".join(parts)
