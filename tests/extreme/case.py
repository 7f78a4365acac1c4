# SPDX-License-Identifier: MIT
"""What an extreme case is: a scene made on the spot, how it is rendered, and the known answer for its picture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry_scenes import watched
from glb import Glb
from physics import close, pixels
from rendering import Picture
from shapes import Shape

WHITE, RED, BLUE = (1, 1, 1), (1, 0, 0), (0, 0, 1)
TRACED = ("--primary", "trace")  # the rasteriser snaps corners to a fraction of a pixel, rays do not
FURNACE = ("--environment", "1,1,1", "--cutoff", "0")  # what lets all light through, or sends it back, shows 1


@dataclass(frozen=True)
class Case:
    build: Callable[[], bytes]
    check: Callable[[Picture], None] | dict[int, Callable[[Picture], None]]  # or by frame
    options: Sequence[object] = ()
    size: str = "32x16"
    refused: dict[str, int] = field(default_factory=dict)  # strategies that may say no instead: with this exit code

    @property
    def checks(self) -> dict[int, Callable[[Picture], None]]:
        return self.check if isinstance(self.check, dict) else {0: self.check}


def triangles_of(points: npt.ArrayLike, faces: npt.ArrayLike | None = None, normals: np.ndarray | None = None) -> Shape:
    points = np.asarray(points, float).reshape(-1, 3)
    faces = np.arange(len(points)).reshape(-1, 3) if faces is None else np.asarray(faces)
    return Shape(points, faces, normals)


def one_mesh(shape: Shape, material: Callable[[Glb], int], *more_nodes: Callable[[Glb], int], **watch: Any) -> bytes:
    """A scene of one mesh before the camera that most small scenes share (x in [-2, 2], y in [-1, 1], from z = 5)."""
    glb = Glb()
    mesh = glb.mesh(glb.primitive(shape, material(glb)), "mesh")
    return watched(glb, [glb.node("mesh", mesh=mesh), *(make(glb) for make in more_nodes)], **watch)


def unlit(colour: Sequence[float] = WHITE) -> Callable[[Glb], int]:
    return lambda glb: glb.unlit("unlit", colour)


def matte(colour: Sequence[float] = WHITE) -> Callable[[Glb], int]:
    """Diffuse alone: an index of refraction of 1 reflects nothing."""
    return lambda glb: glb.material("matte", colour, extensions={"KHR_materials_ior": {"ior": 1}})


def mirror(colour: Sequence[float] = WHITE, emission: float | None = None) -> Callable[[Glb], int]:
    more: dict[str, Any] = {"emissiveFactor": [emission] * 3} if emission else {}
    return lambda glb: glb.material("mirror", colour, metallic=1, roughness=0, **more)


def lamp(intensity: float, at: Sequence[float], **more: Any) -> Callable[[Glb], int]:
    return lambda glb: glb.light("lamp", "point", intensity, placed={"translation": at}, **more)


NO_LIGHT = lamp(0, (0, 0, 1))  # a scene without lights is given one, whose glint would show


def everywhere(colour: npt.ArrayLike, **tolerance: float) -> Callable[[Picture], None]:
    """Every pixel is covered and of this colour."""

    def check(picture: Picture) -> None:
        assert (picture.alpha == 1).all(), f"{(picture.alpha != 1).sum()} pixels see past it"
        close(picture.rgb, colour, **tolerance)

    return check


def nothing(picture: Picture) -> None:
    assert not picture.rgba.any()


def shows(
    colour: npt.ArrayLike,
    where: Callable[[np.ndarray, np.ndarray], np.ndarray],
    extent: tuple[float, float] = (2.0, 1.0),
    covers: float = 1.0,
    **tolerance: float,
) -> Callable[[Picture], None]:
    """Covered and of this colour exactly where `where(x, y)` says so of a pixel's centre (in metres), else empty."""

    def check(picture: Picture) -> None:
        height, width = picture.alpha.shape
        wanted = where(*pixels(width, height, *extent))
        np.testing.assert_array_equal(picture.alpha, np.where(wanted, np.float16(covers), 0))
        close(picture.rgb[wanted], colour, **tolerance)
        assert not picture.rgb[~wanted].any()

    return check


def sane(picture: Picture) -> None:
    """Where the question has no answer: numbers, light that is not negative, coverage between 0 and 1."""
    assert np.isfinite(picture.rgba.astype(float)).all()
    assert (picture.rgb >= 0).all()
    assert ((picture.alpha >= 0) & (picture.alpha <= 1)).all()
