# SPDX-License-Identifier: MIT
"""Scenes made for the oracle: triangles of every size and shape, a tenth of them mirrors, under two lights."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

import bench_scenes
from glb import Glb
from shapes import Shape, joined, sphere


def _scene(points: np.ndarray, extent: float, centre: Sequence[float] = (0.0, 0.0, 0.0)) -> bytes:
    """Triangles (n, 3, 3) around `centre`, which is a node's translation; `extent` is half the width of it all."""
    glb = Glb()
    mirrors = max(1, len(points) // 10)
    parts = {
        "mirror": (glb.mirror("mirror", (0.95, 0.95, 0.95)), points[:mirrors]),
        "matte": (glb.material("matte", (0.6, 0.5, 0.4)), points[mirrors:]),
    }
    nodes = []
    for name, (material, part) in parts.items():
        if not len(part):
            continue
        flat = part.reshape(-1, 3)
        shape = Shape(flat, np.arange(len(flat)).reshape(-1, 3))
        nodes.append(glb.node(name, centre, mesh=glb.mesh(glb.primitive(shape, material), name)))
    lamp = np.asarray(centre) + np.array((0.7, 1.9, 1.3)) * extent
    nodes.append(glb.light("lamp", "point", 60 * extent**2, placed={"translation": lamp}))
    nodes.append(glb.light("sun", "directional", 2))
    lens = glb.perspective("camera", math.radians(50), near=0.001 * extent, far=100 * extent)
    nodes.append(glb.node("camera", np.asarray(centre) + np.array((0, 0, 2.2)) * extent, camera=lens))
    glb.scene(nodes, "soup")
    return glb.bytes()


def _random(count: int, ratio: float, seed: int) -> np.ndarray:
    """In the cube of half width 1, sizes log-uniform over `ratio`."""
    random = np.random.default_rng(seed)
    sizes = 0.4 * ratio ** -random.random((count, 1, 1))
    return random.uniform(-1, 1, (count, 1, 3)) + sizes * random.uniform(-1, 1, (count, 3, 3))


def soup() -> bytes:
    return _scene(_random(10_000, 100, 1), 1)


def soup_fine() -> bytes:
    """A hundred thousand triangles."""
    return _scene(_random(100_000, 300, 2), 1)


def soup_ratio() -> bytes:
    """Largest to smallest 10⁶ : 1."""
    return _scene(_random(20_000, 1e6, 3), 1)


def soup_tiny() -> bytes:
    return _scene(_random(5_000, 100, 4) * 1e-6, 1e-6)


def soup_huge() -> bytes:
    return _scene(_random(5_000, 100, 5) * 1e6, 1e6)


def soup_far() -> bytes:
    """A node 10⁷ m off."""
    return _scene(_random(5_000, 100, 6), 1, (1e7, -1e7, 1e7))


def soup_quantised() -> bytes:
    """10⁴ in the vertices: corners on a grid of 2⁻¹⁰, so that many coincide, align and lose their area."""
    random = np.random.default_rng(7)
    corner = np.round((random.uniform(-1, 1, (8_000, 1, 3)) + random.uniform(-0.02, 0.02, (8_000, 3, 3))) * 1024) / 1024
    return _scene(corner + 1e4, 1, (-1e4, -1e4, -1e4))


def needles() -> bytes:
    """Slivers of aspect 10² … 10⁶."""
    random = np.random.default_rng(8)
    count = 4_000
    a = random.uniform(-1, 1, (count, 3))
    along = random.uniform(-1, 1, (count, 3)) * 0.7
    across = random.uniform(-1, 1, (count, 3)) * 10.0 ** -random.uniform(2, 6, (count, 1))
    return _scene(np.stack([a, a + along, a + along * random.random((count, 1)) + across], 1), 1)


def coincident() -> bytes:
    """Every triangle four times, its corners turned and its sides exchanged: each hit is a tie."""
    once = _random(1_500, 30, 9)
    return _scene(np.concatenate([once, once[:, [1, 2, 0]], once[:, [0, 2, 1]], once]), 1)


def lattice() -> bytes:
    """Cubes on whole numbers that touch along faces: shared edges, coplanar faces, boxes with common borders."""
    random = np.random.default_rng(10)
    cells = np.argwhere(random.random((12, 12, 12)) < 0.25) - 6
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    return _scene((cells[:, None, None, :] + corners[faces][None]).reshape(-1, 3, 3) / 8, 0.75)


def shells() -> bytes:
    """Closed spheres inside each other: what leaks shows."""
    balls = joined([sphere(6 + 2 * k).scaled(0.3 + 0.2 * k) for k in range(4)])
    return _scene(balls.positions[balls.triangles], 1)


def spheres() -> bytes:
    """Mirror, glass and matte balls over a floor."""
    return bench_scenes.spheres(count=49, frequency=8)


SOUPS = {
    f.__name__: f
    for f in (
        soup, soup_fine, soup_ratio, soup_tiny, soup_huge, soup_far, soup_quantised, needles, coincident,
        lattice, shells, spheres,
    )
}  # fmt: skip
