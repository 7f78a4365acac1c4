# SPDX-License-Identifier: MIT
"""glTF 3.9.5: the back of a single-sided surface is not there, but for the shadow it throws."""

import numpy as np
import pytest

from glb import Glb
from physics import BLACK, close
from shapes import facing_z

STRATEGIES = ("bvh", "hybrid", "crsh", "rsh", "frustum", "classify", "brute", "reference")
BEHIND = (0, 1, 0, 0)  # half a turn about y
RED, GREEN = (1, 0, 0), (0, 1, 0)


def screen(path, *, double_sided=False, rotation=BEHIND, scale=None, **material):
    """A red square with its back to the camera before a green wall."""
    glb = Glb()
    red = glb.unlit("red", material.pop("base", RED), doubleSided=double_sided, **material)
    nodes = [
        glb.node("screen", (0, 0, 1), rotation, scale, mesh=glb.mesh(glb.primitive(facing_z(4, 4), red))),
        glb.node("wall", mesh=glb.mesh(glb.primitive(facing_z(8, 8), glb.unlit("green", GREEN)))),
        glb.node("camera", (0, 0, 5), camera=glb.orthographic("camera", 1, 1)),
    ]
    glb.scene(nodes)
    path.write_bytes(glb.bytes())
    return path


@pytest.mark.parametrize("primary", ["raster", "trace"])
@pytest.mark.parametrize("strategy", STRATEGIES)
def test_backs_are_passed_through(sheaf, tmp_path, strategy, primary):
    path = screen(tmp_path / "back.glb")
    for options, colour in (((), GREEN), (("--back-faces", "show"), RED), (("--opaque",), RED)):
        close(
            sheaf.render(path, "--primary", primary, *options, *BLACK, strategy=strategy, size="16x16").frame().rgb,
            colour,
        )


@pytest.mark.parametrize(
    ("how", "colour"),
    [
        ({"double_sided": True}, RED),
        ({"rotation": None}, RED),
        ({"rotation": None, "scale": (-1, 1, 1)}, RED),  # a mirrored node keeps its outside outside
        ({"scale": (1, 1, -1)}, RED),  # turned and mirrored through its plane: the front is seen
        ({"scale": (-1, 1, 1)}, GREEN),
        ({"alphaMode": "BLEND", "base": (1, 0, 0, 0.5)}, GREEN),
        ({"alphaMode": "MASK"}, GREEN),
    ],
    ids=["double-sided", "front", "mirrored front", "mirrored through", "mirrored back", "blended back", "masked back"],
)
def test_which_side_is_the_front(sheaf, tmp_path, how, colour):
    path = screen(tmp_path / "side.glb", **how)
    runs = sheaf.all(
        {"scene": path, "options": (*BLACK, *more), "size": "16x16", "strategy": strategy}
        for strategy in ("bvh", "reference")
        for more in ((), ("--primary", "trace"), ("--instances", "shared"))
    )
    for run in runs:
        close(run.frame().rgb, colour)


def test_the_drivers_rasteriser_agrees(sheaf, tmp_path):
    run = sheaf.render(screen(tmp_path / "back.glb"), *BLACK, size="16x16", env={"SHEAF_RASTER": "pipeline"})
    close(run.frame().rgb, GREEN)


def lit(path, *, double_sided):
    """A floor under a roof whose front faces the floor, lit from above, seen from above."""
    glb = Glb()
    matte = {"KHR_materials_ior": {"ior": 1}}
    floor = glb.material("floor", extensions=matte)
    roof = glb.material("roof", extensions=matte, doubleSided=double_sided)
    nodes = [
        glb.node("floor", mesh=glb.mesh(glb.primitive(facing_z(8, 8), floor))),
        glb.node("roof", (-2, 0, 1), BEHIND, mesh=glb.mesh(glb.primitive(facing_z(4, 4), roof))),
        glb.light("sun", "directional", np.pi),
        glb.node("camera", (0, 0, 5), camera=glb.orthographic("camera", 1, 1)),
    ]
    glb.scene(nodes)
    path.write_bytes(glb.bytes())
    return path


@pytest.mark.parametrize("strategy", ["bvh", "hybrid", "crsh", "reference"])
def test_backs_throw_shadows(sheaf, tmp_path, strategy):
    """Half of the floor lies in the shadow of a roof that is not seen itself."""
    rgb = (
        sheaf.render(lit(tmp_path / "roof.glb", double_sided=False), *BLACK, strategy=strategy, size="16x16")
        .frame()
        .rgb
    )
    close(rgb[:, :8], 0)
    close(rgb[:, 8:], 1, absolute=2e-3)


@pytest.mark.parametrize("strategy", ["bvh", "hybrid", "frustum", "reference"])
def test_mirrors_do_not_show_backs(sheaf, tmp_path, strategy):
    """A mirror sees a screen's back, hence the wall behind it."""
    glb = Glb()
    nodes = [
        glb.node("mirror", mesh=glb.mesh(glb.primitive(facing_z(4, 4), glb.mirror("mirror")))),
        # Both face away from the mirror's side but the wall: the camera looks from between them.
        glb.node("screen", (0, 0, 2), mesh=glb.mesh(glb.primitive(facing_z(8, 8), glb.unlit("red", RED)))),
        glb.node("wall", (0, 0, 3), BEHIND, mesh=glb.mesh(glb.primitive(facing_z(8, 8), glb.unlit("green", GREEN)))),
        glb.node("camera", (0, 0, 1), camera=glb.orthographic("camera", 1, 1)),
    ]
    glb.scene(nodes)
    path = tmp_path / "mirror.glb"
    path.write_bytes(glb.bytes())
    rgb = sheaf.render(path, "--depth", 1, *BLACK, strategy=strategy, size="16x16").frame().rgb
    close(rgb, GREEN, absolute=2e-2)
    close(
        sheaf.render(path, "--depth", 1, "--back-faces", "show", *BLACK, strategy=strategy, size="16x16").frame().rgb,
        RED,
        absolute=2e-2,
    )


def test_what_hides_nothing_leaves_it_out(sheaf, tmp_path):
    def reason(path, *options):
        left = sheaf.render(path, *options, size="8x8", stats=True).stats()["left_out"]
        return {item["stage"]: item["reason"] for item in left}.get("back faces")

    assert reason(screen(tmp_path / "one.glb")) is None
    assert reason(screen(tmp_path / "one.glb"), "--back-faces", "show") == "--back-faces show"
    assert reason(screen(tmp_path / "one.glb"), "--opaque") == "--opaque: every surface is two-sided"
