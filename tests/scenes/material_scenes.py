# SPDX-License-Identifier: MIT
"""Small scenes for textures and materials. Where no light is wanted a directional one shines from behind, so
that no default light is added."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from geometry_scenes import watched
from glb import CLAMP, LINEAR, MIRROR, NEAREST, REPEAT, Glb, snap
from png import rgba
from shapes import facing_z, look_at, turn

RED, GREEN, BLUE, WHITE = (255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 255)


def unlit_by_behind(glb: Glb) -> int:
    """A light that no surface facing +Z sees."""
    return glb.light("behind", "directional", 1, placed={"rotation": turn((0, 1, 0), 180)})


def quad_of(glb: Glb, material: int, name: str = "quad", size: float = 2.0, **placed: Any) -> int:
    textured = any(key.endswith("Texture") for key in _slots(glb.json["materials"][material]))
    shape = facing_z(size, size, uv_scale=1 if textured else None)
    return glb.node(name, mesh=glb.mesh(glb.primitive(shape, material), name), **placed)


def _slots(material: dict[str, Any]) -> list[str]:
    return list(material) + list(material["pbrMetallicRoughness"])


def uv_sets() -> bytes:
    """Colour from UV set 1 under a texture transform, nothing from set 0 but the emission."""
    glb = Glb()
    quarters = glb.texture(rgba([[RED, GREEN], [BLUE, WHITE]]))
    half = glb.texture(rgba([[(0, 0, 0), (255, 255, 255)]]))
    quad = facing_z(2, 2, uv_scale=1)
    transform = {"offset": [0, 1], "rotation": np.pi / 2, "scale": [1, 1], "texCoord": 1}
    texture = {"index": quarters, "texCoord": 0, "extensions": {glb.uses("KHR_texture_transform"): transform}}
    turned = glb.unlit("turned", (1, 1, 1), texture=texture)
    glowing = glb.material("glowing", (0, 0, 0), emissiveFactor=[0.5, 0.5, 0.5], emissiveTexture={"index": half})
    nodes = []
    for name, x, material in (("turned", -1, turned), ("glowing", 1, glowing)):
        primitive = glb.primitive(quad, material)
        if material == turned:
            primitive["attributes"]["TEXCOORD_1"] = primitive["attributes"]["TEXCOORD_0"]
            primitive["attributes"]["TEXCOORD_0"] = glb.attribute(np.full((4, 2), 0.25))
        nodes.append(glb.node(name, (x, 0, 0), mesh=glb.mesh(primitive, name)))
    return watched(glb, [*nodes, unlit_by_behind(glb)])


def samplers() -> bytes:
    """One 2×1 texture under three wrap modes, UVs from -1 to 2, and one that filters linearly."""
    glb = Glb()
    png = rgba([[RED, BLUE]])
    wide = facing_z(0.9, 0.9, uv_scale=3)
    assert wide.uvs is not None
    nodes = []
    for k, (name, wrap) in enumerate((("repeat", REPEAT), ("mirror", MIRROR), ("clamp", CLAMP), ("linear", CLAMP))):
        filters = (LINEAR, LINEAR) if name == "linear" else (NEAREST, NEAREST)
        material = glb.unlit(name, (1, 1, 1), texture=glb.texture(png, filters, (wrap, wrap)))
        uvs = wide.uvs / 3 if name == "linear" else wide.uvs - 1
        primitive = glb.primitive(replace(wide, uvs=snap(uvs)), material)
        nodes.append(glb.node(name, (k - 1.5, 0, 0), mesh=glb.mesh(primitive, name)))
    return watched(glb, nodes)


def vertex_colours() -> bytes:
    glb = Glb()
    points = [(-1, -0.75, 0), (1, -0.75, 0), (0, 0.75, 0)]
    primitive = {
        "attributes": {"POSITION": glb.attribute(points, bounds=True), "COLOR_0": glb.attribute(np.eye(3))},
        "material": glb.unlit("white", (1, 1, 1)),
    }
    return watched(glb, [glb.node("triangle", mesh=glb.mesh(primitive, "triangle"))])


def alpha_mask() -> bytes:
    """Alphas 0, 0.4, 0.6, 1 in quarters, cut at 0.5, before a blue wall; a light casts the mask's shadow on it."""
    glb = Glb()
    alphas = rgba([[(255, 255, 255, 0), (255, 255, 255, 102)], [(255, 255, 255, 153), (255, 255, 255, 255)]])
    mask = glb.unlit("mask", (1, 0, 0), texture=glb.texture(alphas), alphaMode="MASK", alphaCutoff=0.5)
    wall = glb.material("wall", (0, 0, 0.5))
    sun = glb.light("sun", "directional", 3.5, placed={"rotation": turn((0, 1, 0), 45)})
    return watched(glb, [quad_of(glb, mask, "mask", 1, translation=(0, 0, 1)), quad_of(glb, wall, "wall", 4), sun])


