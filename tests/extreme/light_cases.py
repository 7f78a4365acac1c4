# SPDX-License-Identifier: MIT
"""Lights where they should not be, too strong, too weak, too many. The receiver is a white diffuse plane at z = 0."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from case import BLUE, TRACED, WHITE, Case, everywhere, lamp, matte, one_mesh
from geometry_scenes import watched
from glb import Glb
from physics import close, pixels
from rendering import Picture
from shapes import Shape, box, facing_z, look_at, turn

DARK = everywhere((0, 0, 0))


def plane(*lights: Callable[[Glb], int]) -> bytes:
    return one_mesh(facing_z(4.5, 2.5), matte(), *lights)


def lit_from(height: float, intensity: float) -> Callable[[Picture], None]:
    """A point light `height` above the middle: I·h / (π (h² + r²)^1.5)."""

    def check(picture: Picture) -> None:
        rows, columns = picture.alpha.shape
        x, y = pixels(columns, rows, 2, 1)
        wanted = intensity * height / (math.pi * (height**2 + x**2 + y**2) ** 1.5)
        close(picture.rgb, wanted[..., None], relative=2e-3)

    return check


def spot_to_a_right_angle(picture: Picture) -> None:
    """A cone from 0 to 90 degrees: falls off as the square of the cosine."""
    rows, columns = picture.alpha.shape
    x, y = pixels(columns, rows, 2, 1)
    square = 4 + x**2 + y**2
    close(picture.rgb, (math.pi * (4 / square) * 2 / (math.pi * square**1.5))[..., None], relative=2e-3)


def a_hair_above(picture: Picture) -> None:
    """10⁻⁶ m above the middle of one pixel: that one is lit (the point is only known to 10⁻⁸ m), and hardly another."""
    rows, columns = np.mgrid[:16, :32]
    there = (rows == 7) & (columns == 16)
    close(picture.rgb[there], 1, relative=0.1)
    close(picture.rgb[~there], 0)


def light_in_a_box() -> bytes:
    """A closed box round the light, before a plane: outside there is no light."""
    glb = Glb()
    shape = box((1, 1, 1), (0, 0, 1))
    primitives = [
        glb.primitive(Shape(shape.positions, shape.triangles), matte()(glb)),
        glb.primitive(facing_z(4.5, 2.5), matte(BLUE)(glb)),
    ]
    return watched(glb, [glb.node("box", mesh=glb.mesh(primitives)), lamp(100, (0, 0, 1))(glb)])


def too_bright(picture: Picture) -> None:
    """More than a half float holds: the largest there is."""
    assert (picture.alpha == 1).all()
    assert (picture.rgb == 65504).all()


def sun(direction_turn: Any) -> Callable[[Glb], int]:
    return lambda glb: glb.light("sun", "directional", math.pi, placed={"rotation": direction_turn})


def spot(glb: Glb) -> int:
    return glb.light(
        "spot",
        "spot",
        math.pi,
        placed={"translation": (0, 0, 2), "rotation": look_at((0, 0, 2), (0, 0, 0))},
        spot={"innerConeAngle": 0, "outerConeAngle": math.pi / 2},
    )


def short_range(glb: Glb) -> int:
    return glb.light("lamp", "point", 100, placed={"translation": (0, 0, 2)}, range=1e-30)


CASES = {
    "light at the camera": Case(lambda: plane(lamp(25 * math.pi, (0, 0, 5))), lit_from(5, 25 * math.pi)),
    "lights that give nothing": Case(
        lambda: plane(
            lamp(100, (0.0625, 0.0625, 0)),
            lamp(math.pi * 1e-12, (0.0625, 0.0625, -1e-6)),  # on the surface; a hair below it
            lamp(0, (0, 0, 2)),
            short_range,
            sun(turn((0, 1, 0), 90)),
        ),
        DARK,
    ),  # no intensity, no range, along the surface
    "light 1e-6 above": Case(lambda: plane(lamp(math.pi * 1e-12, (0.0625, 0.0625, 1e-6))), a_hair_above, TRACED),
    "light inside an object": Case(light_in_a_box, DARK),
    "sixty-four lights in one place": Case(
        lambda: plane(*[lamp(25 * math.pi / 64, (0, 0, 5))] * 64), lit_from(5, 25 * math.pi)
    ),
    "light 1e7 away": Case(lambda: plane(lamp(math.pi * 1e14, (0, 0, 1e7))), everywhere(WHITE, relative=2e-3)),
    "cone of a right angle": Case(lambda: plane(spot), spot_to_a_right_angle),
    "intensity 1e30": Case(lambda: plane(lamp(1e30, (0, 0, 2))), too_bright),
}
