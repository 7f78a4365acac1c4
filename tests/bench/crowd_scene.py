# SPDX-License-Identifier: MIT
"""A crowd of skinned figures that walk on the spot, each out of step with the next; a mirror behind, sun and lamp."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from glb import Glb, snap
from shapes import Shape, facing_up, facing_z, smooth_normals

ROWS, COLUMNS = 8, 16
AROUND, ALONG = 12, 12  # cells of a limb's tube
EYE, TARGET, FOV = (0.0, 4.2, 11.0), (0.0, 0.6, -1.0), 45.0

# Bones: name, parent, where it begins in the rest pose (metres). A limb follows a chain of them and ends where said.
BONES = [
    ("hips", None, (0, 0.9, 0)),
    ("chest", 0, (0, 1.15, 0)),
    ("head", 1, (0, 1.5, 0)),
    ("left arm", 1, (0.2, 1.4, 0)),
    ("left forearm", 3, (0.45, 1.4, 0)),
    ("right arm", 1, (-0.2, 1.4, 0)),
    ("right forearm", 5, (-0.45, 1.4, 0)),
    ("left leg", 0, (0.1, 0.85, 0)),
    ("left shin", 7, (0.1, 0.45, 0)),
    ("right leg", 0, (-0.1, 0.85, 0)),
    ("right shin", 9, (-0.1, 0.45, 0)),
]
LIMBS = [  # bones, end, radius
    ((0, 1), (0, 1.45, 0), 0.17),
    ((2,), (0, 1.8, 0), 0.11),
    ((3, 4), (0.72, 1.4, 0), 0.05),
    ((5, 6), (-0.72, 1.4, 0), 0.05),
    ((7, 8), (0.1, 0.03, 0), 0.07),
    ((9, 10), (-0.1, 0.03, 0), 0.07),
]


def tube(
    bones: tuple[int, ...], end: tuple[float, float, float], radius: float
) -> tuple[np.ndarray, np.ndarray, list, list]:
    """Rings along a limb, pointed at both ends; with each vertex the two bones it follows, and their weights."""
    start = np.array(BONES[bones[0]][2], dtype=np.float64)
    axis = np.array(end) - start
    length = float(np.linalg.norm(axis))
    axis = axis / length
    side = np.array((0.0, 0, 1))
    other = np.cross(axis, side)
    angles = 2 * np.pi * np.arange(AROUND) / AROUND
    rings, joints, weights = [], [], []
    elbow = float(np.linalg.norm(np.array(BONES[bones[-1]][2]) - start)) if len(bones) > 1 else 0.0
    for k in range(ALONG + 1):
        way = length * k / ALONG
        wide = radius * math.sqrt(max(0.0, 1 - (2 * k / ALONG - 1) ** 6))
        rings.append(start + axis * way + wide * (np.cos(angles)[:, None] * side + np.sin(angles)[:, None] * other))
        blend = min(1.0, max(0.0, 0.5 + (way - elbow) / (4 * radius))) if len(bones) > 1 else 0.0
        joints += [(bones[0], bones[-1], 0, 0)] * AROUND
        weights += [(1 - blend, blend, 0, 0)] * AROUND
    first = (np.arange(ALONG)[:, None] * AROUND + np.arange(AROUND)).ravel()
    right = (np.arange(ALONG)[:, None] * AROUND + (np.arange(AROUND) + 1) % AROUND).ravel()
    lower = np.stack([first, right, right + AROUND], 1)
    upper = np.stack([first, right + AROUND, first + AROUND], 1)
    return np.concatenate(rings), np.stack([lower, upper], 1).reshape(-1, 3), joints, weights


def body() -> tuple[Shape, list, list]:
    """All limbs as one mesh."""
    points, faces, count = [], [], 0
    joints: list[tuple[int, ...]] = []
    weights: list[tuple[float, ...]] = []
    for limb in LIMBS:
        p, f, j, w = tube(*limb)
        points.append(p)
        faces.append(f + count)
        joints += j
        weights += w
        count += len(p)
    positions, triangles = snap(np.concatenate(points)), np.concatenate(faces)
    return Shape(positions, triangles, smooth_normals(positions, triangles)), joints, weights


def skeleton(glb: Glb, name: str) -> list[int]:
    """The bones' nodes, each under its parent."""
    nodes = []
    for bone, parent, place in BONES:
        offset = np.array(place, dtype=np.float64) - (np.array(BONES[parent][2]) if parent is not None else 0)
        nodes.append(glb.node(f"{name} {bone}", offset))
    for k, (_, parent, _) in enumerate(BONES):
        if parent is not None:
            glb.json["nodes"][nodes[parent]].setdefault("children", []).append(nodes[k])
    return nodes


