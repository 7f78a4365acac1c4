# SPDX-License-Identifier: MIT
"""Triangles too small, too large, too thin, too many, in one place, or exactly where rays go."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from case import (
    BLUE,
    FURNACE,
    NO_LIGHT,
    RED,
    TRACED,
    WHITE,
    Case,
    everywhere,
    matte,
    mirror,
    nothing,
    one_mesh,
    sane,
    shows,
    triangles_of,
    unlit,
)
from geometry_scenes import watched
from glb import Glb
from rendering import Picture
from shapes import Shape, box, facing_z, grid, joined, sphere

HALF_SQUARE = lambda x, y: (abs(x) < 0.5) & (abs(y) < 0.5)  # noqa: E731


def scaled_view(scale: float, offset: npt.ArrayLike = (0.0, 0.0, 0.0)) -> bytes:
    """A square of 1 m, everything (the camera too) scaled, then moved."""
    glb = Glb()
    offset = np.asarray(offset, float)
    mesh = glb.mesh(
        glb.primitive(Shape(facing_z(1, 1).positions * scale, facing_z(1, 1).triangles), glb.unlit("w", WHITE))
    )
    eye = offset + np.array((0, 0, 5)) * scale
    lens = glb.orthographic("camera", 2 * scale, scale, near=0.01 * scale, far=100 * scale)
    nodes = [
        {"name": "square", "mesh": mesh, "translation": offset.tolist()},
        {"name": "camera", "camera": lens, "translation": eye.tolist()},
    ]
    glb.scene([glb.add("nodes", node) for node in nodes], "scaled")  # unrounded, as 1e-6 must stay what it is
    return glb.bytes()


def tilted_at(scale: float) -> bytes:
    """A diffuse plane at 45 degrees to a sun and a camera that look the same way; without normals of its own."""
    glb = Glb()
    shape = grid((-2.25, -1.25, -2.25), (4.5, 0, 4.5), (0, 2.5, 0))
    mesh = glb.mesh(glb.primitive(Shape(shape.positions * scale, shape.triangles), matte()(glb)))
    lens = glb.add(
        "cameras",
        {
            "type": "orthographic",
            "orthographic": {"xmag": 2 * scale, "ymag": scale, "znear": 0.01 * scale, "zfar": 100 * scale},
        },
    )
    nodes = [
        glb.add("nodes", {"mesh": mesh}),
        glb.add("nodes", {"camera": lens, "translation": [0, 0, 5 * scale]}),
        glb.light("sun", "directional", math.pi),
    ]
    glb.scene(nodes, "tilted")
    return glb.bytes()


def vertical_sliver(width: float, x: float) -> bytes:
    """As high as 1.5 m, wider than nothing by `width`: rays through x meet it."""
    return one_mesh(triangles_of([(x - width / 2, -0.75, 0), (x + width / 2, -0.75, 0), (x, 0.75, 0)]), unlit())


def without_area() -> bytes:
    points = [(-1, 0, 0), (0, 0, 0), (1, 0, 0), (0.0625, 0.0625, 0), (0.5, 0.5, 0)]
    return one_mesh(triangles_of(points, [(0, 1, 2), (3, 3, 3), (3, 3, 4), (4, 3, 4), (0, 0, 0), (2, 1, 0)]), unlit())


def identical(count: int) -> bytes:
    """One red triangle under `count` blue ones in the same place: of equal distances the lowest triangle counts."""
    glb = Glb()
    shape = triangles_of([(-2, -1, 0), (6, -1, 0), (-2, 3, 0)])
    first = glb.primitive(shape, glb.unlit("red", RED))
    many = Shape(shape.positions, np.tile(shape.triangles, (count, 1)))
    return watched(glb, [glb.node("triangles", mesh=glb.mesh([first, glb.primitive(many, glb.unlit("blue", BLUE))]))])


def coincident_vertices(count: int) -> bytes:
    """`count` vertices in one point, stored by an accessor without a view (all zero), and one honest square behind."""
    glb = Glb()
    zeros = glb.add(
        "accessors",
        {"componentType": 5126, "count": count - count % 3, "type": "VEC3", "min": [0, 0, 0], "max": [0, 0, 0]},
    )
    material = glb.unlit("white", WHITE)
    dust = {"attributes": {"POSITION": zeros}, "material": material}
    square = glb.primitive(facing_z(1, 1, -1), material)
    return watched(glb, [glb.node("dust", mesh=glb.mesh([dust, square]))])


def size_ratio() -> bytes:
    """A triangle of 10⁻⁶ m before one of 1 m before one of 10⁶ m, the smallest in the way of one ray."""
    glb = Glb()
    speck = np.array([(-1, -1, 0), (1, -1, 0), (0, 1, 0)]) * 1e-6 + (0.0625, 0.0625, 1)
    large = np.array([(-1, -1, 0), (1, -1, 0), (0, 1, 0)]) * 1e6 - (0, 0, 1)
    parts: list[tuple[Any, Any]] = [(speck, RED), (facing_z(1, 1), WHITE), (large, BLUE)]
    primitives = []
    for k, (part, colour) in enumerate(parts):
        shape = part if isinstance(part, Shape) else triangles_of(part)
        primitives.append(glb.primitive(shape, glb.unlit(f"m{k}", colour)))
    return watched(glb, [glb.node("ratio", mesh=glb.mesh(primitives))])


def check_size_ratio(picture: Picture) -> None:
    rows, columns = np.mgrid[:16, :32]
    x, y = (columns + 0.5) / 8 - 2, 1 - (rows + 0.5) / 8
    wanted = np.where(HALF_SQUARE(x, y)[..., None], WHITE, BLUE)
    wanted[(x == 0.0625) & (y == 0.0625)] = RED
    np.testing.assert_array_equal(picture.rgb, wanted)
    assert (picture.alpha == 1).all()


def coplanar(perspective: bool) -> bytes:
    """Two squares in one plane, cut along different diagonals; the red one comes first."""
    glb = Glb()
    turned = facing_z(1, 1)
    turned = Shape(turned.positions, np.array([(0, 1, 2), (1, 3, 2)]))
    primitives = [glb.primitive(facing_z(1, 1), glb.unlit("red", RED)), glb.primitive(turned, glb.unlit("blue", BLUE))]
    nodes = [glb.node("squares", mesh=glb.mesh(primitives))]
    if not perspective:
        return watched(glb, nodes)
    lens = glb.perspective("camera", 0.3)
    glb.scene([*nodes, glb.node("camera", (0.1, 0.2, 3), camera=lens)], "coplanar")
    return glb.bytes()


def either_of_two(picture: Picture) -> None:
    """Where two planes are one, either may be seen, but one of them is."""
    sane(picture)
    covered = picture.alpha == 1
    assert covered.sum() > 20
    seen = picture.rgb[covered]
    assert (((seen == RED).all(1)) | ((seen == BLUE).all(1))).all()


def through_vertices(diagonal: bool) -> bytes:
    """Squares of a pixel's size whose corners are where the rays go; cut so that edges' lines, too, are met."""
    shape = facing_z(6, 3, cells=(48, 24)).moved((0.0625, 0.0625, 0))
    if diagonal:
        faces = shape.triangles.reshape(-1, 2, 3)
        a, b, c, d = faces[:, 0, 0], faces[:, 0, 1], faces[:, 0, 2], faces[:, 1, 2]
        shape = Shape(shape.positions, np.concatenate([np.stack([a, b, d], 1), np.stack([b, c, d], 1)]))
    return one_mesh(shape, unlit())


def edge_on() -> bytes:
    """Planes that contain the rays (x = 1/16, and y = 1/16 seen from the end) before a square."""
    side = triangles_of(
        [(0.0625, -1, 1), (0.0625, 1, 1), (0.0625, 0, -0.5), (-1, 0.0625, 1), (1, 0.0625, 1), (0, 0.0625, 0)]
    )
    glb = Glb()
    primitives = [
        glb.primitive(side, glb.unlit("red", RED)),
        glb.primitive(facing_z(4, 2, -1), glb.unlit("white", WHITE)),
    ]
    return watched(glb, [glb.node("edge", mesh=glb.mesh(primitives))])


def inside_a_sphere() -> bytes:
    glb = Glb()
    ball = sphere(7)
    mesh = glb.mesh(glb.primitive(Shape(ball.positions, ball.triangles), glb.unlit("white", WHITE)))
    lens = glb.perspective("camera", 2.0, near=1e-4)
    glb.scene([glb.node("ball", mesh=mesh), glb.node("camera", (0.1, -0.2, 0.3), camera=lens)], "inside")
    return glb.bytes()


def voxel_mirror() -> bytes:
    """A mirror on whole multiples of a pixel: reflected rays start in one plane, exactly on borders of any grid."""
    return one_mesh(facing_z(5, 3, cells=(40, 24)).moved((0.0625, 0.0625, 0)), mirror((0.5, 0.5, 0.5)), NO_LIGHT)


def touching_boxes() -> bytes:
    """Boxes that share faces, corners on the rays' grid: boxes of the hierarchy touch exactly where rays run."""
    boxes = [
        box((0.5, 0.5, 0.5), (x + 0.0625, y + 0.0625, -0.25 * ((i + j) % 3)))
        for i, x in enumerate(np.arange(-2.25, 2.5, 0.5))
        for j, y in enumerate(np.arange(-1.25, 1.5, 0.5))
    ]
    shape = joined(boxes)
    return one_mesh(Shape(shape.positions, shape.triangles), unlit())


