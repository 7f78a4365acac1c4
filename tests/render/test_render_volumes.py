# SPDX-License-Identifier: MIT
"""What volumes absorb where logarithms end, and which materials are volumes: device and reference agree."""

import numpy as np
import pytest

from glb import Glb
from physics import BLACK, close
from shapes import box, facing_z, look_at

BOTH = ("bvh", "reference")
ALL = ("--cutoff", 0, "--depth", 4, *BLACK)


def volume(
    glb: Glb, thickness=1.0, colour=(1, 0, 0), distance=10.0, ior=1.0, base=(1, 1, 1, 1), unlit=False, **more
) -> int:
    extensions = {
        "KHR_materials_transmission": {"transmissionFactor": 1},
        "KHR_materials_ior": {"ior": ior},
        "KHR_materials_volume": {
            "thicknessFactor": thickness,
            "attenuationColor": list(colour),
            "attenuationDistance": distance,
        },
    }
    if unlit:
        extensions["KHR_materials_unlit"] = {}
    return glb.material("volume", base, 0, 0, extensions, **more)


def both(sheaf, tmp_path, glb: Glb, nodes, eye=(0, 0, 5), options=ALL) -> list[np.ndarray]:
    glb.scene([*nodes, glb.node("camera", eye, camera=glb.orthographic("camera", 0.25, 0.25))])
    path = tmp_path / "scene.glb"
    path.write_bytes(glb.bytes())
    return [
        run.frame().rgb
        for run in sheaf.all({"scene": path, "options": options, "strategy": s, "size": "8x8"} for s in BOTH)
    ]


@pytest.mark.parametrize("distance", [1e-6, 10.0, 1e6])
@pytest.mark.parametrize("length", [2.0**-10, 1.0])
def test_a_colour_of_zero_absorbs_all(sheaf, tmp_path, distance, length):
    """0^(t / distance) is 0 for every t above 0."""
    glb = Glb()
    slab = glb.node("slab", mesh=glb.mesh(glb.primitive(box((4, 4, length)), volume(glb, distance=distance))))
    wall = glb.node("wall", mesh=glb.mesh(glb.primitive(facing_z(8, 8, -3), glb.unlit("wall", (1, 1, 1)))))
    for rgb in both(sheaf, tmp_path, glb, [slab, wall, glb.light("none", "directional", 0)]):
        close(rgb, (1, 0, 0))


@pytest.mark.parametrize(
    ("colour", "passed"), [((1, 2.0**-60, 0.5), (1, 2.0**-6, 2.0**-0.1)), ((1e-38, 1, 1), (1.6e-4, 1, 1))]
)
def test_tiny_colours_absorb_by_their_logarithm(sheaf, tmp_path, colour, passed):
    glb = Glb()
    slab = glb.node("slab", mesh=glb.mesh(glb.primitive(box((4, 4, 1)), volume(glb, colour=colour))))
    wall = glb.node("wall", mesh=glb.mesh(glb.primitive(facing_z(8, 8, -3), glb.unlit("wall", (1, 1, 1)))))
    for rgb in both(sheaf, tmp_path, glb, [slab, wall, glb.light("none", "directional", 0)]):
        close(rgb, passed, relative=5e-3)


@pytest.mark.parametrize("lamp", ["directional", "point"])
@pytest.mark.parametrize(
    ("colour", "distance", "passed"),
    [((1, 0, 0), 1e3, (1, 0, 0)), ((1, 0.5, 0.25), 1e-6, (1, 0, 0)), ((1, 0.25, 0.5), 2.0, (1, 0.5, 2.0**-0.5))],
)
def test_shadows_of_dark_glass(sheaf, tmp_path, lamp, colour, distance, passed):
    """The light goes through one metre of it; what a volume takes from the way must not be lost in large numbers."""
    pictures = []
    for glass in (False, True):
        glb = Glb()
        nodes = [glb.node("wall", mesh=glb.mesh(glb.primitive(facing_z(8, 8, -1), glb.material("wall", (1, 1, 1)))))]
        if glass:  # beside the camera's own way
            nodes.append(
                glb.node(
                    "slab",
                    mesh=glb.mesh(
                        glb.primitive(box((1, 40, 40), (20, 0, 0)), volume(glb, colour=colour, distance=distance))
                    ),
                )
            )
        at = (1000, 0, 10)
        nodes.append(
            glb.light(
                "lamp",
                lamp,
                6e6 if lamp == "point" else 100,
                placed={"translation": at, "rotation": look_at(at, (0, 0, -1))},
            )
        )
        pictures.append(both(sheaf, tmp_path, glb, nodes))
    for clear, tinted in zip(*pictures, strict=True):
        assert clear.min() > 0.01
        oblique = np.linalg.norm((1000, 0, 11)) / 1000  # of the way through the slab
        close(tinted, clear * np.power(passed, oblique), relative=5e-3)


def test_an_unlit_material_is_no_volume(sheaf, tmp_path):
    """KHR_materials_unlit: the other extensions do not count, be the camera inside or light passing its alpha."""
    glb = Glb()
    inside = volume(glb, colour=(0.5, 0.25, 0.125), distance=0.5, unlit=True, base=(0.5, 0.5, 1, 1))
    nodes = [
        glb.node(
            "box",
            mesh=glb.mesh(
                glb.primitive(
                    box((4, 4, 4)),
                    inside,
                )
            ),
        ),
        glb.light("none", "directional", 0),
    ]
    for rgb in both(sheaf, tmp_path, glb, nodes, eye=(0, 0, 0)):
        close(rgb, (0.5, 0.5, 1))


def test_the_shadow_of_a_blended_unlit_box(sheaf, tmp_path):
    """Two faces of alpha a half let a quarter of the light through, of every colour."""
    pictures = []
    for pane in (False, True):
        glb = Glb()
        nodes = [glb.node("wall", mesh=glb.mesh(glb.primitive(facing_z(8, 8, -1), glb.material("wall", (1, 1, 1)))))]
        if pane:
            nodes.append(
                glb.node(
                    "box",
                    mesh=glb.mesh(
                        glb.primitive(
                            box((1, 40, 40), (20, 0, 0)),
                            volume(
                                glb,
                                colour=(0.5, 0.25, 0.125),
                                distance=0.5,
                                unlit=True,
                                base=(1, 1, 1, 0.5),
                                alphaMode="BLEND",
                            ),
                        )
                    ),
                )
            )
        nodes.append(glb.light("sun", "directional", 300, placed={"rotation": look_at((1, 0, 0.01), (0, 0, 0))}))
        pictures.append(both(sheaf, tmp_path, glb, nodes))
    for clear, shaded in zip(*pictures, strict=True):
        assert clear.min() > 0.01
        close(shaded, clear / 4, relative=5e-3)
