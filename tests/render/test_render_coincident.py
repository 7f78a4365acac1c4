# SPDX-License-Identifier: MIT
"""Surfaces in one place: met in a fixed order, each once, whatever the file's order, the triangles or the strategy."""

import itertools

import numpy as np
import pytest

from glb import Glb
from physics import BLACK, close, fresnel
from shapes import Shape, box, facing_z, look_at

STRATEGIES = ("bvh", "hybrid", "crsh", "rsh", "frustum", "classify", "brute", "reference")
RED, BLUE, WHITE, GREEN = (1, 0, 0), (0, 0, 1), (1, 1, 1), (0, 1, 0)


def quad(diagonal: int = 0, size: float = 4.0, z: float = 0.0) -> Shape:
    """A square cut along either diagonal."""
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * size / 2
    triangles = [(0, 1, 2), (0, 2, 3)] if diagonal == 0 else [(1, 2, 3), (1, 3, 0)]
    return Shape(np.column_stack([corners, np.full(4, z)]), np.array(triangles))


def tilted() -> dict:
    """Where the camera stands for a view aslant."""
    eye = np.array((2.0, 1.0, 5.0))
    return {"translation": tuple(eye), "rotation": look_at(eye, (0, 0, 0))}


def scene(path, parts, placed=None, half=1.0, one_mesh=False):
    """`parts`: (shape, what makes its material); a node each, or one primitive each of one mesh."""
    glb = Glb()
    primitives = [glb.primitive(shape, make(glb)) for shape, make in parts]
    meshes = [glb.mesh(primitives)] if one_mesh else [glb.mesh(p) for p in primitives]
    nodes = [glb.node(f"part {k}", mesh=mesh) for k, mesh in enumerate(meshes)]
    placed = placed or {"translation": (0, 0, 5)}
    nodes.append(glb.node("camera", camera=glb.orthographic("camera", half, half), **placed))
    glb.scene(nodes)
    path.write_bytes(glb.bytes())
    return path


def blend(colour, alpha=0.5):
    return lambda glb: glb.unlit("blend", (*colour, alpha), alphaMode="BLEND", doubleSided=True)


def opaque(colour):
    return lambda glb: glb.unlit("opaque", colour, doubleSided=True)


def pictures(sheaf, paths, *options, strategies=("bvh",), size="32x32"):
    runs = sheaf.all(
        {"scene": path, "options": (*BLACK, *options), "size": size, "strategy": strategy}
        for path in paths
        for strategy in strategies
    )
    return [run.frame().rgba for run in runs]


def ordered(tmp_path, parts, **more):
    """The scene in every order of its parts, as nodes and as primitives of one mesh."""
    return [
        scene(
            tmp_path / f"{''.join(map(str, order))}{one_mesh:d}.glb",
            [parts[k] for k in order],
            one_mesh=one_mesh,
            **more,
        )
        for order in itertools.permutations(range(len(parts)))
        for one_mesh in (False, True)
    ]


@pytest.mark.parametrize("diagonals", [(0, 0), (0, 1), (1, 0)])
@pytest.mark.parametrize("placed", [None, tilted()], ids=["straight", "aslant"])
@pytest.mark.parametrize(
    ("first", "second", "wanted"),
    [
        (blend(RED), opaque(WHITE), (1, 0.5, 0.5, 1)),
        (blend(RED), blend(BLUE), (0.5, 0, 0.25, 0.75)),
        (opaque(RED), opaque(GREEN), (1, 0, 0, 1)),
        (blend(RED), blend(RED), (0.75, 0, 0, 0.75)),
    ],
    ids=["decal", "blends", "opaque", "alike"],
)
def test_two_in_one_plane(sheaf, tmp_path, first, second, wanted, placed, diagonals):
    parts = [(quad(diagonals[0]), first), (quad(diagonals[1]), second)]
    for picture in pictures(sheaf, ordered(tmp_path, parts, placed=placed)):
        close(picture, wanted, absolute=5e-4)


