# SPDX-License-Identifier: MIT
"""Stiff, lone, opposite and overshooting keys. Frame 12 is half a second."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from case import WHITE, Case, nothing, shows
from geometry_scenes import watched
from glb import Glb
from rendering import Picture
from shapes import facing_z


def moved(*channels: Any, rest: Any = None) -> bytes:
    """A square of 1 m; channels are (path, times, values, interpolation) of its node."""
    glb = Glb()
    node = glb.node("square", **(rest or {}), mesh=glb.mesh(glb.primitive(facing_z(1, 1), glb.unlit("white", WHITE))))
    glb.animation("motion", [(node, *channel) for channel in channels])
    return watched(glb, [node])


def square_at(
    x0: float, y0: float = 0.0, half_width: float = 0.5, half_height: float = 0.5
) -> Callable[[Picture], None]:
    return shows(WHITE, lambda x, y: (abs(x - x0) < half_width) & (abs(y - y0) < half_height))


def spline(
    times: npt.ArrayLike, values: npt.ArrayLike, tangents_in: npt.ArrayLike, tangents_out: npt.ArrayLike
) -> tuple:
    return ("translation", times, np.stack([tangents_in, values, tangents_out], 1), "CUBICSPLINE")


def turned() -> bytes:
    """Three squares (of 0.5 m at x = -1, 0, 1) that turn in ways that end where they began."""
    glb = Glb()
    shape = facing_z(0.5, 0.5)
    mesh = glb.mesh(glb.primitive(shape, glb.unlit("white", WHITE)))
    nodes = [glb.node(f"square {x}", (x, 0, 0), mesh=mesh) for x in (-1, 0, 1)]
    keys = {
        "antipodal": [(0, 0, 0, 1), (0, 0, 0, -1)],  # one rotation, so none in between
        "half a turn": [(0, 0, 0, 1), (0, 0, 1, 0)],  # a quarter in between, either way
        "length 5 and 1e-3": [(0, 0, 0, 5), (0, 0, 0, 1e-3)],
    }
    glb.animation(
        "turn",
        [(node, "rotation", [0, 1], values, "LINEAR") for node, values in zip(nodes, keys.values(), strict=True)],
    )
    return watched(glb, nodes)


JUMP = ("translation", [0, 0.5, 0.5 + 1e-7, 1], [(-1, 0, 0), (-1, 0, 0), (1, 0, 0), (1, 0, 0)], "LINEAR")
ZERO = [(0, 0, 0), (0, 0, 0)]
THREE = shows(WHITE, lambda x, y: (abs(abs((abs(x) + 0.5) % 1 - 0.5)) < 0.25) & (abs(y) < 0.25) & (abs(x) < 1.25))
CASES = {
    "keys 1e-7 apart, before and long after": Case(
        lambda: moved(JUMP), {12: square_at(-1), 13: square_at(1), -5: square_at(-1), 2_000_000_000: square_at(1)}
    ),
    "a single key": Case(
        lambda: moved(("translation", [0.25], [(0.5, 0.25, 0)], "LINEAR")),
        {0: square_at(0.5, 0.25), 12: square_at(0.5, 0.25)},
    ),
    "quaternions antipodal, opposite, not of length 1": Case(turned, {12: THREE}),
    "a spline that overshoots": Case(
        lambda: moved(spline([0, 1], ZERO, [(0, 0, 0), (-8, 0, 0)], [(8, 0, 0), (0, 0, 0)])),
        {0: square_at(0), 12: square_at(2)},
    ),
    "scale through zero": Case(
        lambda: moved(("scale", [0, 1], [(1, 1, 1), (-1, -1, -1)], "LINEAR")),
        {12: nothing, 24: square_at(0)},
        ("--back-faces", "show"),
    ),  # a mirror turns its front away
}
