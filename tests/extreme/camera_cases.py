# SPDX-License-Identifier: MIT
"""Pictures and cameras of extreme sizes, and cameras where surfaces are."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from case import (
    BLUE,
    FURNACE,
    NO_LIGHT,
    TRACED,
    WHITE,
    Case,
    everywhere,
    mirror,
    nothing,
    one_mesh,
    sane,
    shows,
    triangles_of,
    unlit,
)
from geometry_scenes import watched
from glb import Glb
from rendering import SCENES, Picture
from shapes import Shape, box, facing_z


def in_a_box(lens: Callable[[Glb], int], eye: Any = (0, 0, 0)) -> bytes:
    """A closed white box of 2 m round the camera."""
    glb = Glb()
    shape = box((2, 2, 2))
    mesh = glb.mesh(glb.primitive(Shape(shape.positions, shape.triangles), glb.unlit("white", WHITE)))
    glb.scene([glb.node("box", mesh=mesh), glb.node("camera", eye, camera=lens(glb))], "box")
    return glb.bytes()


def bare_perspective(yfov: float, near: float | None = 1e-4) -> Callable[[Glb], int]:
    return lambda glb: glb.add("cameras", {"type": "perspective", "perspective": {"yfov": yfov, "znear": near}})


def on_a_surface(*points: Sequence[float]) -> bytes:
    """The camera's eye lies in a triangle that it must not see, the square is behind it."""
    glb = Glb()
    primitives = [
        glb.primitive(triangles_of(points), glb.unlit("blue", BLUE)),
        glb.primitive(facing_z(1, 1), glb.unlit("white", WHITE)),
    ]
    return watched(glb, [glb.node("both", mesh=glb.mesh(primitives))])


def two_million_rays() -> bytes:
    """One mirror of one triangle, met by every ray."""
    return one_mesh(triangles_of([(-8, -4, 0), (8, -4, 0), (0, 12, 0)]), mirror((0.5, 0.5, 0.5)), NO_LIGHT)


def framed_whole(picture: Picture) -> None:
    """The box is seen, and nothing of it past the picture's border."""
    sane(picture)
    covered = picture.alpha > 0
    assert covered.sum() > 20
    assert not (covered[0].any())
    assert not (covered[-1].any())
    assert not (covered[:, 0].any())
    assert not (covered[:, -1].any())


HALF = lambda x, y: (abs(x) < 0.5) & (abs(y) < 0.5)  # noqa: E731
SQUARE = shows(WHITE, HALF)
CASES = {
    "one pixel": Case(lambda: one_mesh(facing_z(1, 1), unlit()), everywhere(WHITE), size="1x1"),
    "16384 pixels wide": Case(
        lambda: one_mesh(facing_z(2000, 1), unlit()),
        shows(WHITE, lambda x, y: abs(x) < 1000, extent=(16384, 1)),
        TRACED,
        size="16384x1",
    ),
    "16384 pixels high": Case(
        lambda: one_mesh(facing_z(1, 1), unlit()),
        shows(WHITE, lambda x, y: abs(y) < 0.5, extent=(1 / 16384, 1)),
        TRACED,
        size="1x16384",
    ),
    "16384 pixels wide, rasterised": Case(
        lambda: one_mesh(facing_z(2000, 1), unlit()),
        shows(WHITE, lambda x, y: abs(x) < 1000, extent=(16384, 1)),
        size="16384x1",
    ),
    "no triangle": Case((SCENES / "no_triangles.glb").read_bytes, nothing),
    "nothing at all": Case((SCENES / "empty.glb").read_bytes, nothing),
    "no camera": Case((SCENES / "no_camera.glb").read_bytes, framed_whole),
    "two million rays to one triangle": Case(two_million_rays, everywhere((0.5, 0.5, 0.5)), FURNACE, size="2048x1024"),
    "orthographic camera inside a solid": Case(
        lambda: in_a_box(lambda glb: glb.orthographic("camera", 0.5, 0.5)), everywhere(WHITE), ("--back-faces", "show")
    ),
    "field of 1e-5 radians": Case(
        lambda: in_a_box(bare_perspective(1e-5)), everywhere(WHITE), ("--back-faces", "show")
    ),
    "field of 179.9 degrees": Case(
        lambda: in_a_box(bare_perspective(math.radians(179.9))), everywhere(WHITE), ("--back-faces", "show", *TRACED)
    ),
    "near plane at 1e-30": Case(
        lambda: in_a_box(bare_perspective(1.0, 1e-30)), everywhere(WHITE), ("--back-faces", "show")
    ),
    "camera in the plane of a triangle": Case(lambda: on_a_surface((0, -1, 5), (0, 1, 5), (0, 0, 4)), SQUARE, TRACED),
    "camera on a surface and a vertex": Case(
        lambda: on_a_surface((-3, -3, 5), (3, -3, 5), (0, 3, 5), (0, 0, 5), (3, 0, 6), (0, 3, 6)), SQUARE
    ),
}
