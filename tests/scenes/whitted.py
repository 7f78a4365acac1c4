# SPDX-License-Identifier: MIT
"""Whitted's picture of 1980 (An Improved Illumination Model for Shaded Display) brought alive: a glass sphere
before a mirror sphere over a checkered floor, here with a moving light and camera, a skinned tentacle and a
morphing flower. Four seconds, the last key equal to the first."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import numpy.typing as npt

from glb import LINEAR, LINEAR_MIPMAP_LINEAR, REPEAT, Glb, snap
from png import two_colours
from shapes import Shape, facing_up, look_at, look_rotation, quaternion, smooth_normals, sphere, turn

SECONDS = 4.0
FLOOR = 60.0  # m, both ways; one check is 1 m
SKY_RADIUS = 29.0
TENTACLE = (-3.15, 0.0, -0.9)
TENTACLE_HEIGHT, JOINTS = 2.4, 5
FLOWER = (2.25, 0.0, 0.45)
AIM = (0.05, 1.12, 0.0)


def cubic_loop(times: np.ndarray, points: npt.ArrayLike) -> np.ndarray:
    """CUBICSPLINE keys through `points` with Catmull-Rom tangents, the first key repeated as the last."""
    points = np.asarray(points, dtype=np.float64)
    step = times[1] - times[0]
    ring = np.roll(points, -1, 0) - np.roll(points, 1, 0)
    keys = np.stack([ring / (2 * step), points, ring / (2 * step)], axis=1)
    return snap(np.concatenate([keys, keys[:1]]))


def hermite_loop(times: np.ndarray, keys: np.ndarray, t: float) -> np.ndarray:
    """The curve that a player makes of those keys, glTF 2.0 appendix C."""
    i = min(int(np.searchsorted(times, t, side="right")) - 1, len(times) - 2)
    d = times[i + 1] - times[i]
    s = (t - times[i]) / d
    return (
        (2 * s**3 - 3 * s**2 + 1) * keys[i, 1]
        + d * (s**3 - 2 * s**2 + s) * keys[i, 2]
        + (-2 * s**3 + 3 * s**2) * keys[i + 1, 1]
        + d * (s**3 - s**2) * keys[i + 1, 0]
    )


def floor(glb: Glb) -> int:
    checks = np.kron([[0, 1], [1, 0]], np.ones((64, 64), dtype=np.uint8))
    texture = glb.texture(
        two_colours(checks, (205, 38, 24), (250, 206, 62)), (LINEAR, LINEAR_MIPMAP_LINEAR), (REPEAT, REPEAT)
    )
    material = glb.material("checks", texture=texture, roughness=0.9)
    quad = facing_up(FLOOR, FLOOR, uv_scale=FLOOR / 2)
    return glb.node("floor", mesh=glb.mesh(glb.primitive(quad, material), "floor"))


def sky(glb: Glb) -> int:
    """An unlit ring of a dome, light at the horizon and black where it ends, 45° up: the directional light
    comes in above it. What the ring shades lies behind the camera."""
    rings, segments = np.radians([-2, 2, 6, 12, 19, 27, 36, 45]), 32
    colours = np.array(
        [
            (0.55, 0.72, 0.95),
            (0.50, 0.68, 0.94),
            (0.40, 0.60, 0.92),
            (0.26, 0.46, 0.82),
            (0.14, 0.29, 0.62),
            (0.055, 0.13, 0.34),
            (0.015, 0.04, 0.12),
            (0, 0, 0),
        ]
    )
    angles = np.arange(segments) * 2 * np.pi / segments
    points = np.array([(np.cos(e) * np.cos(a), np.sin(e), np.cos(e) * np.sin(a)) for e in rings for a in angles])
    triangles = []
    for r in range(len(rings) - 1):
        for s in range(segments):
            a, b = r * segments + s, r * segments + (s + 1) % segments
            c, d = a + segments, b + segments
            triangles += [(a, b, d), (a, d, c)]
    colour = glb.attribute(np.round(np.repeat(colours, segments, 0) * 255), "u8", normalized=True)
    shape = Shape(snap(points * SKY_RADIUS), np.array(triangles))
    material = glb.unlit("sky", (1, 1, 1))
    return glb.node("sky", mesh=glb.mesh(glb.primitive(shape, material, COLOR_0=colour), "sky"))


def tentacle_shape() -> tuple[Shape, np.ndarray]:
    """A tapering tube with a rounded tip; gives the shape and each vertex's height as a share of the whole."""
    rings, segments = 44, 24
    share = np.append(np.linspace(0, 0.92, rings - 6), 0.92 + 0.08 * np.sin(np.linspace(0, np.pi / 2, 7)[1:]))
    tip = np.sqrt(np.maximum(0, 1 - (np.maximum(share - 0.92, 0) / 0.08) ** 2))
    radius = (0.30 * (1 - share) ** 1.2 + 0.10) * tip
    angles = np.arange(segments) * 2 * np.pi / segments
    points = [
        (radius[r] * np.sin(a), 0.003 + share[r] * TENTACLE_HEIGHT, radius[r] * np.cos(a))
        for r in range(rings - 1)
        for a in angles
    ]
    points.append((0, 0.003 + TENTACLE_HEIGHT, 0))
    triangles = []
    for r in range(rings - 2):
        for s in range(segments):
            a, b = r * segments + s, r * segments + (s + 1) % segments
            triangles += [(a, b, b + segments), (a, b + segments, a + segments)]
    last = (rings - 2) * segments
    triangles += [(last + s, last + (s + 1) % segments, len(points) - 1) for s in range(segments)]
    positions, faces = snap(points), np.array(triangles)
    heights = np.append(np.repeat(share[: rings - 1], segments), 1.0)
    return Shape(positions, faces, smooth_normals(positions, faces)), heights


