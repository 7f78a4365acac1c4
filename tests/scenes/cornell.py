# SPDX-License-Identifier: MIT
"""A box after Cornell's: ten meshes of their own, 2 m wide and open at the front, with a mirror block, a tinted
glass block, a ball and a point light. Surfaces are cut into cells, so that bounding spheres have work to do."""

import numpy as np

from glb import Glb
from shapes import box, grid, look_at, sphere, turn

CELLS = 8


def build() -> bytes:
    glb = Glb()
    white = glb.material("white", (0.73, 0.73, 0.73))
    red = glb.material("red", (0.63, 0.065, 0.05))
    green = glb.material("green", (0.14, 0.45, 0.09))
    blue = glb.material("blue", (0.15, 0.3, 0.65))
    lamp = glb.material(
        "lamp",
        (0, 0, 0),
        emissiveFactor=[1, 1, 0.85],
        extensions={"KHR_materials_emissive_strength": {"emissiveStrength": 6}},
    )
    mirror = glb.mirror("mirror", (0.9, 0.9, 0.92))
    glass = glb.glass("glass", 1.5, thickness=0.6, colour=(0.55, 0.85, 0.95), distance=0.8)

    walls = {  # corner, u, v: seen from inside
        "floor": ((-1, 0, 1), (2, 0, 0), (0, 0, -2), white),
        "ceiling": ((-1, 2, -1), (2, 0, 0), (0, 0, 2), white),
        "back": ((-1, 0, -1), (2, 0, 0), (0, 2, 0), white),
        "left": ((-1, 0, 1), (0, 0, -2), (0, 2, 0), red),
        "right": ((1, 0, -1), (0, 0, 2), (0, 2, 0), green),
    }
    nodes = []
    for name, (corner, u, v, material) in walls.items():
        wall = grid(corner, u, v, (CELLS, CELLS))
        nodes.append(glb.node(name, mesh=glb.mesh(glb.primitive(wall, material), name)))
    rim = grid((-0.3, 1.995, 0.15), (0.6, 0, 0), (0, 0, 0.6), (2, 2))
    nodes.append(glb.node("lamp", mesh=glb.mesh(glb.primitive(rim, lamp), "lamp")))
    blocks = {  # size, place of the foot's centre, turn about +Y in degrees
        "mirror block": ((0.58, 1.2, 0.58), (-0.36, 0.002, -0.36), 38, mirror),
        "glass block": ((0.56, 0.6, 0.56), (0.4, 0.002, 0.34), -17, glass),
        "plinth": ((0.3, 0.25, 0.3), (-0.62, 0.002, 0.2), 0, blue),
    }
    for name, (size, foot, angle, material) in blocks.items():
        shape = box(size, (0, size[1] / 2, 0), cells=4)
        mesh = glb.mesh(glb.primitive(shape, material), name)
        nodes.append(glb.node(name, foot, turn((0, 1, 0), angle), mesh=mesh))
    ball = glb.mesh(glb.primitive(sphere(8), white), "ball")
    nodes.append(glb.node("ball", (-0.62, 0.415, 0.2), scale=(0.16,) * 3, mesh=ball))
    nodes.append(glb.light("point", "point", 8, (1, 0.96, 0.85), {"translation": (0, 1.8, 0.45)}))
    lens = glb.perspective("camera", np.radians(39.3), 1, 0.1, 20)
    nodes.append(glb.node("camera", (0, 1, 3.8), look_at((0, 1, 3.8), (0, 1, 0)), camera=lens))
    glb.scene(nodes, "cornell")
    return glb.bytes()
