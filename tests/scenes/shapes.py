# SPDX-License-Identifier: MIT
"""Triangle shapes and a little vector algebra. Counter-clockwise seen from outside; metres; +Y up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from glb import snap


@dataclass(frozen=True)
class Shape:
    positions: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray | None = None
    uvs: np.ndarray | None = None

    def moved(self, offset: npt.ArrayLike) -> Shape:
        return replace(self, positions=self.positions + np.asarray(offset, dtype=np.float64))

    def scaled(self, factor: npt.ArrayLike) -> Shape:
        return replace(self, positions=self.positions * np.asarray(factor, dtype=np.float64))


def unit(v: npt.ArrayLike) -> np.ndarray:
    v = np.asarray(v, dtype=np.float64)
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def joined(shapes: Sequence[Shape]) -> Shape:
    """One shape of many; all or none have normals and UVs."""
    starts = np.cumsum([0] + [len(s.positions) for s in shapes[:-1]])
    together = {
        name: np.concatenate([getattr(s, name) for s in shapes])
        for name in ("positions", "normals", "uvs")
        if getattr(shapes[0], name) is not None
    }
    return Shape(triangles=np.concatenate([s.triangles + n for s, n in zip(shapes, starts, strict=True)]), **together)


def grid(corner: npt.ArrayLike, u: npt.ArrayLike, v: npt.ArrayLike, cells: Any = (1, 1), uv_scale: Any = None) -> Shape:
    """A parallelogram from `corner` along u and v; its normal is u × v. Where asked for, UVs run along u,
    and down along v as images do: (0, 0) is at the far end of v."""
    corner, u, v = (np.asarray(a, dtype=np.float64) for a in (corner, u, v))
    s, t = (np.linspace(0, 1, n + 1) for n in cells)
    across, up = (a.ravel() for a in np.meshgrid(s, t))
    row = cells[0] + 1
    first = (np.arange(cells[1])[:, None] * row + np.arange(cells[0])).ravel()
    lower = np.stack([first, first + 1, first + row + 1], 1)
    upper = np.stack([first, first + row + 1, first + row], 1)
    return Shape(
        positions=snap(corner + across[:, None] * u + up[:, None] * v),
        triangles=np.stack([lower, upper], 1).reshape(-1, 3),
        normals=snap(np.broadcast_to(unit(np.cross(u, v)), (len(across), 3))),
        uvs=snap(np.stack([across, 1 - up], 1) * uv_scale) if uv_scale else None,
    )


def facing_z(
    width: float,
    height: float,
    z: float = 0.0,
    centre: Sequence[float] = (0.0, 0.0),
    cells: Any = (1, 1),
    uv_scale: Any = None,
) -> Shape:
    """A rectangle seen from +Z."""
    return grid((centre[0] - width / 2, centre[1] - height / 2, z), (width, 0, 0), (0, height, 0), cells, uv_scale)


def facing_up(width: float, depth: float, y: float = 0.0, cells: Any = (1, 1), uv_scale: Any = None) -> Shape:
    return grid((-width / 2, y, depth / 2), (width, 0, 0), (0, 0, -depth), cells, uv_scale)


def box(
    size: npt.ArrayLike = (1, 1, 1), centre: Sequence[float] = (0, 0, 0), cells: Any = 1, uv_scale: Any = None
) -> Shape:
    """Six faces of their own with flat normals, outward."""
    half = np.asarray(size, dtype=np.float64) / 2
    faces = []
    for axis in range(3):
        for sign in (1, -1):
            u, v, n = np.zeros(3), np.zeros(3), np.zeros(3)
            n[axis] = sign * half[axis]
            u[(axis + 1) % 3] = 2 * half[(axis + 1) % 3]
            v[(axis + 2) % 3] = 2 * half[(axis + 2) % 3]
            u, v = (u, v) if sign > 0 else (v, u)
            faces.append(grid(n - u / 2 - v / 2, u, v, (cells, cells), uv_scale))
    return joined(faces).moved(centre)


def _icosahedron() -> tuple[np.ndarray, list[tuple[int, int, int]]]:
    g = (1 + 5**0.5) / 2
    corners = [
        (-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
        (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1),
    ]  # fmt: skip
    faces = [
        (0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
        (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9),
        (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1),
    ]  # fmt: skip
    return unit(np.array(corners, dtype=np.float64)), faces


def sphere(frequency: int) -> Shape:
    """A unit sphere: an icosahedron's faces cut into frequency² each, 20·frequency² triangles, watertight
    (neighbours share their vertices). Positions are the exact normals."""
    corners, faces = _icosahedron()
    positions: list[np.ndarray] = []
    known: dict[tuple[tuple[int, int], ...], int] = {}
    triangles = []

    def vertex(face: tuple[int, int, int], i: int, j: int) -> int:
        weights = (frequency - i - j, i, j)
        key = tuple(sorted((c, w) for c, w in zip(face, weights, strict=True) if w))
        if key not in known:
            known[key] = len(positions)
            positions.append(sum(corners[c] * w for c, w in key))
        return known[key]

    for face in faces:
        for i in range(frequency):
            for j in range(frequency - i):
                a, b, c = vertex(face, i, j), vertex(face, i + 1, j), vertex(face, i, j + 1)
                triangles.append((a, b, c))
                if i + j < frequency - 1:
                    triangles.append((b, vertex(face, i + 1, j + 1), c))
    points = snap(unit(np.array(positions)))
    return Shape(points, np.array(triangles), normals=points)


def smooth_normals(positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Area-weighted mean of the faces' normals at each vertex."""
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    face = np.cross(b - a, c - a)
    total = np.zeros_like(positions)
    for k in range(3):
        np.add.at(total, triangles[:, k], face)
    return snap(unit(total))


# ---- rotations: quaternions as glTF writes them, x y z w ----
def turn(axis: npt.ArrayLike, degrees: float) -> np.ndarray:
    half = np.radians(degrees) / 2
    return snap(np.append(unit(axis) * np.sin(half), np.cos(half)), 2.0**-40)


def quaternion(matrix: npt.ArrayLike) -> np.ndarray:
    """Of a rotation matrix, by the largest of the four components, so that nothing cancels."""
    m = np.asarray(matrix, dtype=np.float64)
    squares = [
        1 + m[0, 0] - m[1, 1] - m[2, 2],
        1 - m[0, 0] + m[1, 1] - m[2, 2],
        1 - m[0, 0] - m[1, 1] + m[2, 2],
        1 + np.trace(m),
    ]
    k = int(np.argmax(squares))
    x, y, z, w = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], squares[3]
    rows = [
        (squares[0], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], x),
        (m[0, 1] + m[1, 0], squares[1], m[1, 2] + m[2, 1], y),
        (m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], squares[2], z),
        (x, y, z, w),
    ]
    return snap(unit(rows[k]), 2.0**-40)


def look_rotation(eye: npt.ArrayLike, target: npt.ArrayLike, up: npt.ArrayLike = (0, 1, 0)) -> np.ndarray:
    """Columns: the axes of a camera (or light) at `eye` whose -Z points at `target`."""
    back = unit(np.asarray(eye, dtype=np.float64) - np.asarray(target, dtype=np.float64))
    right = unit(np.cross(np.asarray(up, dtype=np.float64), back))
    return np.stack([right, np.cross(back, right), back], axis=1)


def look_at(eye: npt.ArrayLike, target: npt.ArrayLike, up: npt.ArrayLike = (0, 1, 0)) -> np.ndarray:
    return quaternion(look_rotation(eye, target, up))
