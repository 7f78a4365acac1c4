# SPDX-License-Identifier: MIT
"""Small scenes, one for each way in which glTF can store a mesh. Unlit colours, so that a picture shows geometry
and nothing else; an orthographic camera at z = 5 looking along -Z, unless said otherwise."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from glb import ARRAY_BUFFER, TRIANGLE_FAN, TRIANGLE_STRIP, Glb, numbers
from png import rgba
from shapes import box, facing_z, turn


def watched(glb: Glb, nodes: Iterable[int], xmag: float = 2.0, ymag: float = 1.0, scene: str = "scene") -> bytes:
    """Adds the camera that most small scenes share and finishes the file."""
    eye = glb.node("camera", (0, 0, 5), camera=glb.orthographic("camera", xmag, ymag))
    glb.scene([*list(nodes), eye], scene)
    return glb.bytes()


def strips_fans() -> bytes:
    glb = Glb()
    strip = [(-1.75, -0.5, 0), (-0.75, -0.5, 0), (-1.75, 0.5, 0), (-0.75, 0.5, 0), (-1.75, 0.75, 0)]
    hexagon = [(0, 0)] + [(np.cos(a), np.sin(a)) for a in np.radians(np.arange(0, 361, 60))]
    fan = [(x * 0.5, round(y * 0.5, 9), 0) for x, y in hexagon]
    ribbon = [(0.75, -0.5, 0), (1.25, -0.5, 0), (0.75, 0.5, 0), (1.25, 0.5, 0), (1.75, -0.5, 0), (1.75, 0.5, 0)]

    def primitive(
        points: npt.ArrayLike, mode: int, material: int, indices: npt.ArrayLike | None = None
    ) -> dict[str, Any]:
        item = {"attributes": {"POSITION": glb.attribute(points, bounds=True)}, "mode": mode, "material": material}
        return item | ({} if indices is None else {"indices": glb.indices(indices)})

    red, green, blue = (glb.unlit(n, c) for n, c in (("red", (1, 0, 0)), ("green", (0, 1, 0)), ("blue", (0, 0, 1))))
    mesh = glb.mesh(
        [
            primitive(strip, TRIANGLE_STRIP, red),
            primitive(fan, TRIANGLE_FAN, green),
            primitive(ribbon, TRIANGLE_STRIP, blue, [0, 1, 2, 3, 3, 1, 1, 4, 3, 5]),
        ],
        "modes",
    )
    return watched(glb, [glb.node("modes", mesh=mesh)])


def non_indexed() -> bytes:
    """Two triangles without indices and without normals: a roof whose faces need flat normals of their own."""
    glb = Glb()
    points = [(-1, -0.5, 0), (0, -0.5, 0.5), (0, 0.5, 0.5), (0, -0.5, 0.5), (1, -0.5, 0), (0, 0.5, 0.5)]
    material = glb.material("grey", (0.5, 0.5, 0.5))
    mesh = glb.mesh({"attributes": {"POSITION": glb.attribute(points, bounds=True)}, "material": material}, "roof")
    sun = glb.light("sun", "directional", 3)  # along -Z
    return watched(glb, [glb.node("roof", mesh=mesh), sun])


def interleaved() -> bytes:
    """Position, normal and UV of a box in one buffer view of stride 36, four bytes of it padding."""
    glb = Glb()
    shape = box((1, 1, 1), uv_scale=1)
    rows = np.zeros((len(shape.positions), 9), np.float32)
    rows[:, :8] = np.concatenate([shape.positions, shape.normals, shape.uvs], axis=1)
    rows[:, 8] = 12345
    view = glb.view(rows.tobytes(), ARRAY_BUFFER, stride=36)
    found = {}
    for name, offset, kind in (("POSITION", 0, "VEC3"), ("NORMAL", 12, "VEC3"), ("TEXCOORD_0", 24, "VEC2")):
        item = {"bufferView": view, "byteOffset": offset, "componentType": 5126, "count": len(rows), "type": kind}
        if name == "POSITION":
            item |= {"min": numbers(shape.positions.min(0)), "max": numbers(shape.positions.max(0))}
        found[name] = glb.add("accessors", item)
    primitive = {
        "attributes": found,
        "indices": glb.indices(shape.triangles),
        "material": glb.unlit("orange", (1, 0.5, 0)),
    }
    return watched(glb, [glb.node("box", mesh=glb.mesh(primitive, "box"))])


def sparse() -> bytes:
    """A flat 4×4-cell square whose middle vertex is lifted by 1 m by a sparse accessor, beside a triangle whose
    accessor has no buffer view at all: three zeros, overwritten in full."""
    glb = Glb()
    flat = facing_z(2, 2, cells=(4, 4))
    primitive = glb.primitive(flat, glb.unlit("cyan", (0, 1, 1)))
    middle = len(flat.positions) // 2
    accessor = glb.json["accessors"][primitive["attributes"]["POSITION"]]
    accessor["sparse"] = _sparse_part(glb, [middle], [(0, 0, 1)])
    accessor["max"] = [1, 1, 1]
    corners = [(-1.75, -0.5, 0), (-1.25, -0.5, 0), (-1.75, 0.5, 0)]
    position = glb.add(
        "accessors",
        {
            "componentType": 5126,
            "count": 3,
            "type": "VEC3",
            "min": [-1.75, -0.5, 0],
            "max": [-1.25, 0.5, 0],
            "sparse": _sparse_part(glb, [0, 1, 2], corners),
        },
    )
    lone = {"attributes": {"POSITION": position}, "material": glb.unlit("yellow", (1, 1, 0))}
    return watched(
        glb, [glb.node("grid", mesh=glb.mesh(primitive, "grid")), glb.node("triangle", mesh=glb.mesh(lone, "triangle"))]
    )


def _sparse_part(glb: Glb, places: Sequence[int], values: npt.ArrayLike) -> dict:
    return {
        "count": len(places),
        "indices": {"bufferView": glb.view(np.asarray(places, np.uint16).tobytes()), "componentType": 5123},
        "values": {"bufferView": glb.view(np.asarray(values, np.float32).tobytes())},
    }


def normalised() -> bytes:
    """What core glTF allows: UVs as 16-bit and colours as 8-bit fractions (RGB padded to four bytes)."""
    glb = Glb()
    quad = facing_z(2, 2, uv_scale=1)
    assert quad.uvs is not None
    texture = glb.texture(rgba([[(255, 255, 255), (255, 0, 0)], [(0, 255, 0), (0, 0, 255)]]))
    primitive = {
        "attributes": {
            "POSITION": glb.attribute(quad.positions, bounds=True),
            "TEXCOORD_0": glb.attribute(np.round(quad.uvs * 65535), "u16", normalized=True),
            "COLOR_0": glb.attribute([(51, 102, 255)] * 4, "u8", normalized=True),
        },
        "indices": glb.indices(quad.triangles),
        "material": glb.unlit("quarters", (1, 1, 1), texture=texture),
    }
    return watched(glb, [glb.node("quad", mesh=glb.mesh(primitive, "quad"))])


def quantised() -> bytes:
    """KHR_mesh_quantization: a box whose positions are normalised 16-bit and whose normals are 8-bit."""
    glb = Glb()
    glb.uses("KHR_mesh_quantization", required=True)
    shape = box((2, 2, 2))
    assert shape.normals is not None
    primitive = {
        "attributes": {
            "POSITION": glb.attribute(shape.positions * 32767, "i16", normalized=True, bounds=True),
            "NORMAL": glb.attribute(shape.normals * 127, "i8", normalized=True),
        },
        "indices": glb.indices(shape.triangles),
        "material": glb.unlit("green", (0.1, 0.8, 0.2)),
    }
    return watched(glb, [glb.node("box", scale=(0.5, 0.75, 1), mesh=glb.mesh(primitive, "box"))])


def negative_scale() -> bytes:
    """The same wedge twice, once mirrored in x: lit from +Z, both must look lit, as mirror images."""
    glb = Glb()
    points = [(0, -0.5, 0), (1, -0.5, 0.5), (1, 0.5, 0.5), (0, 0.5, 0)]
    primitive = {
        "attributes": {"POSITION": glb.attribute(points, bounds=True)},
        "indices": glb.indices([(0, 1, 2), (0, 2, 3)]),
        "material": glb.material("grey", (0.5, 0.5, 0.5)),
    }
    mesh = glb.mesh(primitive, "wedge")
    sun = glb.light("sun", "directional", 3)
    return watched(
        glb,
        [glb.node("right", (0.25, 0, 0), mesh=mesh), glb.node("left", (-0.25, 0, 0), scale=(-1, 1, 1), mesh=mesh), sun],
    )


def hierarchy() -> bytes:
    """A chain of TRS and matrix nodes over one small quad; README gives the product."""
    glb = Glb()
    quad = glb.mesh(glb.primitive(facing_z(0.25, 0.25), glb.unlit("magenta", (1, 0, 1))), "quad")
    leaf = glb.node("leaf", (1, 0, 0), mesh=quad)
    matrix = glb.add(
        "nodes",
        {
            "name": "matrix",
            "children": [leaf],  # columns: scale 2 in x, then move by (0, 0.5, 0)
            "matrix": [2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.5, 0, 1],
        },
    )
    turned = glb.node("turned", (-0.5, 0, 0), turn((0, 0, 1), 90), (0.5, 0.5, 0.5), children=[matrix])
    return watched(glb, [glb.node("root", (1, -0.5, -1), children=[turned])])


def instanced() -> bytes:
    """EXT_mesh_gpu_instancing: one quad nine times, under a node that moves them all."""
    glb = Glb()
    quad = glb.mesh(glb.primitive(facing_z(0.25, 0.25), glb.unlit("white", (1, 1, 1))), "quad")
    places = [(0.5 * x, 0.5 * y, 0) for y in (-1, 0, 1) for x in (-1, 0, 1)]
    extension = glb.uses("EXT_mesh_gpu_instancing", required=True)
    attributes = {"TRANSLATION": glb.accessor(places)}
    node = glb.node("nine", (0.5, 0, 0), mesh=quad, extensions={extension: {"attributes": attributes}})
    return watched(glb, [node])


SCENES = {
    f.__name__: f
    for f in (
        strips_fans, non_indexed, interleaved, sparse, normalised, quantised, negative_scale, hierarchy,
        instanced,
    )
}  # fmt: skip