def skin_weights(heights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Each vertex hangs between two joints, blended by a smooth step: four places a vertex, two in use."""
    place = np.clip(heights * JOINTS - 0.5, 0, JOINTS - 1)
    lower = np.minimum(place.astype(int), JOINTS - 2)
    s = place - lower
    upper_weight = snap(s * s * (3 - 2 * s))
    joints, weights = np.zeros((len(heights), 4)), np.zeros((len(heights), 4))
    joints[:, 0], joints[:, 1] = lower, lower + 1
    weights[:, 0], weights[:, 1] = 1 - upper_weight, upper_weight
    joints[weights == 0] = 0
    return joints, weights


def tentacle(glb: Glb) -> tuple[int, list[int]]:
    shape, heights = tentacle_shape()
    joints, weights = skin_weights(heights)
    band = 0.5 + 0.5 * np.cos(heights * 2 * np.pi * 9)
    low, high = np.array((0.02, 0.30, 0.33)), np.array((0.16, 0.72, 0.52))
    colours = np.round((low + (high - low) * snap(band, 2.0**-12)[:, None]) * 255)
    material = glb.material("tentacle", roughness=0.55)
    primitive = glb.primitive(
        shape,
        material,
        COLOR_0=glb.attribute(colours, "u8", normalized=True),
        JOINTS_0=glb.attribute(joints, "u8"),
        WEIGHTS_0=glb.attribute(weights),
    )
    mesh = glb.mesh(primitive, "tentacle")
    step = TENTACLE_HEIGHT / JOINTS
    bones = [glb.node(f"joint {k}", TENTACLE if k == 0 else (0, step, 0)) for k in range(JOINTS)]
    for parent, child in itertools.pairwise(bones):
        glb.json["nodes"][parent]["children"] = [child]
    inverse = np.tile(np.eye(4), (JOINTS, 1, 1))
    inverse[:, 1, 3] = -step * np.arange(JOINTS)
    return glb.node("tentacle", mesh=mesh, skin=glb.skin(bones, inverse, "tentacle")), bones


def flower(glb: Glb) -> int:
    """A ball that becomes a five-petalled flower, then a cushion. Every shape stands on the floor, and the
    weights never sum past 1, so no blend of them sinks into it."""
    ball = sphere(10)
    d = ball.positions
    azimuth = np.arctan2(d[:, 0], d[:, 2])
    round_about = np.clip(1 - d[:, 1] ** 2, 0, 1)
    petals = 0.62 * (1 + 0.42 * round_about**1.5 * np.cos(5 * azimuth) + 0.10 * d[:, 1])
    cushion = 0.56 / (np.abs(d) ** 5).sum(axis=1) ** (1 / 5)

    def standing(radius: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        points = d * np.asarray(radius)[..., None]
        points[:, 1] += 0.003 - points[:, 1].min()
        points = snap(points)
        return points, smooth_normals(points, ball.triangles)

    rest, rest_normals = standing(np.full(len(d), 0.6))
    targets = []
    for radius in (petals, cushion):
        points, normals = standing(radius)
        targets.append(
            {"POSITION": glb.attribute(points - rest, bounds=True), "NORMAL": glb.attribute(normals - rest_normals)}
        )
    material = glb.material("flower", (0.62, 0.10, 0.42), roughness=0.5)
    primitive = glb.primitive(Shape(rest, ball.triangles, rest_normals), material) | {"targets": targets}
    mesh = glb.mesh(primitive, "flower", weights=[0, 0], extras={"targetNames": ["petals", "cushion"]})
    return glb.node("flower", FLOWER, turn((0, 1, 0), 20), mesh=mesh)


def waving(bones: list[int]) -> list[tuple[Any, ...]]:
    """Each joint sways round z and leans round x, later the higher it sits; the lowest stands still, or its
    rim would dip into the floor."""
    times = np.arange(17) * SECONDS / 16
    channels = []
    for k, bone in list(enumerate(bones))[1:]:
        phase = 2 * np.pi * times / SECONDS - 0.7 * k
        sway, lean = (7 + 5 * k) * np.sin(phase), 5 * np.cos(phase)
        keys = [quaternion(_about_z(np.radians(s)) @ _about_x(np.radians(e))) for s, e in zip(sway, lean, strict=True)]
        keys[-1] = keys[0]
        channels.append((bone, "rotation", times, keys, "LINEAR"))
    return channels


def _about_z(a: float) -> np.ndarray:
    return np.array([(np.cos(a), -np.sin(a), 0), (np.sin(a), np.cos(a), 0), (0, 0, 1)])


def _about_x(a: float) -> np.ndarray:
    return np.array([(1, 0, 0), (0, np.cos(a), -np.sin(a)), (0, np.sin(a), np.cos(a))])


def blooming(node: int) -> tuple[Any, ...]:
    """Flower, ball, cushion, ball: flat tangents, so that no weight overshoots."""
    weights = [(0, 0), (1, 0), (0.1, 0.1), (0, 1), (0, 0)]
    return node, "weights", np.arange(5.0), [[(0, 0), w, (0, 0)] for w in weights], "CUBICSPLINE"


def camera_channels(node: int) -> tuple[list[tuple[Any, ...]], np.ndarray]:
    """Translation on a smooth curve; the rotation's keys look at the spheres from that same curve."""
    times = np.arange(5) * SECONDS / 4
    keys = cubic_loop(times, [(-0.9, 2.05, 6.6), (0.1, 2.3, 6.35), (1.1, 2.1, 6.5), (0.2, 1.85, 6.8)])
    fine = np.arange(33) * SECONDS / 32
    looks = [look_at(hermite_loop(times, keys, t), AIM) for t in fine]
    return [(node, "translation", times, keys, "CUBICSPLINE"), (node, "rotation", fine, looks, "LINEAR")], keys[0, 1]


def build() -> bytes:
    glb = Glb()
    ball = sphere(15)
    glass = glb.glass("glass", 1.5, thickness=2.0, colour=(0.86, 0.97, 0.92), distance=2.0)
    mirror = glb.mirror("mirror", (0.93, 0.95, 0.98))
    glass_primitive = glb.primitive(ball, glass)
    nodes = [floor(glb), sky(glb)]
    glass_ball = glb.node("glass sphere", (-0.75, 1.62, 0.9), mesh=glb.mesh(glass_primitive, "glass sphere"))
    mirror_ball = glb.node(
        "mirror sphere",
        (0.85, 0.955, -1.25),
        scale=(0.95, 0.95, 0.95),
        mesh=glb.mesh(glass_primitive | {"material": mirror}, "mirror sphere"),
    )
    arm, bones = tentacle(glb)
    blob = flower(glb)
    key = glb.light("key", "point", 130, (1, 0.96, 0.88), {"translation": (-3.2, 5.2, 3.4)})
    sun = look_rotation((0, 0, 0), (0, -0.9, -0.44), (0, 0, 1))  # over the sky's rim, from behind the camera
    fill = glb.light("fill", "directional", 1.7, (0.85, 0.92, 1), {"rotation": quaternion(sun)})
    lens = glb.perspective("camera", np.radians(39), 16 / 9, 0.05, 200)
    eye = glb.node("camera", camera=lens)
    moves, start = camera_channels(eye)
    glb.json["nodes"][eye] |= {"translation": start.tolist(), "rotation": moves[1][3][0].tolist()}

    quarter = np.arange(5) * SECONDS / 4
    lights = cubic_loop(quarter, [(-3.2, 5.2, 3.4), (-0.6, 6.0, 4.6), (2.6, 5.2, 3.6), (0.2, 4.6, 2.4)])
    floats = cubic_loop(quarter, [(-0.75, 1.62, 0.9), (-0.66, 1.74, 0.8), (-0.75, 1.84, 0.9), (-0.84, 1.72, 1.0)])
    glb.animation(
        "whitted",
        [
            *moves,
            (glass_ball, "translation", quarter, floats, "CUBICSPLINE"),
            (key, "translation", quarter, lights, "CUBICSPLINE"),
            blooming(blob),
            *waving(bones),
        ],
    )
    glb.scene([*nodes, glass_ball, mirror_ball, bones[0], arm, blob, key, fill, eye], "whitted")
    return glb.bytes()
