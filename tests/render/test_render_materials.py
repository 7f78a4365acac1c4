# SPDX-License-Identifier: MIT
"""Colours, textures and alpha: exact values at every pixel that no edge crosses."""

import json
import struct

import numpy as np
import pytest

from glb import Glb
from physics import BLACK, box_of, close, inside, pixels
from rendering import SCENES
from shapes import facing_z

EXACT = {"relative": 0, "absolute": 0}


def view(picture):
    height, width = picture.alpha.shape
    return pixels(width, height, 2, 1)


def check_regions(picture, regions, **tolerance) -> None:
    """`regions`: (x0, x1, y0, y1) in metres and the colour there, None for nothing."""
    x, y = view(picture)
    for (x0, x1, y0, y1), colour in regions:
        within, sure = inside(x, y, box_of(x0, x1, y0, y1))
        here = within & sure
        assert here.sum() >= 9, (x0, x1, y0, y1)
        if colour is None:
            assert (picture.rgba[here] == 0).all()
        else:
            close(picture.rgb[here], colour, **tolerance)
            assert (picture.alpha[here] == 1).all()


WHITE, RED, GREEN, BLUE, BLACK_ = (1, 1, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)
REGIONS = {
    "unlit": [((-1, 1, -1, 1), (0.25, 0.5, 0.75)), ((-2, -1, -1, 1), None)],
    "emissive_strength": [((-1, 1, -1, 1), (2, 1, 4))],
    "coplanar": [((-0.5, 0.5, -0.5, 0.5), RED), ((0.5, 2, -1, 1), None)],
    "interleaved": [((-0.5, 0.5, -0.5, 0.5), (1, 0.5, 0)), ((0.5, 2, -1, 1), None)],
    "sparse": [((-1, 1, -1, 1), (0, 1, 1)), ((1, 2, -1, 1), None)],
    "degenerate": [((-0.5, 0.5, -0.5, 0.5), WHITE), ((0.9, 1.6, -0.25, 0.25), None)],
    "zero_scale": [((0.75, 1.25, -0.25, 0.25), WHITE), ((-1.5, 0.5, -1, 1), None)],
    "alpha_blend": [
        ((-0.75, -0.25, -0.5, 0.5), (0.25, 0, 0.75)),
        ((-0.25, 0.25, -0.5, 0.5), (0.25, 0.375, 0.375)),
        ((0.25, 0.75, -0.5, 0.5), (0, 0.5, 0.5)),
        ((0.75, 2, -1, 1), BLUE),
    ],
    "normalised": [
        ((-1, 0, 0, 1), (0.2, 0.4, 1)),
        ((0, 1, 0, 1), (0.2, 0, 0)),
        ((-1, 0, -1, 0), (0, 0.4, 0)),
        ((0, 1, -1, 0), (0, 0, 1)),
    ],
    "uv_sets": [
        ((-2, -1, 0, 1), BLUE),
        ((-1, 0, 0, 1), RED),
        ((-2, -1, -1, 0), WHITE),
        ((-1, 0, -1, 0), GREEN),
        ((0, 1, -1, 1), BLACK_),
        ((1, 2, -1, 1), (0.5,) * 3),
    ],
}
TOLERANT = {"normalised": {"relative": 5e-4}, "alpha_blend": {"relative": 5e-4}}


@pytest.mark.parametrize("scene", REGIONS)
def test_known_colours(sheaf, scene):
    picture = sheaf.render(scene, *BLACK, size="96x48").frame()
    check_regions(picture, REGIONS[scene], **TOLERANT.get(scene, EXACT))


def test_quantised_box(sheaf):
    picture = sheaf.render("quantised", size="96x48").frame()
    check_regions(picture, [((-0.499, 0.499, -0.749, 0.749), (0.1, 0.8, 0.2))])
    x, y = view(picture)
    assert ((picture.alpha == 1) == inside(x, y, box_of(-0.5, 0.5, -0.75, 0.75))[0]).all()


def test_wrapping_and_filtering(sheaf):
    """Texels red, blue over u from -1 to 2, in squares of 0.9 m around x = -1.5, -0.5, 0.5; the fourth is linear."""
    picture = sheaf.render("samplers", *BLACK, size="120x60").frame()
    for centre, letters in ((-1.5, "RBRBRB"), (-0.5, "BRRBBR"), (0.5, "RRRBBB")):
        left = centre - 0.45
        check_regions(
            picture,
            [
                ((left + 0.15 * k, left + 0.15 * (k + 1), -0.45, 0.45), RED if c == "R" else BLUE)
                for k, c in enumerate(letters)
            ],
            **EXACT,
        )
    x, y = view(picture)
    square, sure = inside(x, y, box_of(1.05, 1.95, -0.45, 0.45))
    blue = np.clip(((x - 1.05) / 0.9) * 2 - 0.5, 0, 1)  # texel centres at u = 1/4 and 3/4
    wanted = np.stack([1 - blue, 0 * blue, blue], -1)
    close(picture.rgb[square & sure], wanted[square & sure])


def test_vertex_colours_are_barycentric(sheaf):
    picture = sheaf.render("vertex_colours", size="96x48").frame()
    x, y = view(picture)
    corners = np.array([(-1, -0.75), (1, -0.75), (0, 0.75)])
    within, sure = inside(x, y, [corners])
    weights = np.linalg.solve(np.vstack([corners.T, np.ones(3)]), np.stack([x, y, np.ones_like(x)]).reshape(3, -1))
    close(picture.rgb[within & sure], weights.T.reshape(*x.shape, 3)[within & sure])


