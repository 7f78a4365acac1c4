# SPDX-License-Identifier: MIT
"""Scenes of any size for measurements; written on demand, never committed."""

from __future__ import annotations

import math

import numpy as np

from glb import Glb
from shapes import Shape, facing_up, look_at, smooth_normals, sphere


def spheres(
    count: int = 100,
    frequency: int = 16,
    seed: int = 1,
    apart: bool = False,
    still: bool = False,
    glass: float = 0.1,
    mirror: float = 0.25,
) -> bytes:
    """`count` balls of 20·frequency² triangles over a floor, all on a slow merry-go-round unless `still`.
    `apart`: every ball a mesh of its own instead of one shared mesh. `glass`, `mirror`: their shares."""
    glb = Glb()
    random = np.random.default_rng(seed)
    ball = sphere(frequency)
    side = math.ceil(math.sqrt(count))
    shared = glb.primitive(ball, 0)
    materials = [
        glb.material(f"matte {k}", c, roughness=0.8)
        for k, c in enumerate(((0.7, 0.2, 0.15), (0.15, 0.5, 0.2), (0.15, 0.25, 0.65), (0.75, 0.6, 0.2)))
    ]
    shiny, clear = glb.mirror("mirror", (0.92, 0.92, 0.95)), glb.glass("glass", 1.5, 1)
    by_material, nodes = {}, []
    for k in range(count):
        pick = random.random()
        material = clear if pick < glass else shiny if pick < glass + mirror else materials[k % len(materials)]
        if apart or material not in by_material:
            own = glb.primitive(ball, material) if apart else shared | {"material": material}
            by_material[material] = glb.mesh(own, f"ball {k}")
        radius = 0.25 + 0.2 * random.random()
        place = (
            (k % side - (side - 1) / 2) * 1.1,
            radius + 0.6 * random.random() + 0.01,
            (k // side - (side - 1) / 2) * 1.1,
        )
        nodes.append(glb.node(f"ball {k}", place, scale=(radius,) * 3, mesh=by_material[material]))
    ring = glb.node("merry-go-round", children=nodes)
    ground = glb.mesh(glb.primitive(facing_up(4 * side, 4 * side), glb.material("ground", (0.5, 0.5, 0.5))), "ground")
    lamp = glb.light("lamp", "point", 40 * side**2, placed={"translation": (side, 1.5 * side, side)})
    eye = np.array((0, 0.7 * side + 1, 1.25 * side + 1))
    view = glb.node("camera", eye, look_at(eye, (0, 0, 0)), camera=glb.perspective("camera", math.radians(45)))
    if not still:
        turns = [(0, math.sin(a / 2), 0, math.cos(a / 2)) for a in np.linspace(0, 2 * np.pi, 9)]
        glb.animation("round", [(ring, "rotation", np.linspace(0, 8, 9), turns, "LINEAR")])
    glb.scene([ring, glb.node("ground", mesh=ground), lamp, view], "spheres")
    return glb.bytes()


def soup(triangles: int = 10000, seed: int = 1, ratio: float = 100.0) -> bytes:
    """Random triangles in a 2 m cube, sizes log-uniform over `ratio`; a tenth of them mirrors."""
    glb = Glb()
    random = np.random.default_rng(seed)
    centres = random.uniform(-1, 1, (triangles, 1, 3))
    sizes = 0.5 * ratio ** -random.random((triangles, 1, 1))
    points = (centres + sizes * random.uniform(-1, 1, (triangles, 3, 3)) * 0.5).reshape(-1, 3)
    faces = np.arange(3 * triangles).reshape(-1, 3)
    shapes = {
        "matte": (glb.material("matte", (0.6, 0.5, 0.4), doubleSided=True), faces[triangles // 10 :]),
        "mirror": (glb.mirror("mirror", (0.9, 0.9, 0.9)), faces[: triangles // 10]),
    }
    nodes = []
    for name, (material, part) in shapes.items():
        if len(part):
            own = points[part.ravel()]
            index = np.arange(len(own)).reshape(-1, 3)
            shape = Shape(own, index, smooth_normals(own, index))
            nodes.append(glb.node(name, mesh=glb.mesh(glb.primitive(shape, material), name)))
    nodes.append(glb.light("lamp", "point", 60, placed={"translation": (1.5, 3, 3)}))
    lens = glb.perspective("camera", math.radians(40))
    nodes.append(glb.node("camera", (0, 0, 4), camera=lens))
    glb.scene(nodes, "soup")
    return glb.bytes()
