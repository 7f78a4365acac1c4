# SPDX-License-Identifier: MIT
"""Lit surfaces against closed formulas: every pixel, in double precision."""

import math

import numpy as np
import pytest

from glb import Glb
from physics import ambient, box_of, close, dot, inside, pixels, reflected, unit
from shapes import box, facing_up, look_at, turn

SIZE = (48, 48)
UP = np.array((0.0, 1.0, 0.0))


def from_above(half=2.0):
    """x and z of the pixels of the plane scenes: +X to the right, -Z up."""
    x, up = pixels(*SIZE, half, half)
    return x, -up


def test_point_light_on_a_plane(sheaf):
    picture = sheaf.render("point_light", size="48x48").frame()
    x, z = from_above()
    close(picture.rgb, (4 / (4 + x**2 + z**2) ** 1.5)[..., None], absolute=2e-5)


def test_spot_light_cone(sheaf):
    picture = sheaf.render("spot_light", size="48x48").frame()
    x, z = from_above()
    r = np.hypot(x, z)
    cosine = 2 / np.hypot(2, r)
    inner, outer = math.cos(math.radians(20)), math.cos(math.radians(30))
    cone = np.clip((cosine - outer) / (inner - outer), 0, 1) ** 2
    wanted = 4 / (4 + r**2) ** 1.5 * cone
    close(picture.rgb, wanted[..., None], absolute=2e-5)
    assert (wanted == 0).any()
    assert (picture.rgb[wanted == 0] == 0).all()


def test_directional_light_and_its_shadow(sheaf):
    picture = sheaf.render("directional_light", size="48x48").frame()
    x, z = from_above()
    roof, _ = inside(x, z, box_of(0.75, 1.25, -0.25, 0.25))
    shift = math.tan(math.radians(60))
    shadow, sure = inside(x, z, box_of(0.75 - shift, 1.25 - shift, -0.25, 0.25))
    assert shadow.sum() > 30
    close(picture.rgb[roof], (0, 0, 1), absolute=0)
    close(picture.rgb[shadow & sure], (0, 0, 0), absolute=0)
    lit = ~roof & ~shadow & sure
    sun = (math.sin(math.radians(60)), math.cos(math.radians(60)), 0)
    exact = reflected((0.5,) * 3, UP, UP, sun, ior=1.0) * np.pi
    close(exact, 0.25, absolute=1e-4)  # Lambert, and next to nothing by Schlick's fifth power at 30°
    close(picture.rgb[lit], exact)


def build(material: dict, lights, more=None) -> bytes:
    """A plane through the origin seen from straight above, lights placed by (kind, intensity, color, node, more)."""
    glb = Glb()
    plane = glb.primitive(facing_up(8, 8), glb.material("plane", **material))
    nodes = [glb.node("plane", mesh=glb.mesh(plane))]
    nodes += [
        glb.light(f"light {k}", kind, intensity, color, placed, **rest)
        for k, (kind, intensity, color, placed, rest) in enumerate(lights)
    ]
    if more:
        nodes += more(glb)
    eye = glb.orthographic("camera", 1, 1, 0.01, 100)
    nodes.append(glb.node("camera", (0, 1, 0), look_at((0, 1, 0), (0, 0, 0), (0, 0, -1)), camera=eye))
    glb.scene(nodes)
    return glb.bytes()


SURFACES = {
    "rough": {"metallic": 0.0, "roughness": 0.9, "ior": 1.5},
    "gloss": {"metallic": 0.0, "roughness": 0.45, "ior": 1.8},
    "metal": {"metallic": 1.0, "roughness": 0.5, "ior": 1.5},
    "half metal": {"metallic": 0.5, "roughness": 0.6, "ior": 1.3},
}