def test_mask_and_its_shadow(sheaf):
    """Where alpha is below the cut-off there is nothing, and the sun from +X throws no shadow of it."""
    picture = sheaf.render("alpha_mask", size="96x48").frame()
    sun = picture.rgb[2, 2]
    assert sun[2] > 0.3
    check_regions(picture, [((-0.5, 0.5, -0.5, 0), RED), ((-1.5, -0.5, -0.5, 0), BLACK_)], **EXACT)
    check_regions(picture, [((-1.5, 2, 0, 0.5), sun), ((0.5, 2, -1, 1), sun), ((-2, 2, -1, -0.5), sun)])


def test_opaque_ignores_alpha_and_transmission(sheaf):
    for scene, colour in (("alpha_blend", RED), ("alpha_mask", RED)):
        picture = sheaf.render(scene, "--opaque", *BLACK, size="96x48").frame()
        check_regions(picture, [((-0.5, 0.25, -0.5, 0.5), colour)], **EXACT)
    stats = sheaf.render("slab", "--opaque", stats=True).stats()
    assert stats["frames"][0]["rays"]["refraction"] == 0
    assert "refraction" in [item["stage"] for item in stats["left_out"]]


def test_cut_offs_and_blending_agree_with_alpha(sheaf, tmp_path):
    """Alpha of 0, of 1, of more than 1 by vertex colour, and coverage of a blended surface over nothing."""
    glb = Glb()
    nodes = []
    for k, (alpha, mode) in enumerate(
        ((0.0, "BLEND"), (0.25, "BLEND"), (1.0, "BLEND"), (0.25, "OPAQUE"), (0.25, "MASK"))
    ):
        more = {"alphaMode": mode} | ({"alphaCutoff": 0.25} if mode == "MASK" else {})
        quad = glb.primitive(
            facing_z(0.5, 2, 0, (-1.75 + 0.5 * k, 0)), glb.unlit(f"m{k}", (1, 0.5, 0.25, alpha), **more)
        )
        nodes.append(glb.node(f"quad {k}", mesh=glb.mesh(quad)))
    nodes.append(glb.node("eye", (0, 0, 5), camera=glb.orthographic("camera", 2, 1)))
    glb.scene(nodes)
    path = tmp_path / "alphas.glb"
    path.write_bytes(glb.bytes())
    rgba = sheaf.render(path, *BLACK, size="64x32").frame().rgba
    wanted = [(0, 0, 0, 0), (0.25, 0.125, 0.0625, 0.25), (1, 0.5, 0.25, 1), (1, 0.5, 0.25, 1), (1, 0.5, 0.25, 1)]
    for k, colour in enumerate(wanted):  # 8 columns each
        close(rgba[:, 8 * k + 1 : 8 * k + 7], colour, absolute=0)


def still_life_moved(offset) -> bytes:
    """still_life.glb with every node moved, in all the digits of a double."""
    data = (SCENES / "still_life.glb").read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + length])
    for node in document["nodes"]:
        node["translation"] = [a + b for a, b in zip(node.get("translation", (0, 0, 0)), offset, strict=True)]
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    return (
        b"glTF"
        + struct.pack("<II", 2, 20 + len(text) + len(rest))
        + struct.pack("<I", len(text))
        + b"JSON"
        + text
        + rest
    )


def test_still_life_is_the_same_at_any_scale_and_place(sheaf, tmp_path):
    away = tmp_path / "away.glb"
    away.write_bytes(still_life_moved((1e7, -1e7, 1e7)))
    runs = sheaf.all(
        {"scene": scene, "size": "96x54"}
        for scene in ("still_life", away, "still_life_far", "still_life_tiny", "still_life_huge")
    )
    first, *others = (run.frame().rgb for run in runs)
    assert first.max() > 0.2
    for run, rgb in zip(runs[1:], others, strict=True):
        differs = (np.abs(rgb - first) > 0.01 * first + 1e-3).any(-1)
        # Silhouettes: a vertex rounds differently. The far file holds nine digits of 10⁷ m: a decimetre.
        assert differs.mean() < (0.06 if "far" in next(iter(run.files.values())).name else 0.01)
        assert abs(rgb.mean() / first.mean() - 1) < 0.01


def test_far_vertices(sheaf):
    picture = sheaf.render("far_vertices", size="96x48").frame()
    rows, columns = np.nonzero(picture.alpha)
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (12, 35, 24, 71)
    close(picture.rgb[12:36, 24:72], (1, 0.8, 0))


@pytest.mark.parametrize("scene", ["no_triangles", "empty"])
def test_nothing_to_see(sheaf, scene):
    run = sheaf.render(scene, stats=True)
    assert (run.frame().rgba == 0).all()
    if scene == "no_triangles":
        assert "warning" in run.stderr


@pytest.mark.parametrize("spp", [4, 16, 64])
def test_samples_are_one_a_stratum(sheaf, spp):
    """An upright edge through a box-filtered pixel: samples have one place in each of spp columns, so they miss its
    share by less than one of them; and each counts alike."""
    rgba = sheaf.render("unlit", "--spp", spp, "--filter", "box", size="47x24").frame().rgba.astype(float)
    aspect = 47 / 24
    edge = (1 / aspect + 1) / 2 * 47  # x = 1 in pixels from the left
    for column in range(47):
        covered = np.clip(min(column + 1, edge) - max(column, 47 - edge), 0, 1)
        assert np.abs(rgba[:, column, 3] - covered).max() < 1 / spp, column
        assert np.allclose(rgba[:, column, 3] * spp, np.round(rgba[:, column, 3] * spp))
        close(rgba[:, column, :3], np.array((0.25, 0.5, 0.75)) * rgba[:, column, 3:], absolute=0)
