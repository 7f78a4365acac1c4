# SPDX-License-Identifier: MIT
"""Glass and mirrors where formulas divide by nothing, cancel or never end. In a furnace (the same light from
everywhere) what absorbs nothing shows that light, whatever it does to a ray: nothing may be lost or made."""

from __future__ import annotations

import math

import numpy as np

from case import BLUE, FURNACE, NO_LIGHT, RED, TRACED, WHITE, Case, everywhere, mirror, one_mesh, shows, triangles_of
from geometry_scenes import watched
from glb import Glb
from rendering import Picture
from shapes import Shape, box, facing_z, joined

CLOSE = {"relative": 2e-3}


def glass_boxes(*boxes: tuple[float, tuple, tuple]) -> bytes:
    """Closed boxes of glass: (index, size, centre)."""
    glb = Glb()
    nodes = []
    for k, (ior, size, centre) in enumerate(boxes):
        shape = box(size, centre)
        material = glb.material(
            f"glass {k}",
            WHITE,
            0,
            0,
            {
                "KHR_materials_transmission": {"transmissionFactor": 1},
                "KHR_materials_ior": {"ior": ior},
                "KHR_materials_volume": {"thicknessFactor": 1},
            },
        )
        primitive = glb.primitive(Shape(shape.positions, shape.triangles, shape.normals), material)
        nodes.append(glb.node(f"box {k}", mesh=glb.mesh(primitive)))
    return watched(glb, nodes)


def wedge(beyond_critical: float) -> bytes:
    """Glass of 1.5 whose far side is met, from within, at the critical angle and `beyond_critical` more."""
    slope = math.tan(math.asin(1 / 1.5) + beyond_critical)
    near, far = (
        [(x, y, 0) for x in (-3, 3) for y in (-2, 2)],
        [(x, y, -1 - slope * (x + 3)) for x in (-3, 3) for y in (-2, 2)],
    )
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    faces = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    points = np.array(near + far)
    return one_mesh(triangles_of(points[faces].reshape(-1, 3)), lambda glb: glb.glass("glass", 1.5, 1))


def inside_absorbing_glass() -> bytes:
    glb = Glb()
    shape = box((4, 4, 2))
    mesh = glb.mesh(glb.primitive(shape, glb.glass("glass", 1.5, 1, colour=(0.5, 0.25, 0.8), distance=0.5)))
    lens = glb.orthographic("camera", 1, 0.5)
    glb.scene([glb.node("box", mesh=mesh), glb.node("camera", camera=lens)], "inside")
    return glb.bytes()


def facing_mirrors() -> bytes:
    """Two mirrors that lose nothing and glow by 1/1024; the camera between them looks straight at one."""
    glb = Glb()
    shape = joined([facing_z(8, 8, -1), facing_z(8, 8, 1)])
    mesh = glb.mesh(glb.primitive(Shape(shape.positions, shape.triangles), mirror(WHITE, 2.0**-10)(glb)))
    lens = glb.orthographic("camera", 1, 0.5)
    glb.scene([glb.node("mirrors", mesh=mesh), glb.node("camera", camera=lens), NO_LIGHT(glb)], "mirrors")
    return glb.bytes()


def identical_rays() -> bytes:
    """A camera so narrow that every ray has the same origin, and the same direction: one cell holds them all."""
    glb = Glb()
    mesh = glb.mesh(
        glb.primitive(Shape(facing_z(4, 2).positions, facing_z(4, 2).triangles), mirror((0.5, 0.5, 0.5))(glb))
    )
    lens = glb.add(
        "cameras", {"type": "orthographic", "orthographic": {"xmag": 1e-30, "ymag": 1e-30, "znear": 0.01, "zfar": 9}}
    )
    glb.scene(
        [glb.node("mirror", mesh=mesh), glb.node("camera", (0.3, 0.2, 5), camera=lens), NO_LIGHT(glb)], "identical"
    )
    return glb.bytes()


def panes(count: int, alpha: float, mode: str) -> bytes:
    """Parallel panes a millimetre apart before a blue wall."""
    glb = Glb()
    pane = joined([facing_z(1, 1, -k / 1024) for k in range(count)])
    material = glb.unlit("pane", (*WHITE, alpha), alphaMode=mode)
    primitives = [
        glb.primitive(Shape(pane.positions, pane.triangles), material),
        glb.primitive(facing_z(1, 1, -2), glb.unlit("wall", BLUE)),
    ]
    return watched(glb, [glb.node("panes", mesh=glb.mesh(primitives))])


