# SPDX-License-Identifier: MIT
"""The shadow terminator on coarse smooth meshes: lit as far as the vertex normals face the light, and nowhere else."""

from copy import deepcopy

import numpy as np
import pytest

from glb import Glb
from physics import BLACK, close, dot, reflected, unit
from shapes import Shape, box, facing_z, look_at, smooth_normals

BOTH = ("bvh", "reference")
LIGHT = unit((0.7, 0.4, 0.2))  # towards it
STRENGTH = np.pi


def ball(segments: int, tube=False) -> Shape:
    """A sphere, or a cylinder about Y without its ends, of quads with exact normals at their corners."""
    rows = max(segments // 2, 1)
    phi = np.linspace(0, 2 * np.pi, segments + 1)
    theta = np.linspace(0, np.pi, rows + 1)[:, None]
    if tube:
        normals = np.stack(np.broadcast_arrays(np.sin(phi), 0 * theta, np.cos(phi)), -1).reshape(-1, 3)
        points = normals + np.repeat(np.cos(theta), segments + 1, 1).reshape(-1, 1) * np.array((0, 1, 0))
    else:
        normals = np.stack(
            np.broadcast_arrays(np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)), -1
        ).reshape(-1, 3)
        points = normals
    first = (np.arange(rows)[:, None] * (segments + 1) + np.arange(segments)).ravel()
    below = first + segments + 1
    faces = np.concatenate([np.stack([first, below, below + 1], 1), np.stack([first, below + 1, first + 1], 1)])
    return Shape(0.9 * points, faces, normals)


def shown(sheaf, tmp_path, glb: Glb, nodes, lamp=None, strategies=BOTH, size="64x64", extent=1.0, options=()) -> list:
    light = lamp or {"kind": "directional", "intensity": STRENGTH, "placed": {"rotation": look_at(LIGHT, (0, 0, 0))}}
    glb.scene(
        [
            *nodes,
            glb.light("lamp", **light),
            glb.node("camera", (0, 0, 9), camera=glb.orthographic("camera", extent, extent)),
        ]
    )
    path = tmp_path / "scene.glb"
    path.write_bytes(glb.bytes())
    return [
        run.frame()
        for run in sheaf.all(
            {"scene": path, "options": ("--aov", "N,P", *BLACK, *options), "strategy": s, "size": size}
            for s in strategies
        )
    ]


def check_lit_by_its_normals(picture) -> None:
    """Every pixel has the light that its shading normal gives: no teeth, and nothing brighter."""
    hit = picture.alpha == 1
    n, rgb = picture.layer("N")[hit], picture.rgb[hit]
    facing = dot(n, LIGHT)
    wanted = reflected((1, 1, 1), n, (0, 0, 1), LIGHT) * STRENGTH
    close(rgb[facing > 0.02], wanted[facing > 0.02], relative=5e-3, absolute=5e-4)
    assert rgb[facing > 0.02].min() > 0
    assert rgb[facing < -1e-3].max() == 0
    assert (rgb <= np.maximum(wanted, 0) * 1.01 + 1e-3).all()


@pytest.mark.parametrize("segments", [6, 16, 64])
@pytest.mark.parametrize("tube", [False, True])
def test_no_teeth(sheaf, tmp_path, segments, tube):
    glb = Glb()
    nodes = [glb.node("ball", mesh=glb.mesh(glb.primitive(ball(segments, tube), glb.material("matte"))))]
    for picture in shown(sheaf, tmp_path, glb, nodes):
        assert (picture.alpha == 1).sum() > 1000
        check_lit_by_its_normals(picture)


def test_no_teeth_on_a_morphed_and_scaled_ball(sheaf, tmp_path):
    """The rest shape is flat: normals and corners are those of the deformed mesh."""
    shape = ball(8)
    assert shape.normals is not None
    glb = Glb()
    flat = Shape(shape.positions * (1, 1, 0), shape.triangles, np.tile((0.0, 0, 1), (len(shape.positions), 1)))
    targets = [
        {
            "POSITION": glb.attribute(shape.positions - flat.positions, bounds=True),
            "NORMAL": glb.attribute(shape.normals - flat.normals),
        }
    ]
    primitive = glb.primitive(flat, glb.material("matte")) | {"targets": targets}
    node = glb.node("ball", scale=(0.5, 0.5, 0.5), mesh=glb.mesh(primitive, weights=[1]))
    glb.animation("still", [(node, "weights", (0, 1), [1, 1], "LINEAR")])
    for picture in shown(sheaf, tmp_path, glb, [node], extent=0.5):
        assert (picture.alpha == 1).sum() > 1000
        check_lit_by_its_normals(picture)