@pytest.mark.parametrize("surface", SURFACES)
def test_every_kind_of_light_on_every_kind_of_surface(sheaf, tmp_path, surface):
    """A point light with a range, a spot light, a directional one, all coloured, and light from all around."""
    base = np.array((0.8, 0.5, 0.2))
    optics = SURFACES[surface]
    material = {
        "base": tuple(base),
        "metallic": optics["metallic"],
        "roughness": optics["roughness"],
        "extensions": {"KHR_materials_ior": {"ior": optics["ior"]}},
    }
    cone = {"innerConeAngle": 0.1, "outerConeAngle": 0.5}
    spot_at, sun_from = np.array((-0.5, 1.5, 0.25)), unit((0.5, 1.0, -0.75))
    aim = look_at(spot_at, (0.25, 0, 0))
    lights = [
        ("point", 3.0, (1, 0.5, 0.25), {"translation": (0.4, 0.75, 0.3)}, {"range": 1.25}),
        ("spot", 5.0, (0.2, 0.6, 1), {"translation": spot_at, "rotation": aim}, {"spot": cone}),
        ("directional", 0.5, (0.9, 0.8, 1), {"rotation": look_at(sun_from, (0, 0, 0))}, {}),
    ]
    path = tmp_path / "lit.glb"
    path.write_bytes(build(material, lights))
    surround = np.array((0.125, 0.25, 0.5))
    picture = sheaf.render(path, "--environment", "0.125,0.25,0.5", size="48x48").frame()

    x, z = from_above(1)
    points = np.stack([x, 0 * x, z], -1)
    wanted = surround * ambient(base, UP, UP, **optics)
    away = np.array((0.4, 0.75, 0.3)) - points
    r2 = dot(away, away)
    fade = np.clip(1 - (np.sqrt(r2) / 1.25) ** 4, 0, 1) / r2
    wanted = wanted + reflected(base, UP, UP, away, **optics) * fade[..., None] * 3 * (1, 0.5, 0.25)
    away = spot_at - points
    scale = 1 / max(0.001, math.cos(0.1) - math.cos(0.5))
    axis = unit(np.array((0.25, 0, 0)) - spot_at)
    cosine = dot(-unit(away), axis)
    angle = np.clip(cosine * scale - math.cos(0.5) * scale, 0, 1) ** 2
    wanted = wanted + reflected(base, UP, UP, away, **optics) * (angle / dot(away, away))[..., None] * 5 * (0.2, 0.6, 1)
    wanted = wanted + reflected(base, UP, UP, sun_from, **optics) * 0.5 * (0.9, 0.8, 1)
    assert (fade == 0).any()
    assert (angle == 0).any()
    assert (angle > 0.9).any()
    close(picture.rgb, wanted, relative=1.5e-3)


def test_light_through_panes_is_tinted(sheaf, tmp_path):
    """Shadow rays through alpha blending, thin coloured glass, and a volume that absorbs."""

    def panes(glb: Glb) -> list:
        blend = glb.unlit("blend", (1, 0, 0, 0.25), alphaMode="BLEND")
        thin = glb.glass("thin", 1.5, 0, (0.5, 1, 0.25))
        thick = glb.glass("thick", 1.5, 0.25, colour=(0.25, 0.5, 1), distance=0.5)
        quad = facing_up(0.5, 4)
        nodes = [
            glb.node(name, at, mesh=glb.mesh(glb.primitive(quad, m), name))
            for name, at, m in (("blend", (-0.75, 3, 0), blend), ("thin", (-0.25, 3, 0), thin))
        ]
        slab = glb.primitive(box((0.5, 0.25, 4)), thick)
        return [*nodes, glb.node("thick", (0.25, 3, 0), mesh=glb.mesh(slab, "thick"))]

    down = {"rotation": turn((1, 0, 0), -90)}
    path = tmp_path / "panes.glb"
    matte = {"base": (0.5,) * 3, "extensions": {"KHR_materials_ior": {"ior": 1}}}
    path.write_bytes(build(matte, [("directional", 2 * np.pi, (1, 1, 1), down, {})], panes))
    rgb = sheaf.render(path, size="64x16").frame().rgb  # 8 m by 2 m: x = (i + 0.5) / 8 - 4
    face = 1 - 0.04
    close(rgb[:, 24:28].mean((0, 1)), (0.75,) * 3)
    close(rgb[:, 28:32].mean((0, 1)), (0.5 * face, face, 0.25 * face))
    close(rgb[:, 32:36].mean((0, 1)), face**2 * np.array((0.25, 0.5, 1)) ** 0.5, absolute=2e-4)
    close(rgb[:, 38:60].mean((0, 1)), (1, 1, 1))


