# SPDX-License-Identifier: MIT
"""Scenes at the edges: nothing to see, far off, tiny, huge, degenerate."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from geometry_scenes import watched
from glb import Glb
from shapes import Shape, box, facing_up, facing_z, look_at, sphere


def _still_life(scale: float = 1.0, offset: npt.ArrayLike = (0, 0, 0)) -> bytes:
    """A mirror ball and a matte box on a floor under a point light. `scale` is in the vertices and the lens, with
    candela by its square, `offset` in the nodes: the picture is the same for all."""
    glb = Glb()
    offset = np.asarray(offset, dtype=float)

    def at(*p: float) -> np.ndarray:
        return offset + np.asarray(p, dtype=float) * scale

    matte = glb.material("matte", (0.7, 0.3, 0.2))
    parts = {
        "floor": (facing_up(8, 8), glb.material("floor", (0.6, 0.6, 0.6)), (0, 0, 0)),
        "ball": (_ball(), glb.mirror("mirror", (0.9, 0.9, 0.9)), (0.75, 0.7515, 0)),
        "box": (box((1, 1, 1)), matte, (-0.75, 0.5015, 0.25)),
    }
    nodes = []
    for name, (shape, material, place) in parts.items():
        mesh = glb.mesh(glb.primitive(shape.scaled(scale), material), name)
        nodes.append(glb.node(name, at(*place), mesh=mesh))
    nodes.append(glb.light("lamp", "point", 60 * scale**2, placed={"translation": at(1.5, 3, 2.5)}))
    lens = glb.perspective("camera", math.radians(40), near=0.01 * scale, far=100 * scale)
    eye = np.array((0.5, 2, 5.5))
    nodes.append(glb.node("camera", at(*eye), look_at(eye, (0, 0.5, 0)), camera=lens))
    glb.scene(nodes, "still life")
    return glb.bytes()


def _ball() -> Shape:
    ball = sphere(6)
    return Shape(ball.positions * 0.75, ball.triangles, ball.normals)


def still_life() -> bytes:
    return _still_life()


def still_life_far() -> bytes:
    return _still_life(offset=(1e7, -1e7, 1e7))


def still_life_tiny() -> bytes:
    return _still_life(scale=1e-6)


def still_life_huge() -> bytes:
    return _still_life(scale=1e6)


def far_vertices() -> bytes:
    """10⁷ is in the vertices themselves: whole numbers, which single precision still tells apart."""
    glb = Glb()
    shape = box((8, 4, 2)).moved((1e7, 0, 0))
    mesh = glb.mesh(glb.primitive(shape, glb.unlit("yellow", (1, 0.8, 0))), "box")
    eye = glb.node("camera", (1e7, 0, 20), camera=glb.orthographic("camera", 8, 4))
    glb.scene([glb.node("box", mesh=mesh), eye], "far")
    return glb.bytes()


def no_camera() -> bytes:
    glb = Glb()
    mesh = glb.mesh(glb.primitive(box((2, 1, 1), (3, 0.5, 0)), glb.material("grey", (0.5, 0.5, 0.5))), "box")
    glb.scene([glb.node("box", mesh=mesh), glb.light("sun", "directional", 3)], "no camera")
    return glb.bytes()


def no_light() -> bytes:
    glb = Glb()
    mesh = glb.mesh(glb.primitive(box((1, 1, 1)), glb.material("grey", (0.5, 0.5, 0.5))), "box")
    return watched(glb, [glb.node("box", mesh=mesh)])


def no_triangles() -> bytes:
    """A camera, a light, a line and points: everything but a surface."""
    glb = Glb()
    points = glb.attribute([(0, 0, 0), (1, 0, 0), (1, 1, 0)], bounds=True)
    mesh = glb.mesh([{"attributes": {"POSITION": points}, "mode": mode} for mode in (0, 3)], "lines")
    return watched(glb, [glb.node("lines", mesh=mesh), glb.light("sun", "directional", 3)])


def empty() -> bytes:
    glb = Glb()
    glb.scene([glb.node("nothing")], "empty")
    return glb.bytes()


def degenerate() -> bytes:
    """One honest square among zero-area, repeated-vertex, coincident and sliver triangles."""
    glb = Glb()
    points = [
        (-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0),  # the square
        (1, 0, 0), (1.25, 0, 0), (1.5, 0, 0),  # in one line
        (-1.5, -0.75, 0), (-1.5, 0.75, 0), (-1.5 + 1.5e-6, 0.75, 0),  # 10⁶ : 1
    ]  # fmt: skip
    triangles = [(0, 1, 2), (0, 2, 3), (4, 5, 6), (4, 4, 5), (4, 4, 4), (0, 1, 2), (2, 0, 1), (7, 9, 8)]
    primitive = {
        "attributes": {"POSITION": glb.attribute(points, bounds=True)},
        "indices": glb.indices(triangles),
        "material": glb.unlit("white", (1, 1, 1)),
    }
    return watched(glb, [glb.node("shapes", mesh=glb.mesh(primitive, "shapes"))])


def zero_scale() -> bytes:
    """A square flattened to nothing beside one that is not."""
    glb = Glb()
    square = glb.mesh(glb.primitive(facing_z(0.5, 0.5), glb.unlit("white", (1, 1, 1))), "square")
    return watched(
        glb,
        [
            glb.node("gone", (-1, 0, 0), scale=(0, 0, 0), mesh=square),
            glb.node("line", (0, 0, 0), scale=(1, 0, 1), mesh=square),
            glb.node("there", (1, 0, 0), mesh=square),
        ],
    )


def coplanar() -> bytes:
    """Two meshes in one plane: what has more red comes first, so red covers blue everywhere."""
    glb = Glb()
    red, blue = glb.unlit("red", (1, 0, 0)), glb.unlit("blue", (0, 0, 1))
    return watched(
        glb,
        [glb.node(n, mesh=glb.mesh(glb.primitive(facing_z(1, 1), m), n)) for n, m in (("red", red), ("blue", blue))],
    )


SCENES = {
    f.__name__: f
    for f in (
        still_life, still_life_far, still_life_tiny, still_life_huge, far_vertices, no_camera, no_light,
        no_triangles, empty, degenerate, zero_scale, coplanar,
    )
}  # fmt: skip