def test_a_lamp_nearby(sheaf, tmp_path):
    """As directional light, but from a place."""
    at = np.array((2.0, 0.5, 0.25))
    glb = Glb()
    nodes = [glb.node("ball", mesh=glb.mesh(glb.primitive(ball(6), glb.material("matte"))))]
    lamp = {"kind": "point", "intensity": 10, "placed": {"translation": tuple(at)}}
    for picture in shown(sheaf, tmp_path, glb, nodes, lamp):
        hit = picture.alpha == 1
        towards = at - picture.layer("P")[hit]
        facing = dot(picture.layer("N")[hit], unit(towards))
        wanted = (
            reflected((1, 1, 1), picture.layer("N")[hit], (0, 0, 1), towards) * (10 / dot(towards, towards))[..., None]
        )
        close(picture.rgb[hit][facing > 0.02], wanted[facing > 0.02], relative=5e-3, absolute=5e-4)


@pytest.mark.parametrize("normal", [None, (0, 0, 1), (5e-6, 0, 1)])
def test_flat_meshes_are_as_they_were(sheaf, tmp_path, normal):
    """A square that a strong light grazes from a hair behind stays black: rounded normals make no curved surface."""
    square = facing_z(4, 4)
    shape = Shape(square.positions, square.triangles, None if normal is None else np.tile(normal, (4, 1)))
    glb = Glb()
    nodes = [glb.node("square", mesh=glb.mesh(glb.primitive(shape, glb.material("matte"))))]
    lamp = {"kind": "directional", "intensity": 1e6, "placed": {"rotation": look_at((1, 0, -1e-6), (0, 0, 0))}}
    for picture in shown(sheaf, tmp_path, glb, nodes, lamp):
        assert (picture.alpha == 1).all()
        assert picture.rgb.max() == 0


def test_light_does_not_leak(sheaf, tmp_path):
    """A lamp in a closed coarse ball, or behind a thin wall with the normals of a pillow, lights nothing outside."""
    glb = Glb()
    wall = box((1.6, 1.6, 0.02))
    welded = np.unique(wall.positions, axis=0)
    faces = np.array([[np.flatnonzero((welded == wall.positions[i]).all(1))[0] for i in t] for t in wall.triangles])
    pillow = Shape(welded, faces, smooth_normals(welded, faces))
    nodes = [
        glb.node("ball", (-1, 0, 0), mesh=glb.mesh(glb.primitive(ball(6), glb.material("matte", doubleSided=True)))),
        glb.node("wall", (1, 0, 0.5), mesh=glb.mesh(glb.primitive(pillow, glb.material("pillow", doubleSided=True)))),
    ]
    for at in ((-1, 0.3, 0.2), (1.1, 0.2, 0.3)):
        lamp = {"kind": "point", "intensity": 100, "placed": {"translation": at}}
        for picture in shown(sheaf, tmp_path, deepcopy(glb), nodes, lamp, extent=2.0):
            left = picture.layer("P")[..., 0] < 0
            inside_ball = at[0] < 0
            dark = (picture.alpha == 1) & (left if inside_ball else ~left)
            assert dark.sum() > 300
            assert picture.rgb[dark].max() == 0


def test_all_strategies_alike(sheaf, tmp_path):
    """A coarse matte, a glossy and a glass ball under a sun, a lamp and surroundings: same bytes, as the reference."""
    glb = Glb()
    coarse = ball(6)
    rough_glass = {
        "KHR_materials_transmission": {"transmissionFactor": 0.7},
        "KHR_materials_volume": {"thicknessFactor": 1, "attenuationColor": [1, 0.5, 0], "attenuationDistance": 0.5},
    }
    kinds = [
        glb.material("matte"),
        glb.material("glossy", (0.8, 0.5, 0.3), 0.5, 0.2),
        glb.material("glass", (1, 1, 1), 0, 0.3, rough_glass),
    ]
    nodes = [
        glb.node("ball", (2 * k - 2, 0, 0), mesh=glb.mesh(glb.primitive(coarse, material)))
        for k, material in enumerate(kinds)
    ]
    nodes.append(glb.node("floor", mesh=glb.mesh(glb.primitive(facing_z(8, 8, -1.2), glb.material("floor")))))
    nodes.append(glb.light("near", "point", 5, placed={"translation": (0.9, 1.2, 0.1)}))
    strategies = ("bvh", "hybrid", "crsh", "rsh", "frustum", "classify", "brute", "reference")
    options = ("--glass-alpha", "transparent")
    first, *others, reference = shown(
        sheaf, tmp_path, glb, nodes, strategies=strategies, size="48x24", extent=3, options=options
    )
    for other in others:
        np.testing.assert_array_equal(first.rgba.view(np.uint16), other.rgba.view(np.uint16))
    apart = np.abs(first.rgb - reference.rgb).max(-1) > 0.01 * (1 + reference.rgb.max(-1))
    assert apart.mean() < 0.01
