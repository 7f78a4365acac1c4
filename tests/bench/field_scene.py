# SPDX-License-Identifier: MIT
"""A hundred tessellated spheres over a floor: 520,192 triangles, on a merry-go-round unless `still`."""

from __future__ import annotations

import math

import numpy as np

from glb import Glb
from shapes import facing_up, sphere

SIDE = 10
FLOOR_CELLS = 64  # a side: 8,192 triangles
FREQUENCY = 16  # 20 · 16² triangles a sphere
EYE, TARGET, FOV = (0.0, 8.0, 13.5), (0.0, 0.0, 0.0), 45.0


def field(still: bool = False) -> bytes:
    """Matte, a quarter mirrors, a tenth glass; one point light. Every sphere is a node of its own, of shared meshes."""
    glb, random, ball = Glb(), np.random.default_rng(1), sphere(FREQUENCY)
    matte = [
        glb.material(f"matte {k}", colour, roughness=0.8)
        for k, colour in enumerate(((0.7, 0.2, 0.15), (0.15, 0.5, 0.2), (0.15, 0.25, 0.65), (0.75, 0.6, 0.2)))
    ]
    materials = [*matte, glb.mirror("mirror", (0.92, 0.92, 0.95)), glb.glass("glass", 1.5, 1)]
    shared = glb.primitive(ball)
    meshes = [glb.mesh(shared | {"material": material}, f"ball {k}") for k, material in enumerate(materials)]
    nodes = []
    for k in range(SIDE * SIDE):
        pick = random.random()
        mesh = meshes[5] if pick < 0.1 else meshes[4] if pick < 0.35 else meshes[k % 4]
        radius = 0.25 + 0.2 * random.random()
        x, z = ((n - (SIDE - 1) / 2) * 1.1 for n in (k % SIDE, k // SIDE))
        place = (x, radius + 0.01 + 0.6 * random.random(), z)
        nodes.append(glb.node(f"ball {k}", place, scale=(radius,) * 3, mesh=mesh))
    ring = glb.node("merry-go-round", children=nodes)
    floor = facing_up(4 * SIDE, 4 * SIDE, cells=(FLOOR_CELLS, FLOOR_CELLS))
    ground = glb.mesh(glb.primitive(floor, glb.material("ground", (0.5, 0.5, 0.5))), "ground")
    lamp = glb.light("lamp", "point", 40 * SIDE**2, placed={"translation": (SIDE, 1.5 * SIDE, SIDE)})
    if not still:
        turns = [(0, math.sin(a / 2), 0, math.cos(a / 2)) for a in np.linspace(0, 2 * np.pi, 9)]
        glb.animation("round", [(ring, "rotation", np.linspace(0, 8, 9), turns, "LINEAR")])
    glb.scene([ring, glb.node("ground", mesh=ground), lamp], "field")
    return glb.bytes()
