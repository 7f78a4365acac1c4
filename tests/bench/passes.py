# SPDX-License-Identifier: MIT
"""Which of a dump's triangles let light pass: the filter that a shadow ray of another tracer needs."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any


def document_of(scene: Path) -> dict[str, Any]:
    """The JSON of a .glb or .gltf."""
    data = scene.read_bytes() if scene.suffix == ".gltf" else None
    if data is not None:
        return json.loads(data)
    with scene.open("rb") as file:
        header = file.read(20)
        return json.loads(file.read(struct.unpack_from("<I", header, 12)[0]))


def lets_pass(material: dict[str, Any]) -> bool:
    """Glass, or blended. An alpha mask would need its texture: such a scene is measured with --opaque."""
    if material.get("alphaMode") == "MASK":
        raise ValueError(f"material {material.get('name')} is masked: measure this scene with --opaque")
    glass = material.get("extensions", {}).get("KHR_materials_transmission", {}).get("transmissionFactor", 0)
    return glass > 0 or material.get("alphaMode") == "BLEND"


def passing_triangles(scene: Path) -> bytes:
    """A byte a triangle, in the dump's order: nodes level by level from the scene's roots, primitives as they stand."""
    gltf = document_of(scene)
    passes = bytearray()
    queue = list(gltf["scenes"][gltf.get("scene", 0)]["nodes"])
    for index in queue:  # grows
        node = gltf["nodes"][index]
        queue += node.get("children", [])
        if "mesh" not in node:
            continue
        for primitive in gltf["meshes"][node["mesh"]]["primitives"]:
            if primitive.get("mode", 4) != 4:
                raise ValueError(f"{scene}: only triangle lists are counted here")
            which = primitive.get("indices", primitive["attributes"]["POSITION"])
            triangles = gltf["accessors"][which]["count"] // 3
            material = gltf["materials"][primitive["material"]] if "material" in primitive else {}
            passes += (b"\1" if lets_pass(material) else b"\0") * triangles
    return bytes(passes)