def alpha_blend() -> bytes:
    glb = Glb()
    red = glb.unlit("red", (1, 0, 0, 0.25), alphaMode="BLEND")
    green = glb.unlit("green", (0, 1, 0, 0.5), alphaMode="BLEND")
    blue = glb.unlit("blue", (0, 0, 1))
    return watched(
        glb,
        [
            quad_of(glb, red, "red", 1, translation=(-0.25, 0, 2)),
            quad_of(glb, green, "green", 1, translation=(0.25, 0, 1)),
            quad_of(glb, blue, "blue", 4),
        ],
    )


def unlit() -> bytes:
    glb = Glb()
    return watched(glb, [quad_of(glb, glb.unlit("unlit", (0.25, 0.5, 0.75)))])


def emissive_strength() -> bytes:
    glb = Glb()
    strong = {"KHR_materials_emissive_strength": {"emissiveStrength": 4}}
    glow = glb.material("glow", (0, 0, 0), emissiveFactor=[0.5, 0.25, 1], extensions=strong)
    return watched(glb, [quad_of(glb, glow), unlit_by_behind(glb)])


def double_sided() -> bytes:
    """Two squares turned away from the camera under a light at the camera: one double-sided, one not."""
    glb = Glb()
    away = turn((0, 1, 0), 180)
    both = glb.material("both", (0.5, 0.5, 0.5), doubleSided=True)
    one = glb.material("one", (0.5, 0.5, 0.5))
    return watched(
        glb,
        [
            quad_of(glb, both, "both", 1, translation=(-0.75, 0, 0), rotation=away),
            quad_of(glb, one, "one", 1, translation=(0.75, 0, 0), rotation=away),
            glb.light("sun", "directional", 3),
        ],
    )


def normal_map() -> bytes:
    """A flat normal map that leans 0.6 in x and 0.8 in z, without tangents: lit straight on, cos = 0.8."""
    glb = Glb()
    leaning = glb.texture(rgba([[(204, 128, 230)]]), (LINEAR, LINEAR))  # (0.6, 0.004, 0.804)
    ior = {"KHR_materials_ior": {"ior": 1}}  # no specular reflection at all at normal incidence
    leaned = glb.material("leaned", (0.5, 0.5, 0.5), extensions=ior, normalTexture={"index": leaning})
    plain = glb.material("plain", (0.5, 0.5, 0.5), extensions=ior)
    return watched(
        glb,
        [
            quad_of(glb, leaned, "leaned", 1, translation=(-0.75, 0, 0)),
            quad_of(glb, plain, "plain", 1, translation=(0.75, 0, 0)),
            glb.light("sun", "directional", np.pi),
        ],
    )


def thin_glass() -> bytes:
    """A thin green pane (no volume) before a white wall: nothing bends."""
    glb = Glb()
    pane = glb.glass("pane", 1.5, thickness=0, base=(0.5, 1, 0.5))
    white = glb.unlit("white", (1, 1, 1))
    return watched(glb, [quad_of(glb, pane, "pane", 1, translation=(0, 0, 1)), quad_of(glb, white, "wall", 4)])


def cameras() -> bytes:
    """Three cameras on one box whose sides are red (+X), green (+Y) and blue (+Z)."""
    glb = Glb()
    nodes = []
    for name, colour, axis, angle, at in (
        ("front", (0, 0, 1), (0, 1, 0), 0, (0, 0, 0.5)),
        ("right", (1, 0, 0), (0, 1, 0), 90, (0.5, 0, 0)),
        ("top", (0, 1, 0), (1, 0, 0), -90, (0, 0.5, 0)),
    ):
        material = glb.unlit(name, colour)
        nodes.append(quad_of(glb, material, name + " side", 1, translation=at, rotation=turn(axis, angle)))
    lens = glb.perspective("lens", 2 * np.arctan(0.25), near=0.1)
    flat = glb.orthographic("flat", 1, 1)
    nodes.append(glb.node("front", (0, 0, 4.5), camera=lens))
    nodes.append(glb.node("right", (4.5, 0, 0), look_at((4.5, 0, 0), (0, 0, 0)), camera=lens))
    nodes.append(glb.node("top", (0, 4.5, 0), look_at((0, 4.5, 0), (0, 0, 0), (0, 0, -1)), camera=flat))
    glb.scene(nodes, "cameras")
    return glb.bytes()


SCENES = {
    f.__name__: f
    for f in (
        uv_sets, samplers, vertex_colours, alpha_mask, alpha_blend, unlit, emissive_strength, double_sided,
        normal_map, thin_glass, cameras,
    )
}  # fmt: skip
