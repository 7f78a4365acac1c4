# SPDX-License-Identifier: MIT
"""A white furnace: where light of 1 comes from everywhere, a surface that absorbs nothing cannot be told from it. No
surface returns more than it gets, from its surroundings or from lamps."""

import numpy as np
import pytest

from glb import Glb
from physics import BLACK, close, reflected, unit
from png import rgba
from shapes import facing_z, look_at, sphere, turn

FURNACE = ("--environment", "1,1,1", "--cutoff", 0)
BOTH = ("bvh", "reference")
WHITE = (1, 1, 1)


def glass(glb: Glb, roughness: float, transmission: float, thickness: float, metallic=0.0, ior=1.5, **more) -> int:
    extensions = {"KHR_materials_transmission": {"transmissionFactor": transmission}, "KHR_materials_ior": {"ior": ior}}
    if thickness > 0:
        extensions["KHR_materials_volume"] = {"thicknessFactor": thickness}
    return glb.material("glass", WHITE, metallic, roughness, extensions, **more)


def shown(sheaf, tmp_path, glb: Glb, nodes, options=FURNACE, strategies=BOTH, extent=1.0, size="24x24") -> list:
    glb.scene(
        [
            *nodes,
            glb.light("none", "directional", 0),
            glb.node("camera", (0, 0, 9), camera=glb.orthographic("camera", extent, extent)),
        ]
    )
    path = tmp_path / "scene.glb"
    path.write_bytes(glb.bytes())
    return [
        run.frame()
        for run in sheaf.all({"scene": path, "options": options, "strategy": s, "size": size} for s in strategies)
    ]


def planes(glb: Glb, materials) -> list:
    """A row for every material, of planes at 0, 45, 80 and 88° to the camera, that fill a strip of the picture each."""
    nodes = []
    for row, material in enumerate(materials):
        for column, angle in enumerate((0, 45, 80, 88)):
            strip = facing_z(0.5 / np.cos(np.radians(angle)), 2 / len(materials))
            at = (-0.75 + 0.5 * column, -1 + (row + 0.5) * 2 / len(materials), 0)
            nodes.append(glb.node("plane", at, turn((0, 1, 0), angle), mesh=glb.mesh(glb.primitive(strip, material))))
    return nodes


@pytest.mark.parametrize("metallic", [0, 0.5, 1])
def test_opaque_planes_at_all_angles(sheaf, tmp_path, metallic):
    """Neighbours are seen in the mirrors, and are as white."""
    glb = Glb()
    rough = (0, 0.1, 0.2, 0.3, 0.4, 1)
    nodes = planes(glb, [glb.material("white", WHITE, metallic, r) for r in rough])
    for picture in shown(sheaf, tmp_path, glb, nodes, (*FURNACE, "--depth", 6)):
        assert (picture.alpha == 1).all()
        close(picture.rgb, WHITE)


@pytest.mark.parametrize("ior", [1.0, 1.5, 2.5])
def test_thin_glass_at_all_angles(sheaf, tmp_path, ior):
    glb = Glb()
    kinds = [(0, 1, 0), (0.4, 1, 0), (1, 1, 0), (0.2, 0.5, 0), (1, 0.5, 0.5), (0.3, 0.25, 1)]
    nodes = planes(glb, [glass(glb, r, t, 0, metallic, ior) for r, t, metallic in kinds])
    for picture in shown(sheaf, tmp_path, glb, nodes, (*FURNACE, "--depth", 6)):
        close(picture.rgb, WHITE, relative=2e-3)


@pytest.mark.parametrize(
    "make",
    [
        lambda g: g.material("m", WHITE, 0, 1),
        lambda g: g.material("m", WHITE, 0, 0.2),
        lambda g: g.material("m", WHITE, 0.5, 0.3),
        lambda g: g.material("m", WHITE, 1, 0),
    ],
)
def test_the_rim_of_a_white_sphere(sheaf, tmp_path, make):
    glb = Glb()
    nodes = [glb.node("ball", mesh=glb.mesh(glb.primitive(sphere(6), make(glb))))]
    for picture in shown(sheaf, tmp_path, glb, nodes, extent=1.01, size="48x48"):
        close(picture.rgb[picture.alpha == 1], WHITE)


@pytest.mark.parametrize(
    ("roughness", "transmission", "metallic"), [(0, 1, 0), (1, 1, 0), (0.2, 0.5, 0), (1, 0.5, 0.5)]
)
def test_glass_balls(sheaf, tmp_path, roughness, transmission, metallic):
    """Closed glass, from outside and within: what 12 generations leave is a hundredth at most, never more than all."""
    glb = Glb()
    nodes = [
        glb.node("ball", mesh=glb.mesh(glb.primitive(sphere(6), glass(glb, roughness, transmission, 1, metallic))))
    ]
    for picture in shown(
        sheaf, tmp_path, glb, nodes, ("--environment", "1,1,1", "--depth", 12, "--cutoff", 1e-3), extent=1.01
    ):
        seen = picture.rgb[picture.alpha == 1]
        assert seen.max() <= 1.001
        assert np.median(seen) > 0.99


@pytest.mark.parametrize("options", [("--depth", 0), ("--depth", 1), ("--cutoff", 0.3)])
def test_limits_only_lose(sheaf, tmp_path, options):
    glb = Glb()
    nodes = planes(glb, [glb.material("white", WHITE, 0, 0.2), glass(glb, 0.5, 0.5, 0), glass(glb, 0, 1, 1)])
    device, reference = shown(sheaf, tmp_path, glb, nodes, ("--environment", "1,1,1", *options))
    assert device.rgb.max() <= 1.001
    close(device.rgb, reference.rgb, relative=3e-3)


