# SPDX-License-Identifier: MIT
"""Mirrors and glass against Snell, Fresnel, Beer and Lambert."""

import math

import numpy as np
import pytest

from glb import Glb
from optics_scenes import _slab, oblique_edge
from physics import BLACK, box_of, close, dot, fresnel, inside, pixels, reflected, refract, schlick
from shapes import facing_z, look_at

ALL = ("--cutoff", 0, *BLACK)
LOSS = 1 - float(fresnel(1.0, 1.0, 1.5))  # 0.96 at each face
STRAY = 3e-4  # the default light's highlight in smooth glass


def test_slab_once_through(sheaf):
    """Depth 2 holds exactly the path in, out and on to the wall: Fresnel twice, Beer and Lambert once."""
    rgb = sheaf.render("slab", "--depth", 2, *ALL).frame().rgb
    close(rgb, LOSS**2 * np.array((0.5, 0.25, 0.8)) ** 2, absolute=STRAY)


def test_slab_with_all_internal_reflections(sheaf):
    rgb = sheaf.render("slab", "--depth", 12, *ALL).frame().rgb
    inner = np.array((0.5, 0.25, 0.8)) ** 2
    close(rgb, LOSS**2 * inner / (1 - ((1 - LOSS) * inner) ** 2), relative=7e-4, absolute=STRAY)


def test_slab_from_inside(sheaf, tmp_path):
    """A camera in the glass: what is looked through absorbs, though its front was never passed."""
    glb = Glb()
    nodes = [_slab(glb), glb.node("wall", mesh=glb.mesh(glb.primitive(facing_z(8, 8, -2), glb.unlit("w", (1, 1, 1)))))]
    nodes.append(glb.node("camera", (0, 0, 0.25), camera=glb.orthographic("camera", 2, 1)))
    glb.scene(nodes)
    path = tmp_path / "inside.glb"
    path.write_bytes(glb.bytes())
    rgb = sheaf.render(path, "--depth", 1, *ALL, size="32x16").frame().rgb
    close(rgb, LOSS * np.array((0.5, 0.25, 0.8)) ** (0.75 / 0.5), absolute=STRAY)


def test_oblique_slab_shifts_the_wall(sheaf):
    """Every pixel's own path by Snell, in the plane of incidence, to the wall's red or blue half."""
    size = (64, 32)
    rgb = sheaf.render("slab_oblique", "--depth", 2, *ALL, size="64x32").frame().rgb
    across, _ = pixels(*size, 0.2, 0.1)
    r = math.sqrt(0.5)
    eye = np.array((4 * r, 0, 4 * r)) + across[0][:, None] * np.array((r, 0, -r))
    into = np.broadcast_to((-r, 0, -r), eye.shape)
    front = np.array((0, 0, 1.0))
    entry = eye + into * ((0.5 - eye[:, 2]) / into[:, 2])[:, None]
    within = refract(into, front, 1, 1.5)
    leaving = entry + within * (-1 / within[:, 2])[:, None]
    after = refract(within, front, 1.5, 1)
    np.testing.assert_allclose(after, into, atol=1e-12)
    wall = leaving + after * ((-2 - leaving[:, 2]) / after[:, 2])[:, None]
    clear = float((1 - fresnel(r, 1, 1.5)) * (1 - fresnel(-dot(within, front)[0], 1.5, 1)))
    assert clear == pytest.approx(0.902044, abs=1e-6)
    red = wall[:, 0] < oblique_edge()
    assert 0 < red.sum() < size[0]
    assert (np.abs(wall[:, 0] - oblique_edge()) > 1e-4).all()
    wanted = np.where(red[:, None], (clear, 0, 0), (0, 0, clear))
    close(rgb, np.broadcast_to(wanted, rgb.shape), absolute=STRAY)


def test_total_internal_reflection(sheaf):
    """Nothing passes the hypotenuse (45°, past 41.8°): the red wall behind it is not seen, the green one is."""
    two, three, many = (
        run.frame().rgb
        for run in sheaf.all(
            {"scene": "prism", "options": ("--depth", depth, *ALL), "size": "32x32"} for depth in (2, 3, 16)
        )
    )
    close(two, 0, absolute=STRAY)
    close(three, (0, LOSS**2, 0), absolute=STRAY)
    close(many, (0, LOSS**2 / (1 - (1 - LOSS) ** 2), 0), absolute=STRAY)


def test_nested_glass(sheaf):
    """Along the axis: 1 → 1.5 → 1.33 → 1.5 → 1, so the inner ball takes the outer one's place while it lasts."""
    rgb = sheaf.render("nested_glass", "--depth", 4, *ALL, size="65x33").frame().rgb
    water = 1 - float(fresnel(1.0, 1.5, 1.33))
    close(rgb[16, 32], LOSS**2 * water**2, absolute=2e-3)  # the balls have facets


def mirror_count(size: int) -> np.ndarray:
    """How many mirrors the ray through each row meets before the ceiling; -1 where rounding decides."""
    _, s = pixels(1, size, 1, 1)
    y = -0.5 + s[:, 0] / math.cos(math.atan(1 / 8))
    far = (8 * (1 - y) - 2) / 4
    count = np.where(far < 0, 0, np.floor(far) + 1).astype(int)
    return np.where(np.abs(far - np.round(far)) < 1e-4, -1, count)