def anisotropic() -> bytes:
    """A node scaled by 10⁶, 10⁻⁶ and 1 over a shape of the inverse: a square again."""
    glb = Glb()
    shape = Shape(facing_z(1, 1).positions * (1e-6, 1e6, 1), facing_z(1, 1).triangles)
    mesh = glb.mesh(glb.primitive(shape, glb.unlit("white", WHITE)))
    return watched(glb, [glb.node("square", scale=(1e6, 1e-6, 1), mesh=mesh)])


def instances_in_one_place(count: int) -> bytes:
    glb = Glb()
    mesh = glb.mesh(glb.primitive(facing_z(1, 1), glb.unlit("white", WHITE)))
    places = glb.accessor(np.zeros((count, 3)))
    extension = glb.uses("EXT_mesh_gpu_instancing", required=True)
    return watched(glb, [glb.node("heap", mesh=mesh, extensions={extension: {"attributes": {"TRANSLATION": places}}})])


def deep_nodes(depth: int) -> bytes:
    """A chain of nodes, each a quarter turn and back: nothing moved in the end."""
    glb = Glb()
    node = glb.node("square", mesh=glb.mesh(glb.primitive(facing_z(1, 1), glb.unlit("white", WHITE))))
    for k in range(depth):
        turn = (0, 0, 0.5**0.5, (0.5**0.5) * (1 if k % 2 else -1))
        node = glb.node(f"n{k}", rotation=turn, children=[node])
    return watched(glb, [node])