def test_blended_occluded_and_bumpy(sheaf, tmp_path):
    """Alpha shares out between surface and background; occlusion takes; a normal map turns, but makes nothing."""
    glb = Glb()
    uv = facing_z(0.5, 2, uv_scale=1)
    tangents = {"TANGENT": glb.attribute(np.tile((1, 0, 0, 1), (len(uv.positions), 1)))}
    steep = {"index": glb.texture(rgba([[(255, 128, 140), (0, 128, 140)]]))}
    dark = {"index": glb.texture(rgba([[(0, 0, 0), (255, 255, 255)]])), "strength": 0.5}
    kinds = [
        ({}, glb.material("blend", (1, 1, 1, 0.5), 0, 0.2, alphaMode="BLEND")),
        ({}, glb.material("occluded", WHITE, 0, 1, occlusionTexture=dark)),
        (tangents, glb.material("bumpy", WHITE, 0, 1, normalTexture=steep)),
        (tangents, glass(glb, 0.5, 0.5, 0, normalTexture=steep)),
    ]
    nodes = [
        glb.node("strip", (-0.75 + 0.5 * k, 0, 0), mesh=glb.mesh(glb.primitive(uv, material, **more)))
        for k, (more, material) in enumerate(kinds)
    ]
    for picture in shown(sheaf, tmp_path, glb, nodes):
        blend, occluded, *bumpy = (picture.rgb[:, k : k + 6] for k in (0, 6, 12, 18))
        close(blend, 0.5)
        close(picture.alpha[:, :6], 0.5)
        assert occluded.max() <= 1.001
        assert 0.4 < occluded.min() < 0.6
        close(np.array(bumpy), WHITE, relative=2e-3)


def test_a_tinted_surface_returns_its_share(sheaf, tmp_path):
    """At 60°: Fresnel's share whole, of the rest the base."""
    tint, angle = (0.5, 0.25, 1), 60
    glb = Glb()
    wide = facing_z(8, 2)
    nodes = [
        glb.node("plane", None, turn((0, 1, 0), angle), mesh=glb.mesh(glb.primitive(wide, glb.material("m", tint))))
    ]
    f = 0.04 + 0.96 * 0.5**5
    for picture in shown(sheaf, tmp_path, glb, nodes):
        close(picture.rgb, f + (1 - f) * np.array(tint))


def lamps_from_all_sides(count=256) -> np.ndarray:
    """Directions around +Z, as often as their cosine is large: a spiral over the disk below them."""
    k = np.arange(count) + 0.5
    r, turns = np.sqrt(k / count), k * np.pi * (3 - 5**0.5)
    return np.stack([r * np.cos(turns), r * np.sin(turns), np.sqrt(1 - r**2)], -1)


@pytest.mark.parametrize(("roughness", "angle"), [(0.5, 84), (0.5, 60), (1, 84), (0.7, 87)])
def test_lamps_on_all_sides_give_no_more_than_a_furnace(sheaf, tmp_path, roughness, angle):
    towards = lamps_from_all_sides()
    tilt = np.radians(angle)
    into_view = np.array([(np.cos(tilt), 0, np.sin(tilt)), (0, 1, 0), (-np.sin(tilt), 0, np.cos(tilt))])
    glb = Glb()
    nodes = [
        glb.node(
            "plane",
            None,
            turn((0, 1, 0), angle),
            mesh=glb.mesh(glb.primitive(facing_z(80, 4), glb.material("white", WHITE, 0, roughness))),
        )
    ]
    for way in towards:
        nodes.append(
            glb.light(
                "lamp",
                "directional",
                np.pi / len(towards) / way[2],
                placed={"rotation": look_at(into_view @ way, (0, 0, 0))},
            )
        )
    for picture in shown(sheaf, tmp_path, glb, nodes, BLACK, size="4x4"):
        assert 0.3 < picture.rgb.max() <= 1.01


@pytest.mark.parametrize("roughness", [0.1, 0.2, 0.35, 0.5, 0.7, 1])
@pytest.mark.parametrize("ior", [1.0, 1.5, 2.4])
def test_the_stated_bound_of_what_lamps_give(roughness, ior):
    """The formula itself, over the hemisphere: the mirroring lobe by its own half-vectors, the base by cosines."""
    n = 96
    u, phi = (np.arange(n) + 0.5)[:, None] / n, (np.arange(n) + 0.5) / n * 2 * np.pi
    a2 = max(roughness, 0.1) ** 4
    z = np.array((0, 0, 1.0))
    for nv in (0.02, 0.1, 0.3, 0.6, 1):
        v = np.array((np.sqrt(1 - nv**2), 0, nv))

        def ways(c):
            s = np.sqrt(1 - c**2)
            return np.stack(np.broadcast_arrays(s * np.cos(phi), s * np.sin(phi), c), -1)

        cosine = ways(np.sqrt(u))
        base = (
            reflected(1, z, v, cosine, 0, roughness, ior)[..., 0]
            - reflected(0, z, v, cosine, 0, roughness, ior)[..., 0]
        )
        diffuse = np.mean(base / cosine[..., 2] * np.pi)
        h = ways(np.sqrt((1 - u) / (1 + (a2 - 1) * u)))
        mirrored = unit(2 * (h @ v)[..., None] * h - v)
        density = a2 / (np.pi * (h[..., 2] ** 2 * (a2 - 1) + 1) ** 2) * h[..., 2] / (4 * np.maximum(h @ v, 1e-9))
        gloss = np.where(
            (mirrored[..., 2] > 1e-6) & (h @ v > 0),
            reflected(0, z, v, mirrored, 0, roughness, ior)[..., 0] / density,
            0,
        )
        assert diffuse + gloss.mean() <= 1.005, (nv, diffuse, gloss.mean())
