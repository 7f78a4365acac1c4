# SPDX-License-Identifier: MIT
"""Tiny PNG files whose bytes depend on nothing but the pixels: deflate blocks are stored, never compressed,
because what a compressor makes of them differs between zlib builds."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt


def _chunk(kind: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def _stored(data: bytes) -> bytes:
    blocks = [data[i : i + 0xFFFF] for i in range(0, len(data), 0xFFFF)] or [b""]
    out = b"\x78\x01"
    for i, block in enumerate(blocks):
        last = int(i == len(blocks) - 1)
        out += struct.pack("<BHH", last, len(block), len(block) ^ 0xFFFF) + block
    return out + struct.pack(">I", zlib.adler32(data))


def _file(width: int, height: int, depth: int, colour: int, extra: bytes, rows: list[bytes]) -> bytes:
    header = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0)
    pixels = b"".join(b"\0" + row for row in rows)
    return (
        b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", header) + extra + _chunk(b"IDAT", _stored(pixels)) + _chunk(b"IEND", b"")
    )


def rgba(pixels: npt.ArrayLike) -> bytes:
    """8-bit RGB or RGBA from rows of byte tuples, top row first."""
    array = np.asarray(pixels, dtype=np.uint8)
    height, width, channels = array.shape
    colour = {3: 2, 4: 6}[channels]
    return _file(width, height, 8, colour, b"", [row.tobytes() for row in array])


def two_colours(bits: npt.ArrayLike, first: Sequence[int], second: Sequence[int]) -> bytes:
    """A one-bit palette image: where `bits` is 0 the first colour, else the second."""
    array = np.asarray(bits, dtype=np.uint8)
    height, width = array.shape
    palette = _chunk(b"PLTE", bytes(first) + bytes(second))
    return _file(width, height, 1, 3, palette, [np.packbits(row).tobytes() for row in array])
