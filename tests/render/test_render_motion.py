# SPDX-License-Identifier: MIT
"""Where things are: node trees, skins, morphs and the three interpolations, by silhouettes worked out by hand."""

import itertools

import numpy as np
import pytest

from glb import Glb
from physics import box_of, inside, pixels
from shapes import box

SIZE = (96, 48)


def squares(*centres, width=0.25, height=0.25) -> list:
    return [t for x, y in centres for t in box_of(x - width / 2, x + width / 2, y - height / 2, y + height / 2)]


def check(picture, triangles, xmag=2.0, ymag=1.0, colour=None) -> None:
    """Pixels whose centre lies in the triangles, and only those, show something (of `colour`)."""
    height, width = picture.alpha.shape
    x, y = pixels(width, height, xmag, ymag)
    wanted, sure = inside(x, y, triangles)
    seen = picture.alpha > 0 if colour is None else (picture.rgb == colour).all(-1)
    assert wanted.sum() >= 4, "the test sees nothing"
    wrong = np.argwhere((seen != wanted) & sure)
    assert not len(wrong), f"{len(wrong)} pixels, first (row, column) {wrong[0]}"


def turned(centre, width, height, degrees) -> list:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return [
        np.array(t) @ np.array([[c, s], [-s, c]]) + centre
        for t in box_of(-width / 2, width / 2, -height / 2, height / 2)
    ]


def test_hierarchy(sheaf):
    check(sheaf.render("hierarchy", size="192x96").frame(), box_of(0.1875, 0.3125, 0.375, 0.625))


def test_instances(sheaf):
    check(
        sheaf.render("instanced", size="96x48").frame(), squares(*((x, y) for x in (0, 0.5, 1) for y in (-0.5, 0, 0.5)))
    )


def test_strips_and_fans(sheaf):
    picture = sheaf.render("strips_fans", size="192x96").frame()
    strip = [
        [(-1.75, -0.5), (-0.75, -0.5), (-1.75, 0.5)],
        [(-0.75, -0.5), (-0.75, 0.5), (-1.75, 0.5)],
        [(-1.75, 0.5), (-0.75, 0.5), (-1.75, 0.75)],
    ]
    corners = [(0.5 * np.cos(a), 0.5 * np.sin(a)) for a in np.radians(np.arange(0, 361, 60))]
    check(picture, strip, colour=(1, 0, 0))
    check(picture, [[(0, 0), a, b] for a, b in itertools.pairwise(corners)], colour=(0, 1, 0))
    check(picture, box_of(0.75, 1.75, -0.5, 0.5), colour=(0, 0, 1))


def test_mirrored_node(sheaf):
    check(
        sheaf.render("negative_scale", size="96x48").frame(),
        box_of(0.25, 1.25, -0.5, 0.5) + box_of(-1.25, -0.25, -0.5, 0.5),
    )


def strip_of(rows) -> list:
    """Quads between pairs (left, right) of points."""
    return [t for (a, b), (c, d) in itertools.pairwise(rows) for t in ((a, b, d), (a, d, c))]


@pytest.mark.parametrize("scene", ["skin", "skin8"])
def test_skin(sheaf, scene):
    """The upper joint turns by 90° in a second about (0, 0): the middle pair follows half, linearly blended."""
    run = sheaf.render(scene, "--fps", 2, "--frames", "0-3", size="100x50")
    for frame in (0, 1, 2, 3):
        angle = np.radians(min(45 * frame, 90))
        c, s = np.cos(angle), np.sin(angle)

        def bent(x, y, c=c, s=s):
            return c * x - s * y, s * x + c * y

        rows = [[(-0.1, -1), (0.1, -1)]]
        rows.append([tuple((np.array((x, 0)) + bent(x, 0)) / 2) for x in (-0.1, 0.1)])
        rows.append([bent(x, 1) for x in (-0.1, 0.1)])
        check(run.frame(frame), strip_of(rows), 2.5, 1.25)


def test_morph(sheaf):
    """Weights (0,0), (1,0), (0.5,0.5) at 0, 1, 2 s: half way between them at the odd frames."""
    run = sheaf.render("morph", "--fps", 2, "--frames", "0-5", size="96x48")
    for frame, (wider, taller) in enumerate(((0, 0), (0.5, 0), (1, 0), (0.75, 0.25), (0.5, 0.5), (0.5, 0.5))):
        right, top = 0.5 + wider, 0.5 + 0.5 * taller
        check(run.frame(frame), box_of(-0.5, right, -0.5, top))


def test_interpolation(sheaf):
    """STEP, LINEAR, CUBICSPLINE, and a rotation that must take the short way."""
    run = sheaf.render("interpolation", "--fps", 4, "--frames", "0-8:2,9,1", size="96x48")
    assert sorted(run.files) == [0, 1, 2, 4, 6, 8, 9]
    for frame in (0, 1, 2, 4, 6, 8, 9):
        t = min(frame / 4, 2)
        k, u = (0, t) if t < 1 else (1, t - 1)
        step = (0, 1, 0)[2 if t >= 2 else k]
        linear = u if k == 0 else 1 - u
        ends, slopes = ((0, 1), (2, 0)) if k == 0 else ((1, 0), (0, 2))
        cubic = (
            (2 * u**3 - 3 * u**2 + 1) * ends[0]
            + (u**3 - 2 * u**2 + u) * slopes[0]
            + (-2 * u**3 + 3 * u**2) * ends[1]
            + (u**3 - u**2) * slopes[1]
        )
        if t >= 2:
            linear = cubic = 0
        grow = np.clip(t - 0.5, 0, 1)
        picture = run.frame(frame)
        check(picture, squares((step, 0.75)), colour=(1, 0, 0))
        check(picture, squares((linear, 0.25)), colour=(0, 1, 0))
        check(picture, squares((cubic, -0.25)), colour=(0, 0, 1))
        check(picture, turned((0, -0.75), 0.25 * (1 + grow), 0.25 * (1 - 0.5 * grow), 45 * t), colour=(1, 1, 1))