@pytest.mark.parametrize(
    ("options", "bounces"),
    [
        (("--depth", 6, "--cutoff", 0), 6),
        (("--depth", 2, "--cutoff", 0), 2),
        (("--depth", 6, "--cutoff", 0.85), 1),
        (("--depth", 0), 0),
    ],
)
def test_facing_mirrors(sheaf, options, bounces):
    """A power of the mirror's colour; no further than --depth generations, nor than --cutoff lets weights fall."""
    rgb = sheaf.render("mirrors", *options, *BLACK, size="32x32").frame().rgb
    count = mirror_count(32)
    assert {1, 2, 3} <= set(count)
    for row, n in enumerate(count):
        if n >= 0:
            close(rgb[row], np.array((0.9, 0.8, 0.7)) ** n if n <= bounces else (0, 0, 0))


def test_thin_glass_and_its_reflection(sheaf):
    picture = sheaf.render("thin_glass", *ALL, size="64x32").frame()
    x, y = pixels(64, 32, 2, 1)
    pane, sure = inside(x, y, box_of(-0.5, 0.5, -0.5, 0.5))
    close(picture.rgb[pane & sure], (0.5 * LOSS, LOSS, 0.5 * LOSS), absolute=STRAY)
    close(picture.rgb[~pane & sure], (1, 1, 1))
    lit = sheaf.render("thin_glass", "--cutoff", 0, "--environment", "1,1,1", size="64x32").frame()
    seen = np.array((0.5, 1, 0.5)) * LOSS + (1 - LOSS)  # through it the wall, by one face the surroundings
    close(lit.rgb[pane & sure], seen, absolute=STRAY)


@pytest.mark.parametrize(("metallic", "roughness"), [(0.0, 0.0), (0.0, 0.2), (1.0, 0.1), (0.5, 0.3)])
def test_mirror_share_and_schlick(sheaf, tmp_path, metallic, roughness):
    """An opaque surface at 60° reflects the surroundings by Schlick, the less the rougher it is."""
    base = np.array((0.6, 0.4, 0.2))
    glb = Glb()
    plane = glb.primitive(facing_z(40, 40), glb.material("plane", tuple(base), metallic, roughness))
    nodes = [
        glb.node("plane", mesh=glb.mesh(plane)),
        glb.light("behind", "directional", 1, placed={"rotation": look_at((0, 0, -1), (0, 0, 0))}),
    ]
    eye = (5 * math.sin(math.radians(60)), 0, 5 * math.cos(math.radians(60)))
    nodes.append(glb.node("camera", eye, look_at(eye, (0, 0, 0)), camera=glb.orthographic("camera", 0.1, 0.1)))
    glb.scene(nodes)
    path = tmp_path / "plane.glb"
    path.write_bytes(glb.bytes())
    rgb = sheaf.render(path, "--environment", "0.25,0.5,1", "--cutoff", 0, size="8x8").frame().rgb
    f0 = 0.04 * (1 - metallic) + metallic * base
    share = max(1 - roughness / 0.4, 0) ** 2
    gloss = schlick(f0, 0.5)  # cos 60°
    left = 1 - schlick(0.04, 0.5)  # of the part that is no metal, for its base
    wanted = np.array((0.25, 0.5, 1)) * ((1 - metallic) * left * base + (1 - share) * gloss + share * gloss)
    close(rgb, wanted)


def test_a_ray_that_grazes_glass_keeps_its_energy(sheaf, tmp_path):
    """At 80° in a white surround, thin clear glass adds up to white: F reflected and 1 - F passed."""
    glb = Glb()
    pane = glb.primitive(facing_z(40, 40), glb.glass("pane", 1.5, 0))
    eye = (5 * math.sin(math.radians(80)), 0, 5 * math.cos(math.radians(80)))
    glb.scene(
        [
            glb.node("pane", mesh=glb.mesh(pane)),
            glb.light("behind", "directional", 1, placed={"rotation": look_at((0, 0, -1), (0, 0, 0))}),
            glb.node("camera", eye, look_at(eye, (0, 0, 0)), camera=glb.orthographic("camera", 0.1, 0.1)),
        ]
    )
    path = tmp_path / "pane.glb"
    path.write_bytes(glb.bytes())
    runs = sheaf.all(
        {"scene": path, "options": ("--cutoff", 0, "--environment", e), "size": "8x8"} for e in ("1,1,1", "0,0,0")
    )
    close(runs[0].frame().rgb, (1, 1, 1))
    close(runs[1].frame().rgb, (0, 0, 0))
    assert (runs[0].frame().alpha == 1).all()


def test_highlight_of_a_smooth_surface(sheaf, tmp_path):
    """The narrowest lobe (roughness is held at 0.1) right at the mirror's angle and beside it."""
    glb = Glb()
    plane = glb.primitive(facing_z(40, 40), glb.material("plane", (0.2, 0.2, 0.2), 0, 0.05))
    glb.scene(
        [
            glb.node("plane", mesh=glb.mesh(plane)),
            glb.light("lamp", "point", 2, placed={"translation": (0, 0, 2)}),
            glb.node("camera", (0, 0, 5), camera=glb.orthographic("camera", 0.25, 0.25)),
        ]
    )
    path = tmp_path / "highlight.glb"
    path.write_bytes(glb.bytes())
    rgb = sheaf.render(path, *ALL, size="24x24").frame().rgb
    x, y = pixels(24, 24, 0.25, 0.25)
    to_lamp = np.stack([-x, -y, np.full_like(x, 2)], -1)
    wanted = (
        reflected((0.2,) * 3, (0, 0, 1), (0, 0, 1), to_lamp, roughness=0.05) * (2 / dot(to_lamp, to_lamp))[..., None]
    )
    assert wanted.max() > 20 * wanted.min()
    close(rgb, wanted, relative=3e-3)