SQUARE = shows(WHITE, HALF_SQUARE)
TILTED = everywhere((0.5**0.5,) * 3, relative=2e-3)
CASES = {
    "scale 1e-6": Case(lambda: scaled_view(1e-6), SQUARE),
    "scale 1e6": Case(lambda: scaled_view(1e6), SQUARE),
    "scale 1e-12": Case(lambda: scaled_view(1e-12), SQUARE),
    "scale 1e12": Case(lambda: scaled_view(1e12), SQUARE),
    "1e7 from the origin": Case(lambda: scaled_view(1, (1e7, -1e7, 1e7)), SQUARE),
    "1e12 from the origin": Case(lambda: scaled_view(1, (1e12, -1e12, 1e12)), SQUARE),
    "a millimetre at 1e7": Case(lambda: scaled_view(1e-3, (1e7, -1e7, 1e7)), SQUARE),
    "tilted, scale 1e-6": Case(lambda: tilted_at(1e-6), TILTED),
    "tilted, scale 1e6": Case(lambda: tilted_at(1e6), TILTED),
    "tilted, scale 1e-12": Case(lambda: tilted_at(1e-12), TILTED),
    "tilted, scale 1e12": Case(lambda: tilted_at(1e12), TILTED),
    "sliver 1e6:1": Case(
        lambda: vertical_sliver(1.5e-6, 0.0625), shows(WHITE, lambda x, y: (x == 0.0625) & (abs(y) < 0.75)), TRACED
    ),
    "sliver 1e9:1": Case(lambda: vertical_sliver(1.5e-9, 0.0625), sane),
    "no area": Case(without_area, nothing),
    "a million identical": Case(lambda: identical(1_000_000), everywhere(RED), size="8x4"),
    "ten million coincident vertices": Case(
        lambda: coincident_vertices(10_000_000), SQUARE, size="8x4", refused={"rayquery": 5}
    ),  # a structure larger than the device's buffers
    "size ratio 1e6": Case(size_ratio, check_size_ratio, TRACED),
    "coplanar, seen straight on": Case(lambda: coplanar(False), shows(RED, HALF_SQUARE)),
    "coplanar, seen at an angle": Case(lambda: coplanar(True), either_of_two),
    "through vertices": Case(lambda: through_vertices(False), everywhere(WHITE)),
    "through vertices, other diagonal, traced": Case(lambda: through_vertices(True), everywhere(WHITE), TRACED),
    "in the plane of a triangle": Case(edge_on, everywhere(WHITE)),
    "inside a closed mesh": Case(inside_a_sphere, everywhere(WHITE), ("--spp", 8, "--back-faces", "show", *TRACED)),
    "grid on voxel borders": Case(voxel_mirror, everywhere((0.5, 0.5, 0.5)), (*FURNACE, *TRACED, "--sort", "on")),
    "touching boxes": Case(touching_boxes, everywhere(WHITE), TRACED),
    "scale 1e6 by 1e-6": Case(anisotropic, SQUARE),
    "a hundred thousand instances in one place": Case(lambda: instances_in_one_place(100_000), SQUARE, size="8x4"),
    "a thousand nodes deep": Case(lambda: deep_nodes(1000), SQUARE),
}