def test_small_decal_on_a_large_wall_from_afar(sheaf, tmp_path):
    """The wall's rounding is a thousand times the decal's; the wall's edges are out of sight."""
    eye = np.array((6.0, 3.0, 12.0))
    parts = [(quad(1, 2000), opaque(WHITE)), (quad(0, 2), blend(RED))]
    placed = {"translation": tuple(eye), "rotation": look_at(eye, (0, 0, 0))}
    for picture in pictures(sheaf, ordered(tmp_path, parts, placed=placed, half=0.5)):
        close(picture, (1, 0.5, 0.5, 1), absolute=5e-4)


def test_a_place_turned_and_far_from_the_middle(sheaf, tmp_path):
    """Planes that no axis runs along, moved by different nodes: corners of the two differ by rounding."""

    def turned(order):
        glb = Glb()
        axis = np.array((3.0, -2.0, 1.0)) / np.sqrt(14)
        turn = (*(axis * np.sin(0.4)), np.cos(0.4))
        parts = [(quad(0, 3), blend(RED)), (quad(1, 5), opaque(WHITE))]
        meshes = [glb.mesh(glb.primitive(shape, make(glb))) for shape, make in parts]
        nodes = [glb.node("first", (7.3, -4.1, 2.9), turn, mesh=meshes[0])]
        # The same plane by two nodes and a scale.
        inner = glb.node("inner", (0, 0, 0), turn, (0.7, 0.7, 0.7), mesh=meshes[1])
        nodes.append(glb.node("outer", (7.3, -4.1, 2.9), children=[inner]))
        nodes = [nodes[k] for k in order]
        eye = np.array((7.3, -4.1, 2.9)) + np.array((1, 2, 6))
        nodes.append(
            glb.node("camera", tuple(eye), look_at(eye, (7.3, -4.1, 2.9)), camera=glb.orthographic("camera", 0.5, 0.5))
        )
        glb.scene(nodes)
        path = tmp_path / f"turned{order[0]}.glb"
        path.write_bytes(glb.bytes())
        return path

    for picture in pictures(sheaf, [turned((0, 1)), turned((1, 0))], strategies=("bvh", "hybrid", "reference")):
        close(picture, (1, 0.5, 0.5, 1), absolute=5e-4)


def test_many_in_one_place(sheaf, tmp_path):
    """Three blended quads over a wall, cut either way: each is met once, in the order of their colours."""
    parts = [(quad(0), blend(RED)), (quad(1), blend(GREEN)), (quad(0), blend(BLUE)), (quad(1), opaque(WHITE))]
    wanted = np.array((0.5, 0, 0)) + np.array((0, 0.25, 0)) + np.array((0, 0, 0.125)) + 0.125
    for picture in pictures(sheaf, ordered(tmp_path, parts, placed=tilted())[::7], strategies=("bvh", "reference")):
        close(picture, (*wanted, 1), absolute=5e-4)


@pytest.mark.parametrize("primary", ["raster", "trace"])
def test_every_strategy_agrees_on_a_decal(sheaf, tmp_path, primary):
    path = scene(
        tmp_path / "decal.glb",
        [(quad(0, 1), blend(RED)), (quad(1, 3), opaque(GREEN)), (quad(1, 1.5), blend(BLUE, 0.25))],
        placed=tilted(),
    )
    found = pictures(sheaf, [path], "--primary", primary, strategies=STRATEGIES, size="48x48")
    for strategy, picture in zip(STRATEGIES, found, strict=True):
        if strategy == "reference":
            away = np.abs(picture.astype(float) - found[0]).max(-1) > 2e-3
            assert away.mean() < 0.02, "edges aside"
        else:
            assert np.array_equal(picture.view(np.uint16), found[0].view(np.uint16)), strategy
    assert len(np.unique(found[0].reshape(-1, 4), axis=0)) == 3


def test_the_drivers_rasteriser_keeps_the_order(sheaf, tmp_path):
    paths = ordered(tmp_path, [(quad(0), opaque(RED)), (quad(1), opaque(GREEN))], placed=tilted())
    runs = sheaf.all(
        {"scene": path, "options": BLACK, "size": "32x32", "env": {"SHEAF_RASTER": "pipeline"}} for path in paths
    )
    for run in runs:
        close(run.frame().rgba, (1, 0, 0, 1))