def test_default_light_and_environment(sheaf):
    """No light in the scene: 3 lux along (0.4, -0.7, -1) of the camera, and 0.4 from all around."""
    picture = sheaf.render("no_light", size="64x32").frame()
    x, y = pixels(64, 32, 2, 1)
    face, sure = inside(x, y, box_of(-0.5, 0.5, -0.5, 0.5))
    front = np.array((0.0, 0.0, 1.0))
    wanted = reflected((0.5,) * 3, front, front, (-0.4, 0.7, 1)) * 3 + 0.4 * ambient((0.5,) * 3, front, front)
    close(picture.rgb[face & sure], wanted)
    assert (picture.alpha[~face & sure] == 0).all()
    assert (picture.rgb[~face & sure] == 0).all()  # the background stays transparent


@pytest.mark.parametrize("scene", ["non_indexed", "negative_scale"])
def test_flat_normals_made_for_meshes_without_any(sheaf, scene):
    """Both halves lean by atan(1/2) away from the middle or towards it, and look alike under light along -Z."""
    picture = sheaf.render(scene, "--aov", "N", size="64x32").frame()
    x, y = pixels(64, 32, 2, 1)
    near, far = (0, 1) if scene == "non_indexed" else (0.25, 1.25)
    # The roof's two triangles rise from the outside to the ridge; the wedges fall towards the middle.
    halves = {}
    if scene == "non_indexed":
        halves[-1] = inside(x, y, [[(-1, -0.5), (0, -0.5), (0, 0.5)]])
        halves[1] = inside(x, y, [[(0, -0.5), (1, -0.5), (0, 0.5)]])
    else:
        halves[-1] = inside(x, y, box_of(-far, -near, -0.5, 0.5))
        halves[1] = inside(x, y, box_of(near, far, -0.5, 0.5))
    for side, (covered, sure) in halves.items():
        normal = unit((side * (1 if scene == "non_indexed" else -1), 0, 2))
        wanted = reflected((0.5,) * 3, normal, (0, 0, 1), (0, 0, 1)) * 3
        seen = covered & sure
        assert seen.sum() > 50
        close(picture.rgb[seen], wanted)
        np.testing.assert_allclose(picture.layer("N")[seen], np.broadcast_to(normal, (seen.sum(), 3)), atol=1e-6)


def test_surfaces_seen_from_behind_are_lit_like_others(sheaf):
    picture = sheaf.render("double_sided", "--back-faces", "show", size="64x32").frame()
    x, y = pixels(64, 32, 2, 1)
    wanted = reflected((0.5,) * 3, (0, 0, 1), (0, 0, 1), (0, 0, 1)) * 3
    for left in (-1.25, 0.25):
        square, sure = inside(x, y, box_of(left, left + 1, -0.5, 0.5))
        close(picture.rgb[square & sure], wanted)


def test_normal_map(sheaf):
    picture = sheaf.render("normal_map", size="64x32").frame()
    x, y = pixels(64, 32, 2, 1)
    leaning = unit(np.array((204, 128, 230)) / 255 * 2 - 1)
    for left, normal in ((-1.25, leaning), (0.25, (0, 0, 1))):
        square, sure = inside(x, y, box_of(left, left + 1, -0.5, 0.5))
        wanted = reflected((0.5,) * 3, normal, (0, 0, 1), (0, 0, 1), ior=1.0) * np.pi
        close(picture.rgb[square & sure], wanted)
    close(picture.rgb[16, 12], 0.4, relative=0.01)