def in_one_plane(count: int) -> bytes:
    """`count` blended panes in the very same place, red: see once_to_all."""
    glb = Glb()
    pane = joined([facing_z(1, 1)] * count)
    return watched(
        glb,
        [
            glb.node(
                "panes",
                mesh=glb.mesh(
                    glb.primitive(
                        Shape(pane.positions, pane.triangles), glb.unlit("pane", (*RED, 0.5), alphaMode="BLEND")
                    )
                ),
            )
        ],
    )


def once_to_all(picture: Picture) -> None:
    """How many of the coincident panes a ray meets is free (each leaves it a rounding further on): from one to all."""
    covered = picture.alpha > 0
    assert covered.sum() == 64
    assert (picture.alpha[covered] >= 0.5).all()
    np.testing.assert_allclose(picture.rgb[covered], picture.alpha[covered][:, None] * RED, atol=1e-3)


HALF = lambda x, y: (abs(x) < 0.5) & (abs(y) < 0.5)  # noqa: E731
SLAB = (6, 4, 1)
# Every hit makes two rays: what is cut is 1 % at most.
FEW = ("--environment", "1,1,1", "--depth", 14, "--cutoff", 1e-4)
DEEP = ("--environment", "1,1,1", "--depth", 20, "--cutoff", 2e-4)  # ten faces to pass; the medium stack holds four
ENERGY, MOST_ENERGY = everywhere(WHITE, **CLOSE), everywhere(WHITE, relative=0.01)
CASES = {
    "index 1": Case(lambda: glass_boxes((1, SLAB, (0, 0, 0))), ENERGY, (*FURNACE, "--depth", 4)),
    "index 1 + 1e-6": Case(lambda: glass_boxes((1.000001, SLAB, (0, 0, 0))), ENERGY, (*FURNACE, "--depth", 4)),
    "index 10": Case(lambda: glass_boxes((10, SLAB, (0, 0, 0))), ENERGY, (*FURNACE, "--depth", 24)),
    "critical angle": Case(lambda: wedge(0), ENERGY, (*FURNACE, "--depth", 16)),
    "critical angle - 1e-7": Case(lambda: wedge(-1e-7), ENERGY, (*FURNACE, "--depth", 16)),
    "critical angle + 1e-7": Case(lambda: wedge(1e-7), ENERGY, (*FURNACE, "--depth", 16)),
    "nested five deep": Case(
        lambda: glass_boxes(*((1.2 + 0.1 * k, (6 - k / 8, 4 - k / 8, 1 - k / 8), (0, 0, 0)) for k in range(5))),
        everywhere(WHITE, relative=0.02),
        DEEP,
        size="8x4",
    ),
    "touching glass": Case(
        lambda: glass_boxes((1.5, SLAB, (0, 0, 0)), (1.33, SLAB, (0, 0, -1))), MOST_ENERGY, FEW, size="16x8"
    ),
    "overlapping glass": Case(
        lambda: glass_boxes((1.5, SLAB, (0, 0, 0)), (1.33, SLAB, (0, 0, -0.5))), MOST_ENERGY, FEW, size="16x8"
    ),
    "camera inside glass": Case(
        inside_absorbing_glass, everywhere(0.96 * np.array((0.25, 0.0625, 0.64)), **CLOSE), (*FURNACE, "--depth", 1)
    ),
    "mirrors, depth 64": Case(
        facing_mirrors,
        everywhere((65 / 1024,) * 3, relative=0, absolute=0),
        ("--back-faces", "show", "--depth", 64, "--cutoff", 0),
        size="8x4",
    ),
    "mirrors, depth 1000": Case(
        facing_mirrors,
        everywhere((1001 / 1024,) * 3, relative=0, absolute=0),
        ("--back-faces", "show", "--depth", 1000, "--cutoff", 0),
        size="8x4",
    ),
    "all rays identical": Case(
        identical_rays, everywhere((0.5, 0.5, 0.5)), (*FURNACE, *TRACED, "--sort", "on"), size="64x36"
    ),
    "forty panes, depth 8": Case(
        lambda: panes(40, 0.5, "BLEND"), shows(1 - 2.0**-40, HALF, covers=1 - 2.0**-40), ("--depth", 8, "--cutoff", 0)
    ),
    "two hundred masked panes": Case(lambda: panes(200, 0.4, "MASK"), shows(BLUE, HALF)),
    "panes in one plane": Case(lambda: in_one_plane(6), once_to_all, ("--depth", 8, "--cutoff", 0)),
}
