# SPDX-License-Identifier: MIT
"""Sponza with what the benchmark asks of it: one point light in the court, a mirror for a floor, a camera inside.

Written beside copies of the asset's own files in a folder of the caller's: a scene may not reach outside its folder.
"""

from __future__ import annotations

import base64
import json
import shutil
import struct
from pathlib import Path
from typing import Any

LIGHT = (0.0, 6.0, -0.3)  # metres, in the court
EYE, TARGET = (-9.0, 1.8, -0.3), (4.0, 3.0, -0.3)
FLOOR = (-12.5, 12.0, -5.2, 4.8, 0.002)  # x from, to; z from, to; height


def rotation_towards(eye: tuple[float, ...], target: tuple[float, ...]) -> list[float]:
    """Quaternion (x, y, z, w) of a camera that looks from `eye` to `target`, +Y up."""
    forward = [t - e for e, t in zip(eye, target, strict=True)]
    size = sum(f * f for f in forward) ** 0.5
    back = [-f / size for f in forward]
    level = (back[2] ** 2 + back[0] ** 2) ** 0.5
    right = [back[2] / level, 0.0, -back[0] / level]
    up = [
        back[1] * right[2] - back[2] * right[1],
        back[2] * right[0] - back[0] * right[2],
        back[0] * right[1] - back[1] * right[0],
    ]
    w = (1 + right[0] + up[1] + back[2]) ** 0.5 / 2
    return [(up[2] - back[1]) / (4 * w), (back[0] - right[2]) / (4 * w), (right[1] - up[0]) / (4 * w), w]


def add_floor(gltf: dict[str, Any]) -> int:
    """A mirror of two triangles; returns its node."""
    x0, x1, z0, z1, y = FLOOR
    positions = struct.pack("<12f", x0, y, z0, x0, y, z1, x1, y, z1, x1, y, z0)
    data = positions + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    buffer, view, accessor = len(gltf["buffers"]), len(gltf["bufferViews"]), len(gltf["accessors"])
    gltf["buffers"].append({"byteLength": len(data), "uri": uri})
    gltf["bufferViews"] += [
        {"buffer": buffer, "byteLength": 48},
        {"buffer": buffer, "byteOffset": 48, "byteLength": 12},
    ]
    gltf["accessors"] += [
        {"bufferView": view, "componentType": 5126, "count": 4, "type": "VEC3", "min": [x0, y, z0], "max": [x1, y, z1]},
        {"bufferView": view + 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
    ]
    gltf["materials"].append(
        {
            "name": "mirror",
            "pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.9, 0.9, 1], "metallicFactor": 1, "roughnessFactor": 0},
        }
    )
    gltf["meshes"].append(
        {
            "name": "floor",
            "primitives": [
                {"attributes": {"POSITION": accessor}, "indices": accessor + 1, "material": len(gltf["materials"]) - 1}
            ],
        }
    )
    gltf["nodes"].append({"name": "floor", "mesh": len(gltf["meshes"]) - 1})
    return len(gltf["nodes"]) - 1


def make(source: Path, folder: Path) -> Path:
    """Writes the scene into `folder` and returns its path."""
    gltf = json.loads(source.read_text())
    shutil.copytree(source.parent, folder, dirs_exist_ok=True)
    for copy in folder.rglob("*"):
        copy.chmod(copy.stat().st_mode | 0o200)  # the asset may be read-only
    added = [add_floor(gltf)]
    gltf.setdefault("extensions", {})["KHR_lights_punctual"] = {
        "lights": [{"type": "point", "color": [1.0, 0.95, 0.85], "intensity": 120.0}]
    }
    gltf["extensionsUsed"] = sorted({*gltf.get("extensionsUsed", []), "KHR_lights_punctual"})
    gltf["nodes"].append(
        {"name": "lamp", "translation": list(LIGHT), "extensions": {"KHR_lights_punctual": {"light": 0}}}
    )
    gltf["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.05}}]
    gltf["nodes"].append(
        {"name": "camera", "translation": list(EYE), "rotation": rotation_towards(EYE, TARGET), "camera": 0}
    )
    added += [len(gltf["nodes"]) - 2, len(gltf["nodes"]) - 1]
    gltf["scenes"][gltf.get("scene", 0)]["nodes"] += added
    path = folder / "sponza_mirror.gltf"
    path.write_text(json.dumps(gltf))
    return path
