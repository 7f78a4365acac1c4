# SPDX-License-Identifier: MIT
"""A scene for those who give none: a mirror ball, a glass ball and a matte one on a floor, under a lamp that moves."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

_FLOAT, _UINT = 5126, 5125
_ROUNDINGS = 3  # 1,280 triangles a ball

Points = npt.NDArray[np.float32]
Faces = npt.NDArray[np.uint32]


@dataclass
class _Builder:
    """Buffers and accessors as they come."""

    data: bytearray = field(default_factory=bytearray)
    views: list[dict[str, Any]] = field(default_factory=list)
    accessors: list[dict[str, Any]] = field(default_factory=list)

    def add(self, array: Points | Faces, kind: str) -> int:
        flat = np.ascontiguousarray(array)
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": flat.nbytes})
        accessor: dict[str, Any] = {"bufferView": len(self.views) - 1, "count": len(flat), "type": kind}
        accessor["componentType"] = _FLOAT if flat.dtype == np.float32 else _UINT
        if flat.dtype == np.float32:
            columns = flat.reshape(len(flat), -1)
            accessor |= {"min": columns.min(axis=0).tolist(), "max": columns.max(axis=0).tolist()}
        self.accessors.append(accessor)
        self.data += flat.tobytes()
        return len(self.accessors) - 1

    def mesh(self, points: Points, faces: Faces, normals: Points, material: int) -> dict[str, Any]:
        attributes = {"POSITION": self.add(points, "VEC3"), "NORMAL": self.add(normals, "VEC3")}
        return {
            "primitives": [
                {"attributes": attributes, "indices": self.add(faces.reshape(-1), "SCALAR"), "material": material}
            ]
        }


def write_sample(path: Path) -> Path:
    """Writes the scene, always the same bytes; gives the path back."""
    builder = _Builder()
    points, faces = ball()
    floor = np.array([[-6, 0, -6], [-6, 0, 6], [6, 0, 6], [6, 0, -6]], np.float32)
    up = np.tile(np.array([0, 1, 0], np.float32), (4, 1))
    meshes = [builder.mesh(floor, np.array([[0, 1, 2], [0, 2, 3]], np.uint32), up, 0)]
    meshes += [builder.mesh(points, faces, points, material) for material in (1, 2, 3)]
    times = builder.add(np.array([0, 2, 4], np.float32), "SCALAR")
    moves = builder.add(np.array([[-3, 5, 3], [3, 5, 3], [-3, 5, 3]], np.float32), "VEC3")
    document = _document(meshes, times, moves)
    document |= {"accessors": builder.accessors, "bufferViews": builder.views}
    document["buffers"] = [{"byteLength": len(builder.data)}]
    path.write_bytes(_glb(document, bytes(builder.data)))
    return path


def ball() -> tuple[Points, Faces]:
    """A sphere of radius 1 from an octahedron, each triangle cut into four again and again."""
    corners = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    points = [np.array(corner, np.float64) for corner in corners]
    faces = [(x, y, z) if (x + y + z) % 2 == 0 else (x, z, y) for x in (0, 1) for y in (2, 3) for z in (4, 5)]
    for _ in range(_ROUNDINGS):
        middles: dict[tuple[int, int], int] = {}

        def middle(a: int, b: int, known: dict[tuple[int, int], int] = middles) -> int:
            key = (min(a, b), max(a, b))
            if key not in known:
                between = points[a] + points[b]
                points.append(between / np.linalg.norm(between))
                known[key] = len(points) - 1
            return known[key]

        cut = []
        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            cut += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = cut
    return np.array(points, np.float32), np.array(faces, np.uint32)


def _document(meshes: list[dict[str, Any]], times: int, moves: int) -> dict[str, Any]:
    balls = [(-2.1, 1, -0.6), (0.1, 1, 0.9), (2.2, 1, -0.9)]
    nodes: list[dict[str, Any]] = [{"mesh": 0}]
    nodes += [{"mesh": 1 + index, "translation": place} for index, place in enumerate(balls)]
    light = {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [-3, 5, 3]}
    # Looks 17° down from 2.9 m up.
    camera = {"camera": 0, "translation": [0, 2.9, 7.4], "rotation": [-0.14780941, 0, 0, 0.98901586]}
    path = {"node": len(nodes), "path": "translation"}
    lamp = {"type": "point", "intensity": 110, "color": [1, 0.95, 0.85]}
    return {
        "asset": {"version": "2.0", "generator": "sheaf-client report"},
        "extensionsUsed": ["KHR_lights_punctual", "KHR_materials_transmission", "KHR_materials_ior"],
        "extensions": {"KHR_lights_punctual": {"lights": [lamp]}},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(nodes) + 2))}],
        "nodes": [*nodes, light, camera],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.66, "znear": 0.1}}],
        "meshes": meshes,
        "materials": _materials(),
        "animations": [
            {"samplers": [{"input": times, "output": moves}], "channels": [{"sampler": 0, "target": path}]},
        ],
    }


def _materials() -> list[dict[str, Any]]:
    def material(colour: list[float], metallic: float, roughness: float, **extensions: Any) -> dict[str, Any]:
        surface = {"baseColorFactor": [*colour, 1], "metallicFactor": metallic, "roughnessFactor": roughness}
        return {"pbrMetallicRoughness": surface, **({"extensions": extensions} if extensions else {})}

    glass = {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.5}}
    glass["KHR_materials_volume"] = {"thicknessFactor": 2, "attenuationDistance": 3}
    return [
        material([0.55, 0.5, 0.45], 0, 1),
        material([0.95, 0.93, 0.88], 1, 0),
        material([1, 1, 1], 0, 0, **glass),
        material([0.15, 0.3, 0.7], 0, 1),
    ]


def _glb(document: dict[str, Any], binary: bytes) -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks
