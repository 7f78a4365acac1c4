# SPDX-License-Identifier: MIT
"""A city on one footprint at any number of triangles: 16 × 16 lots, towers with walls in relief, and glass domes.

More triangles make the same towers finer, so that a fixed view sees the same city. Sixteen designs share the lots:
`instanced`, a lot is a node that names its design's mesh; flat, every lot has a copy of its own.
"""

from __future__ import annotations

import math

import numpy as np

from glb import Glb, snap
from shapes import Shape, facing_up, joined, smooth_normals, sphere

SIDE, PITCH = 16, 4.0  # lots a side; metres from lot to lot
DESIGNS = 16
MIRRORS, DOMES = (12, 13), (14, 15)  # of the designs; the rest are matte, and their walls have a grain
EYE, TARGET, FOV = (-22.0, 14.0, 30.0), (2.0, 1.0, -2.0), 45.0
RELIEF = 0.12  # metres


def wall(
    corner: tuple[float, ...],
    u: tuple[float, ...],
    v: tuple[float, ...],
    cells: int,
    grain: float,
    random: np.random.Generator,
) -> Shape:
    """cells × cells squares of two triangles; corners inside the outline stand out or back by up to RELIEF."""
    origin, along, upward = (np.asarray(a, dtype=np.float64) for a in (corner, u, v))
    steps = np.linspace(0, 1, cells + 1)
    across, up = (a.ravel() for a in np.meshgrid(steps, steps))
    normal = np.cross(along, upward) / np.linalg.norm(np.cross(along, upward))
    inside = (across > 0) & (across < 1) & (up > 0) & (up < 1)
    # Bays of eight a side at every number of triangles, and a grain that is finer the more there are.
    bays = 0.5 * np.sin(8 * np.pi * across) * np.sin(8 * np.pi * up)
    height = RELIEF * inside * (bays + grain * random.uniform(-0.5, 0.5, len(across)) * min(1.0, 8 / cells))
    first = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    row = cells + 1
    lower = np.stack([first, first + 1, first + row + 1], 1)
    upper = np.stack([first, first + row + 1, first + row], 1)
    points = origin + across[:, None] * along + up[:, None] * upward + height[:, None] * normal
    triangles = np.stack([lower, upper], 1).reshape(-1, 3)
    return Shape(snap(points), triangles, smooth_normals(points, triangles))


def tower(triangles: float, design: int) -> Shape:
    """Four walls and a roof; no floor, since the ground is there. Its size is that of its design alone."""
    random = np.random.default_rng((7, design))
    grain = float(design not in MIRRORS)
    cells = max(1, round(math.sqrt(triangles / 10)))
    w, d, h = random.uniform(1.0, 1.4), random.uniform(1.0, 1.4), random.uniform(1.5, 7.0)
    faces = [
        ((-w, 0, d), (2 * w, 0, 0), (0, h, 0)),
        ((w, 0, -d), (-2 * w, 0, 0), (0, h, 0)),
        ((w, 0, d), (0, 0, -2 * d), (0, h, 0)),
        ((-w, 0, -d), (0, 0, 2 * d), (0, h, 0)),
        ((-w, h, d), (2 * w, 0, 0), (0, 0, -2 * d)),
    ]
    return joined([wall(*face, cells, grain, random) for face in faces])


def dome(triangles: float) -> Shape:
    """A glass sphere that stands clear of the ground."""
    ball = sphere(max(1, round(math.sqrt(triangles / 20))))
    return ball.scaled(1.3).moved((0, 1.35, 0))


def city(triangles: int, instanced: bool = False) -> bytes:
    """About so many triangles in all, within some per cent; a sun."""
    glb = Glb()
    share = (triangles - 2) / SIDE**2
    greys = [glb.material(f"stone {k}", (0.35 + 0.04 * k, 0.4, 0.62 - 0.04 * k), roughness=0.9) for k in range(DESIGNS)]
    mirror, glass = glb.mirror("mirror", (0.85, 0.88, 0.9)), glb.glass("glass", 1.5, 1)
    designs = [dome(share) if k in DOMES else tower(share, k) for k in range(DESIGNS)]

    def mesh_of(k: int) -> int:
        material = mirror if k in MIRRORS else glass if k in DOMES else greys[k]
        return glb.mesh(glb.primitive(designs[k], material), f"design {k}")

    shared = [mesh_of(k) for k in range(DESIGNS)] if instanced else []
    lots = np.random.default_rng(7).permutation(np.arange(SIDE**2) % DESIGNS)
    nodes = []
    for lot, design in enumerate(lots):
        x, z = ((n - (SIDE - 1) / 2) * PITCH for n in (lot % SIDE, lot // SIDE))
        mesh = shared[design] if instanced else mesh_of(int(design))
        nodes.append(glb.node(f"lot {lot}", (x, 0, z), mesh=mesh))
    ground = glb.mesh(glb.primitive(facing_up(400, 400), glb.material("ground", (0.45, 0.45, 0.45))), "ground")
    half = math.radians(-55) / 2  # the sun's -Z leans down, then is turned about +Y
    turn = math.radians(-35) / 2
    sun = glb.light(
        "sun",
        "directional",
        5,
        placed={
            "rotation": snap(
                (
                    math.cos(turn) * math.sin(half),
                    math.sin(turn) * math.cos(half),
                    -math.sin(turn) * math.sin(half),
                    math.cos(turn) * math.cos(half),
                ),
                2.0**-40,
            )
        },
    )
    glb.scene([*nodes, glb.node("ground", mesh=ground), sun], "city")
    return glb.bytes()
