# SPDX-License-Identifier: MIT
"""A plain encoder of KHR_meshopt_compression: it makes nothing smaller, and its streams are as specified."""

from __future__ import annotations

import json
import pathlib
import struct

import numpy as np

SIZES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def varint(value: int) -> bytes:
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    return bytes([*out, value])


def zigzag(delta: int) -> int:
    return -2 * delta - 1 if delta < 0 else 2 * delta


def encode_triangles(indices: np.ndarray) -> bytes:
    """Every index by its distance from the one before."""
    last, data = 0, bytearray()
    for triangle in indices.reshape(-1, 3).tolist():
        data.append(0xFF)
        for index in triangle:
            data += varint(zigzag(index - last))
            last = index
    return b"\xe1" + b"\xff" * (len(indices) // 3) + bytes(data) + bytes(16)


def encode_indices(indices: np.ndarray) -> bytes:
    """The two baselines take turns."""
    last, data = [0, 0], bytearray()
    for i, index in enumerate(indices.tolist()):
        data += varint(zigzag(index - last[i % 2]) << 1 | i % 2)
        last[i % 2] = index
    return b"\xd1" + bytes(data) + bytes(4)


def encode_attributes(elements: np.ndarray) -> bytes:
    """The second version, whose bytes are stored as they are; every other channel holds pairs, the last one words."""
    count, stride = elements.shape
    modes = [2 if c == stride // 4 - 1 else c % 2 for c in range(stride // 4)]
    before = np.vstack([elements[:1], elements[:-1]])
    deltas = np.zeros_like(elements)
    for c, mode in enumerate(modes):
        part = slice(4 * c, 4 * c + 4)
        now, old = (np.ascontiguousarray(a[:, part]).view(f"<u{(1, 2, 4)[mode]}") for a in (elements, before))
        if mode == 2:
            coded = now ^ old
        else:
            signed = (now - old).view(f"<i{mode + 1}").astype(np.int64)
            coded = np.where(signed < 0, -2 * signed - 1, 2 * signed).astype(now.dtype)
        deltas[:, part] = np.ascontiguousarray(coded).view(np.uint8)
    size = min(8192 // stride & ~15, 256)
    blocks = [b"\xff" * (stride // 4) + deltas[at : at + size].T.tobytes() for at in range(0, count, size)]
    tail = elements[0].tobytes() + bytes(modes)
    return b"\xa1" + b"".join(blocks) + bytes(max(0, 24 - len(tail))) + tail


def parts_of(path: pathlib.Path) -> tuple[dict, bytes]:
    data = path.read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def glb(document: dict, binary: bytes) -> bytes:
    text = json.dumps(document).encode()
    chunks = [(b"JSON", text + b" " * (-len(text) % 4)), (b"BIN\0", binary + bytes(-len(binary) % 4))]
    body = b"".join(struct.pack("<I", len(chunk)) + kind + chunk for kind, chunk in chunks)
    return b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body


def pack(path: pathlib.Path, extension: str) -> bytes:
    """The file with every bufferView compressed that can be: vertices, indices and animations alike."""
    document, binary = parts_of(path)
    indices = {p["indices"]: p for mesh in document["meshes"] for p in mesh["primitives"] if "indices" in p}
    plain, stored = 0, bytearray()
    for number, view in enumerate(document["bufferViews"]):
        data = binary[view.get("byteOffset", 0) :][: view["byteLength"]]
        users = [(i, a) for i, a in enumerate(document["accessors"]) if a.get("bufferView") == number]
        first, accessor = users[0] if users else (-1, None)
        element = SIZES[accessor["componentType"]] * WIDTHS[accessor["type"]] if accessor else 4
        stride = view.get("byteStride", element)
        if first in indices and stride > 1:
            values = np.frombuffer(data, f"<u{stride}").astype(np.int64)
            in_triangles = indices[first].get("mode", 4) == 4 and number % 4 != 0
            mode, stream = (
                ("TRIANGLES", encode_triangles(values)) if in_triangles else ("INDICES", encode_indices(values))
            )
        elif first not in indices and len(data) % 4 == 0:
            stride = stride if stride % 4 == 0 and len(data) % stride == 0 and stride <= 256 else 4
            elements = np.frombuffer(data, np.uint8).reshape(-1, stride)
            mode, stream = "ATTRIBUTES", encode_attributes(elements)
        else:
            mode, stream = None, data
        stored += bytes(-len(stored) % 4)
        at = {"buffer": 0, "byteOffset": len(stored), "byteLength": len(stream)}
        stored += stream
        if mode is None:
            view.update(at)
            continue
        view |= {"buffer": 1, "byteOffset": plain}
        view["extensions"] = {extension: at | {"byteStride": stride, "count": len(data) // stride, "mode": mode}}
        plain += len(data) + -len(data) % 4
    document["buffers"] = [{"byteLength": len(stored)}, {"byteLength": max(plain, 1)}]
    for key in ("extensionsUsed", "extensionsRequired"):
        document.setdefault(key, []).append(extension)
    return glb(document, bytes(stored))
