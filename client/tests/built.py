# SPDX-License-Identifier: MIT
"""The programs as they are built, and a scene for them.

They are looked for below $SHEAF_BUILD, else below ../../build. Without them tests are skipped, unless SHEAF_BUILD is
set: then their absence is a failure.
"""

from __future__ import annotations

import json
import os
import struct
from pathlib import Path

import numpy as np
import pytest


def program(name: str) -> Path:
    build = Path(os.environ.get("SHEAF_BUILD") or Path(__file__).parents[2] / "build")
    found = [path for path in build.rglob(name) if path.is_file() and os.access(path, os.X_OK)]
    if not found and os.environ.get("SHEAF_BUILD"):
        pytest.fail(f"no program {name} below {build}")
    if not found:
        pytest.skip(f"no program {name} below {build}")
    return found[0]


def triangle_glb(top: float = 1) -> bytes:
    """A triangle in the plane z = 0, `top` metres high above its middle, seen from +Z, that moves by 1 m per second."""
    positions = np.array([[-1, -1, 0], [1, -1, 0], [0, top, 0]], np.float32)
    times = np.array([0, 1], np.float32)
    moves = np.array([[0, 0, 0], [1, 0, 0]], np.float32)
    blocks = [array.tobytes() for array in (positions, times, moves)]
    offsets = np.cumsum([0] + [len(block) for block in blocks]).tolist()
    views = [
        {"buffer": 0, "byteOffset": offset, "byteLength": len(block)}
        for offset, block in zip(offsets, blocks, strict=False)
    ]
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "buffers": [{"byteLength": offsets[-1]}],
        "bufferViews": views,
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": 3,
                "type": "VEC3",
                "min": [-1, -1, 0],
                "max": [1, top, 0],
            },
            {"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
            {"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"},
        ],
        "animations": [
            {
                "samplers": [{"input": 1, "output": 2}],
                "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
            }
        ],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary = b"".join(blocks)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
