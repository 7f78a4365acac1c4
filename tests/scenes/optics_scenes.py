# SPDX-License-Identifier: MIT
"""Scenes whose pictures can be computed by hand: Snell, Fresnel, Beer and Lambert. README.md tabulates the answers;
`answers()` computes them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

from geometry_scenes import watched
from glb import Glb, snap
from shapes import Shape, box, facing_up, facing_z, look_at, sphere, turn

IOR = 1.5
SLAB_COLOUR, SLAB_DISTANCE, SLAB_THICKNESS = (0.5, 0.25, 0.8), 0.5, 1.0
MATTE = {"KHR_materials_ior": {"ior": 1}}  # a purely diffuse surface: the specular lobe's weight is 0


def _object(glb: Glb, shape: Shape, material: int, name: str, **placed: Any) -> int:
    return glb.node(name, mesh=glb.mesh(glb.primitive(shape, material), name), **placed)


def _walls(glb: Glb, edge: float) -> list:
    """An unlit wall at z = -2, red left of x = edge and blue right of it."""
    red, blue = glb.unlit("red", (1, 0, 0)), glb.unlit("blue", (0, 0, 1))
    return [
        _object(glb, facing_z(8, 8, -2, (edge - 4, 0)), red, "red wall"),
        _object(glb, facing_z(8, 8, -2, (edge + 4, 0)), blue, "blue wall"),
    ]


def _slab(glb: Glb) -> int:
    glass = glb.glass("slab", IOR, SLAB_THICKNESS, colour=SLAB_COLOUR, distance=SLAB_DISTANCE)
    return _object(glb, box((6, 6, SLAB_THICKNESS)), glass, "slab")


def slab() -> bytes:
    """Parallel faces, seen at right angles: what comes through is Fresnel twice and Beer–Lambert once."""
    glb = Glb()
    white = glb.unlit("white", (1, 1, 1))
    return watched(glb, [_slab(glb), _object(glb, facing_z(8, 8, -2), white, "wall")])


def slab_oblique() -> bytes:
    """The same slab, clear, under 45°: the ray leaves parallel to itself. The wall's edge lies where the centre
    ray arrives after its shift, so that the picture changes colour exactly in the middle."""
    glb = Glb()
    glass = glb.glass("slab", IOR, SLAB_THICKNESS)
    nodes = [_object(glb, box((6, 6, SLAB_THICKNESS)), glass, "slab"), *_walls(glb, oblique_edge())]
    eye = (4 * math.sqrt(0.5), 0, 4 * math.sqrt(0.5))
    camera = glb.orthographic("camera", 0.2, 0.1)
    nodes.append(glb.node("camera", eye, turn((0, 1, 0), 45), camera=camera))
    glb.scene(nodes, "slab_oblique")
    return glb.bytes()


def oblique_edge() -> float:
    """x where the centre ray (towards the origin, 45° in the xz plane) meets z = -2."""
    inside = math.asin(math.sin(math.radians(45)) / IOR)
    half = SLAB_THICKNESS / 2
    entry = half  # x = z on the way in
    return float(snap(entry - SLAB_THICKNESS * math.tan(inside) - (2 - half)))


def prism() -> bytes:
    """A right-angled prism: in through one leg, wholly reflected by the hypotenuse (45° past the critical 41.8°),
    out through the other leg to a green wall. The red wall straight behind must not be seen."""
    glb = Glb()
    a, b, c = (-1, 1), (1, 1), (1, -1)  # (x, z): legs z = 1 (towards the camera) and x = 1, hypotenuse a-c
    quads = [[a, b], [b, c], [c, a]]
    points: list[tuple[float, float, float]] = []
    triangles: list[tuple[int, int, int]] = []
    h = 2.0
    for (x0, z0), (x1, z1) in quads:
        n = len(points)
        points += [(x0, -h, z0), (x1, -h, z1), (x1, h, z1), (x0, h, z0)]
        triangles += [(n, n + 1, n + 2), (n, n + 2, n + 3)]
    for y, order in ((-h, (a, c, b)), (h, (a, b, c))):
        n = len(points)
        points += [(x, y, z) for x, z in order]
        triangles.append((n, n + 1, n + 2))
    shape = Shape(np.array(points, dtype=float), np.array(triangles))
    glass = glb.glass("prism", IOR, 2)
    green, red = glb.unlit("green", (0, 1, 0)), glb.unlit("red", (1, 0, 0))
    wall = facing_z(8, 8)
    nodes = [
        _object(glb, shape, glass, "prism"),
        _object(glb, wall, green, "green wall", translation=(3, 0, 0), rotation=turn((0, 1, 0), -90)),
        _object(glb, wall, red, "red wall", translation=(-1.5, 0, -3)),
    ]
    return watched(glb, nodes, 0.5, 0.5)


def mirrors() -> bytes:
    """Two facing mirrors at z = ±2, a white ceiling at y = 1, a camera between them that looks up by
    atan(1/8): a ray from height y travels 8(1 - y) m along z and meets a mirror every 4 m."""
    glb = Glb()
    silver = glb.mirror("silver", (0.9, 0.8, 0.7))
    white = glb.unlit("white", (1, 1, 1))
    nodes = [
        _object(glb, facing_z(8, 8), silver, "front mirror", translation=(0, 0, -2)),
        _object(glb, facing_z(8, 8), silver, "back mirror", translation=(0, 0, 2), rotation=turn((0, 1, 0), 180)),
        _object(glb, facing_up(8, 4), white, "ceiling", translation=(0, 1, 0), rotation=turn((1, 0, 0), 180)),
    ]
    eye = glb.orthographic("camera", 1, 1, 0.001, 100)
    nodes.append(glb.node("camera", (0, -0.5, 0), look_at((0, 0, 0), (0, 1, -8)), camera=eye))
    glb.scene(nodes, "mirrors")
    return glb.bytes()


def _plane_from_above(glb: Glb, nodes: Iterable[int], half: float = 2.0) -> bytes:
    """A matte plane of albedo 1/2, seen straight from above with +X to the right."""
    plane = _object(glb, facing_up(10, 10), glb.material("matte", (0.5, 0.5, 0.5), extensions=MATTE), "plane")
    eye = glb.orthographic("camera", half, half, 0.01, 100)
    above = glb.node("camera", (0, 10, 0), look_at((0, 10, 0), (0, 0, 0), (0, 0, -1)), camera=eye)
    glb.scene([plane, *nodes, above], "plane")
    return glb.bytes()


def point_light() -> bytes:
    """4π cd at 2 m: radiance 4 / (4 + r²)^(3/2), one half straight below."""
    glb = Glb()
    return _plane_from_above(glb, [glb.light("lamp", "point", 4 * np.pi, placed={"translation": (0, 2, 0)})])


def spot_light() -> bytes:
    """The same lamp as a spot that looks down: whole inside 20°, nothing outside 30°."""
    glb = Glb()
    placed = {"translation": (0, 2, 0), "rotation": turn((1, 0, 0), -90)}
    cone = {"innerConeAngle": math.radians(20), "outerConeAngle": math.radians(30)}
    return _plane_from_above(glb, [glb.light("lamp", "spot", 4 * np.pi, placed=placed, spot=cone)])


def directional_light() -> bytes:
    """π lux from +X, 60° from straight above: radiance 1/4, and a roof at 1 m throws its shadow tan 60° to -X."""
    glb = Glb()
    sun = glb.light(
        "sun",
        "directional",
        np.pi,
        placed={"rotation": look_at((math.sin(math.pi / 3), math.cos(math.pi / 3), 0), (0, 0, 0))},
    )
    roof = _object(glb, facing_up(0.5, 0.5), glb.unlit("roof", (0, 0, 1)), "roof", translation=(1, 1, 0))
    return _plane_from_above(glb, [sun, roof])


def nested_glass() -> bytes:
    """A ball of water (ior 1.33) inside a ball of glass (1.5), both around the axis that the camera looks along."""
    glb = Glb()
    ball = sphere(8)
    glass, water = glb.glass("glass", IOR, 2), glb.glass("water", 1.33, 1)
    outer = glb.primitive(ball, glass)
    nodes = [
        glb.node("glass", mesh=glb.mesh(outer, "glass")),
        glb.node("water", scale=(0.5,) * 3, mesh=glb.mesh(outer | {"material": water}, "water")),
        _object(glb, facing_z(8, 8, -2), glb.unlit("white", (1, 1, 1)), "wall"),
    ]
    return watched(glb, nodes)


def fresnel(cos_in: float, n: float) -> float:
    """Unpolarised reflectance at an interface whose far side has index n relative to the near side."""
    sine = math.sqrt(max(0.0, 1 - cos_in**2)) / n
    if sine >= 1:
        return 1.0
    cos_out = math.sqrt(1 - sine**2)
    s = (cos_in - n * cos_out) / (cos_in + n * cos_out)
    p = (n * cos_in - cos_out) / (n * cos_in + cos_out)
    return (s * s + p * p) / 2


def answers() -> dict:
    """The numbers of README.md's table."""
    f = fresnel(1, IOR)
    clear = [c ** (SLAB_THICKNESS / SLAB_DISTANCE) for c in SLAB_COLOUR]
    cos45 = math.sqrt(0.5)
    f45 = fresnel(cos45, IOR)
    water = fresnel(1, 1.33 / IOR)
    inside = math.asin(math.sin(math.radians(45)) / IOR)
    return {
        "slab once through": [(1 - f) ** 2 * a for a in clear],
        "slab all internal reflections": [(1 - f) ** 2 * a / (1 - (f * a) ** 2) for a in clear],
        "oblique Fresnel": f45,
        "oblique once through": (1 - f45) ** 2,
        "oblique edge x": oblique_edge(),
        "oblique angle inside (degrees)": math.degrees(inside),
        "oblique lateral shift": SLAB_THICKNESS * math.sin(math.pi / 4 - inside) / math.cos(inside),
        "critical angle (degrees)": math.degrees(math.asin(1 / IOR)),
        "prism": (1 - f) ** 2,
        "nested centre": (1 - f) ** 2 * (1 - water) ** 2,
    }


SCENES = {
    f.__name__: f
    for f in (slab, slab_oblique, prism, mirrors, point_light, spot_light, directional_light, nested_glass)
}
if __name__ == "__main__":
    for name, value in answers().items():
        print(f"{name}: {value}")