def swing(axis: int, angles: Sequence[float] | np.ndarray) -> np.ndarray:
    """Quaternions about a main axis."""
    turns = np.zeros((len(angles), 4))
    turns[:, axis] = np.sin(np.asarray(angles) / 2)
    turns[:, 3] = np.cos(np.asarray(angles) / 2)
    return turns


def walk(nodes: list[int], phase: float) -> list[tuple]:
    """A step per second, of eight keys."""
    times = np.linspace(0, 1, 9)
    step = np.sin(2 * np.pi * times + phase)
    moves = {
        1: (1, 0.25 * step), 2: (0, 0.15 * step),
        3: (1, 0.3 - 0.5 * step), 4: (1, -0.5 + 0.3 * step),
        5: (1, -0.3 - 0.5 * step), 6: (1, 0.5 + 0.3 * step),
        7: (0, 0.6 * step), 8: (0, 0.5 - 0.5 * step),
        9: (0, -0.6 * step), 10: (0, 0.5 + 0.5 * step),
    }  # fmt: skip
    return [(nodes[b], "rotation", times, swing(axis, angles), "LINEAR") for b, (axis, angles) in moves.items()]


def crowd(still: bool = False) -> bytes:
    """128 figures of 1,728 triangles: 221,184 that deform, unless `still`."""
    glb = Glb()
    shape, joints, weights = body()
    attributes = {"JOINTS_0": glb.attribute(joints, "u8"), "WEIGHTS_0": glb.attribute(weights)}
    whole = glb.primitive(shape, **attributes)
    skins = [(0.8, 0.55, 0.4), (0.25, 0.35, 0.6), (0.6, 0.25, 0.25), (0.3, 0.5, 0.3)]
    materials = [glb.material(f"cloth {k}", colour, roughness=0.9) for k, colour in enumerate(skins)]
    materials += [glb.mirror("chrome", (0.9, 0.9, 0.92)), glb.glass("glass", 1.5, thickness=0)]
    meshes = [glb.mesh(whole | {"material": material}, f"figure {k}") for k, material in enumerate(materials)]
    binds = np.tile(np.eye(4), (len(BONES), 1, 1))
    binds[:, :3, 3] = -np.array([bone[2] for bone in BONES])
    roots, channels = [], []
    for k in range(ROWS * COLUMNS):
        bones = skeleton(glb, f"figure {k}")
        skin = glb.skin(bones, binds, f"figure {k}")
        mesh = meshes[4] if k % 11 == 0 else meshes[5] if k % 17 == 0 else meshes[k % 4]
        place = (1.1 * (k % COLUMNS - (COLUMNS - 1) / 2), 0, 1.2 * (k // COLUMNS - (ROWS - 1) / 2))
        roots += [glb.node(f"stand {k}", place, children=[bones[0]]), glb.node(f"skin {k}", mesh=mesh, skin=skin)]
        channels += walk(bones, 2.399 * k)
    if not still:
        glb.animation("walk", channels)
    floor = facing_up(60, 60, cells=(32, 32))
    ground = glb.mesh(glb.primitive(floor, glb.material("ground", (0.5, 0.5, 0.48))), "ground")
    wall = glb.mesh(glb.primitive(facing_z(24, 5, -6, (0, 2.5)), glb.mirror("wall", (0.9, 0.9, 0.9))), "wall")
    lamp = glb.light("lamp", "point", 900, placed={"translation": (6, 9, 6)})
    sun = glb.light("sun", "directional", 1.5, placed={"rotation": swing(0, [-1.0])[0]})
    glb.scene([*roots, glb.node("ground", mesh=ground), glb.node("wall", mesh=wall), lamp, sun], "crowd")
    return glb.bytes()
