# SPDX-License-Identifier: MIT
"""`--aov`: layers of scenes whose geometry is known, and invariants that hold in any picture."""

import numpy as np
import pytest

from physics import box_of, close, inside, pixels, unit
from rendering import Picture, scene_path

TYPES = {
    "A": "float16",
    "B": "float16",
    "G": "float16",
    "R": "float16",
    "Z": "float32",
    "N.X": "float32",
    "N.Y": "float32",
    "N.Z": "float32",
    "P.X": "float32",
    "P.Y": "float32",
    "P.Z": "float32",
    "albedo.R": "float16",
    "albedo.G": "float16",
    "albedo.B": "float16",
    "UV.X": "float32",
    "UV.Y": "float32",
    "id.object": "uint32",
    "id.material": "uint32",
    "tests": "float32",
}


@pytest.fixture(scope="module")
def whitted(sheaf_once) -> Picture:
    return sheaf_once.render("whitted", "--aov", "all", "--frames", 31, size="96x54").frame()


def check(values, wanted, where, absolute=2e-5) -> None:
    np.testing.assert_allclose(values[where], np.broadcast_to(wanted, values.shape)[where], rtol=2e-6, atol=absolute)


def test_names_and_types(sheaf):
    picture = sheaf.render("unlit", "--aov", "all").frame()
    assert picture.types == TYPES
    some = sheaf.render("unlit", "--aov", "Z,id").frame()
    assert set(some.types) == set("RGBA") | {"Z", "id.object", "id.material"}
    none = sheaf.render("unlit").frame()
    assert set(none.types) == set("RGBA")


def test_layers_do_not_change_the_picture(sheaf):
    with_layers, without = sheaf.all(
        {"scene": "cornell", "options": options, "strategy": "hybrid"} for options in (("--aov", "all"), ())
    )
    assert np.array_equal(with_layers.frame().rgba, without.frame().rgba)


def test_a_roof(sheaf):
    """non_indexed.glb: two triangles that rise to z = 0.5 at x = 0, seen from z = 5."""
    picture = sheaf.render("non_indexed", "--aov", "all", size="96x48").frame()
    x, y = pixels(96, 48, 2, 1)
    left, sure_left = inside(x, y, [[(-1, -0.5), (0, -0.5), (0, 0.5)]])
    right, sure_right = inside(x, y, [[(0, -0.5), (1, -0.5), (0, 0.5)]])
    sure = sure_left & sure_right
    hit, miss = (left | right) & sure, ~left & ~right & sure
    z = np.where(x < 0, x + 1, 1 - x) / 2
    check(picture.layer("P"), np.stack([x, y, z], -1), hit)
    check(picture.layer("Z"), 5 - z, hit)
    check(picture.layer("N"), np.where((x < 0)[..., None], unit((-1, 0, 2)), unit((1, 0, 2))), hit)
    close(picture.layer("albedo")[hit], (0.5, 0.5, 0.5))
    assert (picture.channels["id.object"][hit] == 2).all()  # node 0 is the sun
    assert (picture.channels["id.material"][hit] == 1).all()
    assert (picture.layer("Z")[miss] == 1e10).all()  # as Blender has it
    for name in ("id.object", "id.material"):
        assert (picture.channels[name][miss] == 0).all()
    for name in ("N", "P", "albedo", "UV"):
        assert (picture.layer(name)[miss] == 0).all(), name


def test_texture_coordinates_and_textured_albedo(sheaf):
    """normalised.glb: 16-bit UVs over x, y ∈ [-1, 1], v downwards; colours times vertex colours."""
    picture = sheaf.render("normalised", "--aov", "UV,albedo,N", size="96x48").frame()
    x, y = pixels(96, 48, 2, 1)
    square, sure = inside(x, y, box_of(-1, 1, -1, 1))
    seen = square & sure
    check(picture.layer("UV"), np.stack([(x + 1) / 2, (1 - y) / 2], -1), seen)
    close(picture.layer("albedo")[seen], picture.rgb[seen])  # unlit
    check(picture.layer("N"), (0, 0, 1), seen)


def test_ids_are_nodes_and_materials(sheaf):
    """interpolation.glb: nodes 0 to 3 with materials 0 to 3; instances of a node share its id."""
    picture = sheaf.render("interpolation", "--aov", "id,albedo", size="96x48").frame()
    x, y = pixels(96, 48, 2, 1)
    for k, colour in enumerate(((1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1))):
        square, sure = inside(x, y, box_of(-0.125, 0.125, 0.625 - 0.5 * k, 0.875 - 0.5 * k))
        seen = square & sure
        assert seen.sum() > 20
        assert (picture.channels["id.object"][seen] == k + 1).all()
        assert (picture.channels["id.material"][seen] == k + 1).all()
        close(picture.layer("albedo")[seen], colour, absolute=0)
    nine = sheaf.render("instanced", "--aov", "id", size="96x48").frame()
    assert set(np.unique(nine.channels["id.object"])) == {0, 1}


def test_normals_face_the_camera(sheaf):
    """double_sided.glb shows the backs of its squares."""
    picture = sheaf.render("double_sided", "--back-faces", "show", "--aov", "N", size="96x48").frame()
    check(picture.layer("N"), (0, 0, 1), picture.alpha == 1)


