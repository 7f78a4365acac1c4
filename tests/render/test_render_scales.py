# SPDX-License-Identifier: MIT
"""Normals of triangles so large or small that products of their edges leave the range of floats."""

import numpy as np
import pytest

from glb import Glb
from shapes import Shape, turn

SCALES = [1e-12, 1.0, 1e10, 1e12]
R = 0.5**0.5


def watched_from(glb: Glb, mesh: int, scale: float, **more) -> Glb:
    lens = glb.add(
        "cameras",
        {
            "type": "orthographic",
            "orthographic": {
                "xmag": float(np.float32(scale)),
                "ymag": float(np.float32(scale)),
                "znear": float(np.float32(scale / 100)),
                "zfar": float(np.float32(scale * 100)),
            },
        },
    )
    glb.scene(
        [
            glb.node("mesh", mesh=mesh, **more),
            glb.light("none", "directional", 0),
            glb.add("nodes", {"translation": [0, 0, float(np.float32(scale * 5))], "camera": lens}),
        ]
    )
    return glb


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("behind", [False, True])
def test_the_normal_of_a_tilted_square(sheaf, tmp_path, scale, behind):
    """At 45°, without vertex normals; seen from either side it faces the camera."""
    points = np.array([(-2, -2, -2), (2, -2, -2), (2, 2, 2), (-2, 2, 2)]) * scale
    faces = np.array([(0, 1, 2), (0, 2, 3)])
    glb = Glb()
    shape = Shape(points, faces[:, ::-1] if behind else faces)
    watched_from(glb, glb.mesh(glb.primitive(shape, glb.material("matte", (1, 1, 1)))), scale)
    path = tmp_path / "scene.glb"
    path.write_bytes(glb.bytes())
    for run in sheaf.all(
        {"scene": path, "options": ("--aov", "N", "--back-faces", "show"), "strategy": s, "size": "8x8"}
        for s in ("bvh", "reference")
    ):
        np.testing.assert_allclose(run.frame().layer("N"), np.broadcast_to((0, -R, R), (8, 8, 3)), atol=1e-6)


@pytest.mark.parametrize("scale", SCALES)
def test_vertex_normals_of_a_scaled_skin(sheaf, tmp_path, scale):
    """A skin whose joint scales: the normals of its vertices stay, and are not the triangle's."""
    flat = Shape(
        np.array([(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)]),
        np.array([(0, 1, 2), (0, 2, 3)]),
        np.tile((R, 0, R), (4, 1)),
    )
    glb = Glb()
    primitive = glb.primitive(
        flat,
        glb.material("matte", (1, 1, 1)),
        JOINTS_0=glb.attribute(np.zeros((4, 4)), "u8"),
        WEIGHTS_0=glb.attribute(np.tile((1, 0, 0, 0), (4, 1))),
    )
    joint = glb.add("nodes", {"scale": [float(np.float32(scale))] * 3})
    skin = glb.skin([joint], np.eye(4)[None])
    watched_from(glb, glb.mesh(primitive), scale, skin=skin)
    glb.json["scenes"][0]["nodes"].append(joint)
    glb.animation("turning", [(joint, "rotation", (0, 1), [turn((0, 0, 1), 0), turn((0, 0, 1), 90)], "LINEAR")])
    path = tmp_path / "scene.glb"
    path.write_bytes(glb.bytes())
    for run in sheaf.all(
        {"scene": path, "options": ("--aov", "N"), "strategy": s, "size": "8x8"} for s in ("bvh", "reference")
    ):
        np.testing.assert_allclose(run.frame().layer("N"), np.broadcast_to((R, 0, R), (8, 8, 3)), atol=1e-6)
