# SPDX-License-Identifier: MIT
"""Small animated scenes whose vertices at given times can be computed by hand (README.md)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from geometry_scenes import watched
from glb import Glb
from shapes import facing_z, turn


def _square(glb: Glb, name: str, colour: Sequence[float], size: float = 0.25, **placed: Any) -> int:
    shape = facing_z(size, size)
    return glb.node(name, mesh=glb.mesh(glb.primitive(shape, glb.unlit(name, colour)), name), **placed)


def _bar(glb: Glb, weights: Any) -> int:
    """A strip 0.2 m wide and 2 m high on three pairs of vertices; gives its mesh."""
    points = [(x, y, 0) for y in (0, 1, 2) for x in (-0.1, 0.1)]
    primitive: dict[str, Any] = {
        "attributes": {"POSITION": glb.attribute(points, bounds=True)},
        "indices": glb.indices([(0, 1, 3), (0, 3, 2), (2, 3, 5), (2, 5, 4)]),
        "material": glb.unlit("bar", (1, 0.5, 0)),
    }
    for k in range(0, len(weights[0]), 4):
        part = np.asarray(weights)[:, k : k + 4]
        primitive["attributes"][f"JOINTS_{k // 4}"] = glb.attribute(np.arange(k, k + 4) * (part > 0), "u8")
        primitive["attributes"][f"WEIGHTS_{k // 4}"] = glb.attribute(part)
    return glb.mesh(primitive, "bar")


def _bent(glb: Glb, weights: Any, copies: int = 1) -> bytes:
    """Two joints, at y = 0 and y = 1; the upper one turns from 0° to 90° about +Z in 1 s. Even places of the skin
    are the lower joint and nodes fixed to it, odd ones the upper's."""
    lower_copies = [glb.node(f"lower {k}") for k in range(1, copies)]
    upper_copies = [glb.node(f"upper {k}") for k in range(1, copies)]
    upper = glb.node("upper", (0, 1, 0), **({"children": upper_copies} if upper_copies else {}))
    lower = glb.node("lower", (0, -1, 0), children=[upper, *lower_copies])
    joints = [node for pair in zip([lower, *lower_copies], [upper, *upper_copies], strict=True) for node in pair]
    inverse = np.tile(np.eye(4), (len(joints), 1, 1))
    inverse[1::2, 1, 3] = -1
    # The skinned node's own transform must be ignored (glTF 2.0, 3.7.3.3).
    bar = glb.node("bar", (7, 7, 7), mesh=_bar(glb, weights), skin=glb.skin(joints, inverse))
    glb.animation("bend", [(upper, "rotation", [0, 1], [turn((0, 0, 1), a) for a in (0, 90)], "LINEAR")])
    return watched(glb, [lower, bar], 2, 1.25)


def skin() -> bytes:
    rows = [(1, 0, 0, 0)] * 2 + [(0.5, 0.5, 0, 0)] * 2 + [(0, 1, 0, 0)] * 2
    return _bent(Glb(), rows)


def skin8() -> bytes:
    """The same bar with its influences spread over eight places; a row sums to 2 and one to 0.5, so that a
    reader that does not normalise tears it."""
    thin = np.array(
        [(0.25, 0, 0.25, 0, 0.25, 0, 0.25, 0)] * 2 + [(0.125,) * 8] * 2 + [(0, 0.25, 0, 0.25, 0, 0.25, 0, 0.25)] * 2
    )
    return _bent(Glb(), thin * np.array([1, 2, 1, 1, 0.5, 1])[:, None], copies=4)