def test_stiff_keys(sheaf):
    """Keys 10⁻⁷ s apart, a lone key, quaternions that are not unit."""
    run = sheaf.render("stiff_keys", "--fps", 10, "--frames", "5,6,10", size="96x48")
    for frame, x in ((5, -1), (6, 1), (10, 1)):
        picture = run.frame(frame)
        check(picture, squares((x, 0)), colour=(1, 0, 0))
        check(picture, squares((0, 0.5)), colour=(0, 1, 0))
    check(run.frame(10), squares((0, -0.5)), colour=(0, 0, 1))


def test_scenes_and_animations(sheaf):
    """The default scene is the second; animations by name, by index, and all of them."""
    red, blue = (1, 0, 0), (0, 0, 1)
    picks = {
        (): ((0, 0.5), 0, blue),
        ("--animation", "up"): ((0, 0.5), 0, blue),
        ("--animation", "turn"): ((0, 0), 45, blue),
        ("--animation", 1): ((0, 0), 45, blue),
        ("--animation", "all"): ((0, 0.5), 45, blue),
        ("--scene-name", "red scene"): ((0, 0.5), 0, red),
        ("--scene-name", 0): ((0, 0.5), 0, red),
    }
    runs = sheaf.all(
        {"scene": "scenes_animations", "options": ("--fps", 1, "--frames", 1, *pick), "size": "96x48"} for pick in picks
    )
    for run, (centre, angle, colour) in zip(runs, picks.values(), strict=True):
        check(run.frame(1), turned(centre, 1, 1, angle), colour=colour)


def test_frames_repeat_after_a_closed_loop(sheaf):
    """whitted.glb's last key (4 s) equals its first."""
    run = sheaf.render("whitted", "--frames", "0,96", size="48x27")
    assert np.array_equal(run.frame(0).rgba, run.frame(96).rgba)


def test_cameras_by_name_and_index(sheaf):
    """Each sees the box side that faces it; a 1 m square from 4 m with tan(fov/2) = 1/4 fills half the height."""
    picks = [("front", (0, 0, 1)), ("right", (1, 0, 0)), ("top", (0, 1, 0)), (None, (0, 0, 1)), ("1", (1, 0, 0))]
    runs = sheaf.all(
        {"scene": "cameras", "options": ("--camera-node", name) if name else (), "size": "96x48"} for name, _ in picks
    )
    for run, (_, colour) in zip(runs, picks, strict=True):
        check(run.frame(), box_of(-0.5, 0.5, -0.5, 0.5), colour=colour)  # 2 m high for the flat camera too


def test_aspect_ratio_keeps_the_height(sheaf):
    for size, wide in (("48x48", 1.0), ("64x16", 4.0)):
        check(sheaf.render("unlit", size=size).frame(), box_of(-1, 1, -1, 1), xmag=wide)


def framed(pictures, least=0.9) -> None:
    """What any of the pictures shows leaves 5 % of the width and height free on each side, and fills `least` of one."""
    shown = np.logical_or.reduce([p.alpha > 0 for p in pictures])
    used = []
    for axis, size in enumerate(shown.shape):
        places = np.nonzero(shown.any(axis=1 - axis))[0]
        assert places.min() >= 0.05 * size - 1
        assert places.max() + 1 <= 0.95 * size + 1
        used.append((np.ptp(places) + 1) / size)
    assert max(used) > least - 3 / max(shown.shape)


SHAPES = ("128x72", "96x96", "72x128")


@pytest.mark.parametrize("size", SHAPES)
def test_scene_without_camera_is_framed_whole(sheaf, size):
    framed([sheaf.render("no_camera", size=size).frame()])


@pytest.mark.parametrize("size", SHAPES)
def test_the_default_camera_holds_the_whole_animation(sheaf, tmp_path, size):
    """A box jumps between two places and back, between keys that no even spacing finds; one frame alone is the same."""
    glb = Glb()
    node = glb.node("box", mesh=glb.mesh(glb.primitive(box((1, 1, 1)), glb.unlit("white", (1, 1, 1)))))
    keys = [0, 0.501, 0.503, 0.505, 0.507, 1]
    glb.animation("jump", [(node, "translation", keys, [(0, 0, 0)] * 2 + [(5, 4, -1)] * 2 + [(0, 0, 0)] * 2, "LINEAR")])
    glb.scene([node])
    scene = tmp_path / "scene.glb"
    scene.write_bytes(glb.bytes())
    run = sheaf.render(scene, "--fps", 250, "--frames", "0,126", size=size)  # 126 / 250 s = 0.504 s
    framed([run.frame(0), run.frame(126)], 0.75)  # the box of both has corners where nothing is
    alone = sheaf.render(scene, "--fps", 250, "--frames", "126", size=size)
    assert alone.files[126].read_bytes() == run.files[126].read_bytes()