def test_normal_map_is_in_the_layer(sheaf):
    picture = sheaf.render("normal_map", "--aov", "N", size="96x48").frame()
    x, y = pixels(96, 48, 2, 1)
    left, sure = inside(x, y, box_of(-1.25, -0.25, -0.5, 0.5))
    check(picture.layer("N"), unit(np.array((204, 128, 230)) / 255 * 2 - 1), left & sure, absolute=1e-3)


def test_positions_project_onto_their_pixels(whitted):
    """worldToNDC (row vectors, as OpenEXR has it) takes P to the pixel's centre, worldToCamera gives Z."""
    hit = whitted.alpha == 1
    assert hit.any()
    point = np.concatenate([whitted.layer("P"), np.ones((*hit.shape, 1))], -1)
    ndc = point @ whitted.header["worldToNDC"].astype(float)
    x, y = (np.arange(96) + 0.5) / 96, (np.arange(54) + 0.5) / 54
    np.testing.assert_allclose((ndc[..., 0] / ndc[..., 3])[hit], np.broadcast_to(x, hit.shape)[hit], atol=1e-4)
    np.testing.assert_allclose((ndc[..., 1] / ndc[..., 3])[hit], np.broadcast_to(y[:, None], hit.shape)[hit], atol=1e-4)
    depth = (point @ whitted.header["worldToCamera"].astype(float))[..., 2]
    np.testing.assert_allclose(np.abs(depth[hit]), whitted.layer("Z")[hit], rtol=1e-5)


def test_normals_are_unit_and_face_the_camera(whitted):
    hit = whitted.alpha == 1
    normals = whitted.layer("N")[hit]
    np.testing.assert_allclose(np.linalg.norm(normals, axis=-1), 1, atol=1e-5)
    to_world = np.linalg.inv(whitted.header["worldToCamera"].astype(float))
    towards = to_world[3, :3] - whitted.layer("P")[hit]
    assert (np.sum(normals * unit(towards), -1) > -0.3).mean() > 0.99  # interpolated ones may lean away at silhouettes
    assert (np.sum(normals * unit(towards), -1) > 0).mean() > 0.95


def test_tests_layer_adds_up(sheaf):
    """What pixels cost sums to the counts of the frame."""
    run = sheaf.render("cornell", "--aov", "tests", stats=True, strategy="bvh")
    tests = run.stats()["frames"][0]["tests"]
    wanted = sum(sum(tests[what].values()) for what in ("ray_box", "ray_triangle", "node_object"))
    assert run.frame().layer("tests").sum() == pytest.approx(wanted, rel=1e-3)


def test_layers_show_the_first_hit_through_nothing(sheaf):
    """alpha_mask.glb: what is masked out is not hit (sun, mask and wall are nodes 0, 1, 2); alpha_blend.glb: what is
    blended is hit."""
    mask = sheaf.render("alpha_mask", "--aov", "id,Z", size="96x48").frame()
    x, y = pixels(96, 48, 2, 1)
    top, _ = inside(x, y, box_of(-0.5, 0.5, 0.01, 0.49))
    bottom, _ = inside(x, y, box_of(-0.5, 0.5, -0.49, -0.01))
    assert (mask.channels["id.object"][top] == 3).all()
    assert (mask.channels["id.object"][bottom] == 2).all()
    check(mask.layer("Z"), 4, bottom)
    blend = sheaf.render("alpha_blend", "--aov", "id,Z", size="96x48").frame()
    red, _ = inside(x, y, box_of(-0.74, 0.24, -0.49, 0.49))
    assert (blend.channels["id.object"][red] == 1).all()
    check(blend.layer("Z"), 3, red)


def test_layers_are_of_the_first_sample(sheaf):
    """Unfiltered: depths at an edge are never in between."""
    picture = sheaf.render("unlit", "--spp", 4, "--aov", "Z,id", size="47x24").frame()
    depth = picture.layer("Z")
    np.testing.assert_allclose(depth[depth < 1e9], 5, atol=1e-5)
    assert np.array_equal(depth < 1e9, picture.channels["id.object"] != 0)
    assert ((picture.alpha > 0) & (picture.alpha < 1)).any()


@pytest.mark.parametrize("strategy", ["bvh", "reference"])
@pytest.mark.parametrize(("given", "expected"), [("inf", np.inf), ("-1", -1.0), ("1e30", np.float32(1e30)), ("0", 0.0)])
def test_depth_of_the_background_is_what_is_asked_for(sheaf, strategy, given, expected):
    usual = sheaf.render("non_indexed", "--aov", "Z,id", strategy=strategy, size="48x24").frame()
    picture = sheaf.render(
        "non_indexed", "--aov", "Z,id", f"--z-background={given}", strategy=strategy, size="48x24"
    ).frame()
    miss = picture.channels["id.object"] == 0
    assert miss.any()
    assert not miss.all()
    assert (picture.channels["Z"][miss] == expected).all()
    assert (usual.channels["Z"][miss] == 1e10).all()
    assert np.array_equal(picture.channels["Z"][~miss], usual.channels["Z"][~miss])


@pytest.mark.parametrize("given", ["nan", "far", "1e10x", "1e39", ""])
def test_depth_of_the_background_is_a_number(sheaf, given):
    run = sheaf(
        "render", scene_path("non_indexed"), "--out", sheaf.folder / "out", f"--z-background={given}", code=(2, 3)
    )
    assert "z-background" in run.stderr