def morph() -> bytes:
    """A square with two targets, one all in a sparse accessor; weights (0,0) → (1,0) → (0.5,0.5), 1 s apart."""
    glb = Glb()
    shape = facing_z(1, 1)
    wider = np.where(shape.positions[:, :1] > 0, [(1, 0, 0)], [(0, 0, 0)])
    places = np.array([2, 3], np.uint16)  # the upper two vertices
    raised = glb.add(
        "accessors",
        {
            "componentType": 5126,
            "count": 4,
            "type": "VEC3",
            "min": [0, 0, 0],
            "max": [0, 0.5, 0],
            "sparse": {
                "count": 2,
                "indices": {"bufferView": glb.view(places.tobytes()), "componentType": 5123},
                "values": {"bufferView": glb.view(np.array([(0, 0.5, 0)] * 2, np.float32).tobytes())},
            },
        },
    )
    primitive = glb.primitive(shape, glb.unlit("square", (0.5, 0, 1)))
    primitive["targets"] = [{"POSITION": glb.attribute(wider, bounds=True)}, {"POSITION": raised}]
    mesh = glb.mesh(primitive, "square", weights=[0, 0], extras={"targetNames": ["wider", "taller"]})
    node = glb.node("square", mesh=mesh)
    glb.animation("morph", [(node, "weights", [0, 1, 2], [(0, 0), (1, 0), (0.5, 0.5)], "LINEAR")])
    return watched(glb, [node])


def interpolation() -> bytes:
    """Four squares at y = 0.75, 0.25, -0.25, -0.75: x by STEP, LINEAR and CUBICSPLINE through 0, 1, 0 at
    0, 1, 2 s, and one that turns by LINEAR from 0° to 90° whose second key has the opposite sign."""
    glb = Glb()
    names = ("step", "linear", "cubic", "turning")
    colours = ((1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1))
    nodes = [
        _square(glb, n, c, translation=(0, 0.75 - 0.5 * k, 0))
        for k, (n, c) in enumerate(zip(names, colours, strict=True))
    ]
    times = [0, 1, 2]
    channels: list[tuple[Any, ...]] = []
    for k, kind in enumerate(("STEP", "LINEAR", "CUBICSPLINE")):
        values = np.array([(x, 0.75 - 0.5 * k, 0) for x in (0, 1, 0)])
        if kind == "CUBICSPLINE":  # leaves and arrives with 2 m/s at 0 and 2 s, stands still at 1 s
            tangents = np.array([(2, 0, 0), (0, 0, 0), (2, 0, 0)])
            values = np.stack([tangents, values, tangents], axis=1)
        channels.append((nodes[k], "translation", times, values, kind))
    channels.append((nodes[3], "rotation", [0, 2], [turn((0, 0, 1), 0), -turn((0, 0, 1), 90)], "LINEAR"))
    channels.append((nodes[3], "scale", [0.5, 1.5], [(1, 1, 1), (2, 0.5, 1)], "LINEAR"))
    glb.animation("interpolation", channels)
    return watched(glb, nodes)


def stiff_keys() -> bytes:
    """Keys 10⁻⁷ s apart, a channel with a single key, and unnormalised quaternions."""
    glb = Glb()
    jump = _square(glb, "jump", (1, 0, 0))
    still = _square(glb, "still", (0, 1, 0))
    loose = _square(glb, "loose", (0, 0, 1), translation=(0, -0.5, 0))
    quarter = turn((0, 0, 1), 90)
    glb.animation(
        "stiff",
        [
            (jump, "translation", [0, 0.5, 0.5 + 1e-7], [(-1, 0, 0), (-1, 0, 0), (1, 0, 0)], "LINEAR"),
            (still, "translation", [0.25], [(0, 0.5, 0)], "LINEAR"),
            (loose, "rotation", [0, 1], [(0, 0, 0, 3), quarter * 0.5], "LINEAR"),
        ],
    )
    return watched(glb, [jump, still, loose])


def scenes_animations() -> bytes:
    """Two scenes, the second the default, and two animations over both."""
    glb = Glb()
    red, blue = _square(glb, "red", (1, 0, 0), 1), _square(glb, "blue", (0, 0, 1), 1)
    glb.animation("up", [(n, "translation", [0, 1], [(0, 0, 0), (0, 0.5, 0)], "LINEAR") for n in (red, blue)])
    glb.animation("turn", [(blue, "rotation", [0, 2], [turn((0, 0, 1), a) for a in (0, 90)], "LINEAR")])
    eye = glb.node("camera", (0, 0, 5), camera=glb.orthographic("camera", 2, 1))
    glb.scene([red, eye], "red scene")
    glb.json["scene"] = glb.scene([blue, eye], "blue scene")
    return glb.bytes()


SCENES = {f.__name__: f for f in (skin, skin8, morph, interpolation, stiff_keys, scenes_animations)}
