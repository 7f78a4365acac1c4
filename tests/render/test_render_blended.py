# SPDX-License-Identifier: MIT
"""Straight rays through blended surfaces: no bounces, with a bound of their own."""

import numpy as np
import pytest

from glb import Glb
from physics import BLACK, close
from shapes import facing_z

MOST = 64


def layers(path, count, alpha=0.1, wall=True):
    """`count` blue layers before a white wall."""
    glb = Glb()
    layer = glb.mesh(glb.primitive(facing_z(4, 4), glb.unlit("layer", (0, 0, 1, alpha), alphaMode="BLEND")))
    nodes = [glb.node(f"layer {k}", (0, 0, 0.01 * k), mesh=layer) for k in range(count)]
    if wall:
        nodes.append(glb.node("wall", mesh=glb.mesh(glb.primitive(facing_z(4, 4, -0.5), glb.unlit("wall", (1, 1, 1))))))
    nodes.append(glb.node("camera", (0, 0, 5), camera=glb.orthographic("camera", 1, 1)))
    glb.scene(nodes)
    path.write_bytes(glb.bytes())
    return path


@pytest.mark.parametrize("depth", [0, 1, 4])
@pytest.mark.parametrize("strategy", ["bvh", "hybrid", "crsh", "frustum", "reference"])
def test_layers_use_up_no_depth(sheaf, tmp_path, strategy, depth):
    path = layers(tmp_path / "six.glb", 6)
    picture = sheaf.render(path, "--depth", depth, *BLACK, strategy=strategy, size="16x16").frame().rgba
    close(picture, (0.9**6, 0.9**6, 1, 1), absolute=5e-4)


@pytest.mark.parametrize("strategy", ["bvh", "reference"])
def test_as_many_as_a_ray_may_go_through(sheaf, tmp_path, strategy):
    run = sheaf.render(
        layers(tmp_path / "most.glb", MOST, 0.01), "--cutoff", 0, *BLACK, strategy=strategy, size="8x8", stats=True
    )
    close(run.frame().rgba, (0.99**MOST, 0.99**MOST, 1, 1), absolute=1e-3)
    assert "64 blended" not in run.stderr
    assert run.stats()["frames"][0]["blended_stopped"] == 0


@pytest.mark.parametrize("strategy", ["bvh", "hybrid", "reference"])
def test_one_more_is_told_of(sheaf, tmp_path, strategy):
    run = sheaf.render(
        layers(tmp_path / "more.glb", MOST + 1, 0.01), "--cutoff", 0, *BLACK, strategy=strategy, size="8x8", stats=True
    )
    reached = 1 - 0.99 ** (MOST + 1)
    close(run.frame().rgba, (0, 0, reached, reached), absolute=1e-3)
    told = [line for line in run.stderr.splitlines() if "64 blended" in line]
    assert len(told) == 1
    assert f"{8 * 8} rays" in told[0]
    assert run.stats()["frames"][0]["blended_stopped"] == 8 * 8


def test_a_mirror_behind_layers_still_reflects(sheaf, tmp_path):
    """Bounces count as before: behind three layers, a mirror at depth 1 shows what it faces."""
    glb = Glb()
    layer = glb.mesh(
        glb.primitive(facing_z(4, 4), glb.unlit("layer", (0, 0, 1, 0.5), alphaMode="BLEND", doubleSided=True))
    )
    nodes = [glb.node(f"layer {k}", (0, 0, 0.1 * k), mesh=layer) for k in range(3)]
    nodes.append(glb.node("mirror", (0, 0, -1), mesh=glb.mesh(glb.primitive(facing_z(4, 4), glb.mirror("mirror")))))
    nodes.append(glb.node("camera", (0, 0, 5), camera=glb.orthographic("camera", 1, 1)))
    glb.scene(nodes)
    path = tmp_path / "mirror.glb"
    path.write_bytes(glb.bytes())
    for depth, seen in ((0, 0.0), (1, 1.0)):
        rgb = sheaf.render(path, "--depth", depth, "--environment", "0,0,0", "--cutoff", 0, size="8x8").frame().rgb
        # Back through the three layers: they are what the mirror shows.
        blue = 1 - 0.5**3
        close(rgb[..., 2], blue + seen * 0.5**3 * blue, absolute=5e-3)
        assert np.all(rgb[..., 0] < 5e-3)
