# SPDX-License-Identifier: MIT
"""--glass-alpha: whether the background shows through what lets light through; and what is said of rough glass."""

import numpy as np
import pytest

from glb import Glb
from physics import BLACK, close
from shapes import box, facing_z

BOTH = ("bvh", "hybrid", "reference")
LOSS = 0.96  # of a face of glass, straight on
THROUGH = ("--glass-alpha", "transparent", "--cutoff", 0, *BLACK)


def rendered(sheaf, tmp_path, glb: Glb, nodes, *options) -> list:
    glb.scene(
        [
            *nodes,
            glb.light("none", "directional", 0),
            glb.node("camera", (0, 0, 5), camera=glb.orthographic("camera", 0.25, 0.25)),
        ]
    )
    path = tmp_path / "scene.glb"
    path.write_bytes(glb.bytes())
    return [
        run.frame()
        for run in sheaf.all({"scene": path, "options": options, "strategy": s, "size": "8x8"} for s in BOTH)
    ]


def pane(glb: Glb, base=(1, 1, 1), **more) -> int:
    return glb.node("pane", mesh=glb.mesh(glb.primitive(facing_z(2, 2), glb.glass("pane", 1.5, 0, base))), **more)


def slab(glb: Glb, **more) -> int:
    return glb.node("slab", mesh=glb.mesh(glb.primitive(box((4, 4, 1)), glb.glass("slab", 1.5, 1, **more))))


def wall(glb: Glb) -> int:
    return glb.node("wall", mesh=glb.mesh(glb.primitive(facing_z(8, 8, -3), glb.unlit("wall", (0, 0, 1)))))


def test_by_default_glass_covers(sheaf, tmp_path):
    glb = Glb()
    for picture in rendered(sheaf, tmp_path, glb, [pane(glb)], "--cutoff", 0, *BLACK):
        close(picture.alpha, 1)
        assert '"glass-alpha":"opaque"' in str(picture.header)


@pytest.mark.parametrize(
    ("make", "options", "alpha"),
    [
        (lambda g: [pane(g)], (), 1 - LOSS),
        (lambda g: [pane(g, (0.5, 1, 0.25))], (), 1 - LOSS * 1.75 / 3),
        (lambda g: [pane(g), pane(g, translation=(0, 0, 1))], ("--depth", 2), 1 - LOSS**2),
        (lambda g: [slab(g)], ("--depth", 2), 1 - LOSS**2),
        (lambda g: [slab(g, colour=(0.5, 0.25, 0.75), distance=1)], ("--depth", 2), 1 - LOSS**2 * 0.5),
        (lambda g: [pane(g), wall(g)], (), 1),
        (lambda g: [pane(g)], ("--depth", 0), 1),
        (lambda g: [slab(g)], ("--depth", 1), 1),
    ],
)
def test_transparent_glass_covers_what_it_holds_back(sheaf, tmp_path, make, options, alpha):
    """Where a ray is not followed on, the surface it would leave covers all."""
    glb = Glb()
    for picture in rendered(sheaf, tmp_path, glb, make(glb), *THROUGH, *options):
        close(picture.alpha, alpha)
        assert "glass-alpha" in str(picture.header)


def test_what_is_lit_through_glass_stays_and_surroundings_do_not_hide_the_background(sheaf, tmp_path):
    glb = Glb()
    for picture in rendered(sheaf, tmp_path, glb, [pane(glb), wall(glb)], *THROUGH):
        close(picture.rgb, np.array((0, 0, LOSS)))
    glb = Glb()
    for picture in rendered(sheaf, tmp_path, glb, [pane(glb)], *THROUGH[:-2], "--environment", "1,1,1"):
        close(picture.rgb, 1 - LOSS)  # the reflection
        close(picture.alpha, 1 - LOSS)


def test_other_words_are_refused(sheaf, tmp_path):
    run = sheaf.render("thin_glass", "--glass-alpha", "half", code=2)
    assert "--glass-alpha half: must be one of opaque, transparent" in run.stderr


def test_rough_transmission_is_named(sheaf, tmp_path):
    """It is drawn clear, and said to be."""
    glb = Glb()
    transmission = {"KHR_materials_transmission": {"transmissionFactor": 1}}
    frosted = glb.material("frosted", (1, 1, 1), 0, 0.5, transmission)
    glb.scene([glb.node("a", mesh=glb.mesh(glb.primitive(facing_z(2, 2), frosted))), pane(glb)])
    path = tmp_path / "scene.glb"
    path.write_bytes(glb.bytes())
    for more, named in (((), True), (("--opaque",), False)):
        stats = sheaf.render(path, *more, size="8x8", stats=True).stats()
        left = {item["stage"]: item["reason"] for item in stats["left_out"]}
        assert ("rough transmission" in left) == named
        assert ("rough transmission" in stats["scene"]["features"]) == named
        if named:
            assert left["rough transmission"].endswith(': "frosted"')