def glass(ior):
    return lambda glb: glb.glass("glass", ior)


def test_touching_volumes_are_both_crossed(sheaf, tmp_path):
    """Out of glass and into water in one place: four faces, and on to the wall."""
    parts = [
        (box((4, 4, 1), (0, 0, 0.5)), glass(1.5)),
        (box((4, 4, 1), (0, 0, -0.5)), glass(1.33)),
        (facing_z(8, 8, -3), opaque(WHITE)),
    ]
    passed = (1 - float(fresnel(1.0, 1.0, 1.5))) ** 2 * (1 - float(fresnel(1.0, 1.0, 1.33))) ** 2
    paths = ordered(tmp_path, parts)
    # Depth 5: four faces and the wall; light that came back from a face is not in it.
    for picture in pictures(
        sheaf, paths[::3], "--depth", 4, "--cutoff", 0.01, strategies=("bvh", "hybrid", "reference")
    ):
        close(picture[..., :3], passed, absolute=8e-3)
    all_orders = [p.view(np.uint16) for p in pictures(sheaf, paths, "--depth", 12)]
    assert all(np.array_equal(p, all_orders[0]) for p in all_orders)


def test_a_block_of_glass_on_a_table(sheaf, tmp_path):
    """Its lower face lies in the table's: what leaves the glass meets the table, and does not go through."""
    parts = [
        (box((4, 4, 1), (0, 0, 0.5)), glass(1.5)),
        (facing_z(8, 8, 0), opaque(GREEN)),
        (facing_z(8, 8, -1), opaque(RED)),
    ]
    for placed in (None, tilted()):
        for picture in pictures(
            sheaf, ordered(tmp_path, parts, placed=placed)[::5], "--depth", 3, strategies=("bvh", "reference")
        ):
            assert picture[..., 0].max() < 3e-3
            assert picture[..., 1].min() > 0.85


def test_light_goes_through_each_face_once(sheaf, tmp_path):
    """A shadow under two touching panes that absorb: the light's way is in each what it is long."""

    def lit(touching):
        glb = Glb()
        tinted = [glb.glass(f"tinted {k}", 1.0, colour=(0.5, 0.5, 0.5), distance=1) for k in range(2)]
        # Not in the middle: no shadow ray meets the edge between two triangles of a face, where each counts.
        shapes = [box((6, 6, 0.5), (0.31, 0.87, 1.25)), box((6, 6, 0.5), (0.31, 0.87, 0.75 if touching else 0.5))]
        nodes = [
            glb.node(f"pane {k}", mesh=glb.mesh(glb.primitive(s, m)))
            for k, (s, m) in enumerate(zip(shapes, tinted, strict=True))
        ]
        matte = glb.material("matte", extensions={"KHR_materials_ior": {"ior": 1}})
        nodes.append(glb.node("floor", mesh=glb.mesh(glb.primitive(facing_z(8, 8, 0), matte))))
        nodes.append(glb.light("sun", "directional", np.pi))
        nodes.append(glb.node("camera", (0, 0, 0.1), camera=glb.orthographic("camera", 1, 1)))
        glb.scene(nodes)
        path = tmp_path / f"lit{touching:d}.glb"
        path.write_bytes(glb.bytes())
        return path

    touching, apart = pictures(sheaf, [lit(True), lit(False)], size="16x16")
    close(touching[..., :3], 0.5, absolute=2e-3)
    close(apart[..., :3], 0.5, absolute=2e-3)


def test_what_has_nothing_in_one_place_leaves_ranks_out(sheaf):
    left = {item["stage"]: item["reason"] for item in sheaf.render("whitted", stats=True).stats()["left_out"]}
    assert left["ranks"] == "no surfaces lie in one place"
    assert "coincident surfaces" in sheaf.render("coplanar", stats=True).stats()["scene"]["features"]
