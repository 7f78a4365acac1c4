# SPDX-License-Identifier: MIT
"""Samples, the reconstruction filter and filtered textures: against the filter's own integral worked out here, and
against many samples."""

import math
from typing import Any

import numpy as np
import pytest

from geometry_scenes import watched
from glb import LINEAR, LINEAR_MIPMAP_LINEAR, REPEAT, Glb
from png import rgba
from shapes import Shape, facing_up, grid, look_rotation, quaternion, sphere

SIZE = (48, 24)  # the shared orthographic camera shows x in [-2, 2], y in [-1, 1]: 12 pixels a metre
SLIVERS = [  # triangles in metres: edges at all angles, and wires far thinner than a pixel
    [(-1.9, -0.8), (-0.7, -0.5), (-1.4, 0.9)],
    [(-0.5, -0.9), (0.3, 0.1), (-0.45, -0.87)],
    [(-0.2, 0.9), (1.9, 0.31), (1.9, 0.33)],
    [(0.6, -0.93), (0.62, -0.93), (1.5, 0.12)],
    [(1.2, -0.7), (1.8, -0.62), (1.31, -0.05)],
]


def wires() -> bytes:
    glb = Glb()
    points = [(x, y, 0) for corners in SLIVERS for x, y in corners]
    faces = np.arange(len(points)).reshape(-1, 3)
    shape = Shape(np.array(points, float), np.concatenate([faces, faces[:, ::-1]]))
    return watched(
        glb, [glb.node("wires", mesh=glb.mesh(glb.primitive(shape, glb.unlit("white", (1, 1, 1))), "wires"))]
    )


def weight(x: np.ndarray, name: str) -> np.ndarray:
    """The filter in one dimension (SHADING.md, Samples), not normalised."""
    if name == "box":
        return (np.abs(x) <= 0.5).astype(float)
    if name == "triangle":
        return np.maximum(1 - np.abs(x), 0)
    return np.maximum(np.exp(-2 * x * x) - math.exp(-4.5), 0)


def filtered_coverage(name: str, fine: int = 96) -> np.ndarray:
    """The picture of SLIVERS by brute force: a fine grid of points, weighted by the filter."""
    width, height = SIZE
    at = (np.arange(-2 * fine, (width + 2) * fine) + 0.5) / fine  # pixels
    down = (np.arange(-2 * fine, (height + 2) * fine) + 0.5) / fine
    x, y = at / width * 4 - 2, 1 - down / height * 2
    inside = np.zeros((len(down), len(at)), bool)
    for a, b, c in SLIVERS:
        sides = [
            (q[0] - p[0]) * (y[:, None] - p[1]) - (q[1] - p[1]) * (x[None, :] - p[0])
            for p, q in ((a, b), (b, c), (c, a))
        ]
        inside |= np.all([s >= 0 for s in sides], axis=0) | np.all([s <= 0 for s in sides], axis=0)
    kernel = weight((np.arange(5 * fine) + 0.5) / fine - 2.5, name)
    kernel /= kernel.sum()
    picture = np.zeros((height, width))
    for row in range(height):
        rows = np.tensordot(kernel, inside[row * fine : (row + 5) * fine], axes=1)
        picture[row] = [rows[column * fine : (column + 5) * fine] @ kernel for column in range(width)]
    return picture


def rms(a: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(a))))


@pytest.mark.parametrize("name", ["box", "triangle", "gaussian"])
def test_edges_and_wires_converge_to_the_filters_integral(sheaf, tmp_path, name):
    """At the rate theory gives: n^-3/4 for edges under a stratified set; n^-1/2 would be chance."""
    scene = tmp_path / "wires.glb"
    scene.write_bytes(wires())
    counts = (4, 16, 64, 256)
    runs = sheaf.all({"scene": scene, "options": ("--spp", n, "--filter", name), "size": "48x24"} for n in counts)
    truth = filtered_coverage(name)
    errors = [rms(run.frame().rgb[..., 0] - truth) for run in runs]
    slope = np.polyfit(np.log2(counts), np.log2(errors), 1)[0]
    assert slope < -0.65, (slope, errors)
    assert errors[-1] < 0.006, errors
    assert rms(runs[-1].frame().alpha - truth) < 0.006


def test_one_sample_is_the_centre_whatever_the_filter(sheaf):
    runs = sheaf.all({"scene": "cornell", "options": ("--filter", name)} for name in ("box", "gaussian"))
    assert np.array_equal(runs[0].frame().rgba, runs[1].frame().rgba)


def tiled_room(mipmaps: bool, shift: float = 0.0) -> bytes:
    """A checked floor that runs to the horizon, a mirror that shows it again, a mirror ball and a ball of glass."""
    glb = Glb()
    random = np.random.default_rng(5)
    cells = random.integers(0, 2, (8, 8))[..., None] * np.array([200, 180, 150]) + np.array([20, 30, 40])
    checks = glb.texture(
        rgba(np.kron(cells, np.ones((8, 8, 1))).astype(np.uint8)),
        (LINEAR, LINEAR_MIPMAP_LINEAR if mipmaps else LINEAR),
        (REPEAT, REPEAT),
    )
    floor = facing_up(40, 40, uv_scale=16)
    ball = sphere(8)
    nodes = [
        glb.node("floor", mesh=glb.mesh(glb.primitive(floor, glb.unlit("floor", (1, 1, 1), texture=checks)), "floor")),
        glb.node(
            "mirror",
            mesh=glb.mesh(
                glb.primitive(grid((0.4, 0.02, -3), (5, 0, -2), (0, 2.4, 0)), glb.mirror("mirror")), "mirror"
            ),
        ),
        glb.node(
            "ball", (-1.5, 0.8, -2), scale=(0.8,) * 3, mesh=glb.mesh(glb.primitive(ball, glb.mirror("ball")), "ball")
        ),
        glb.node(
            "glass", (-3.6, 0.9, -3), scale=(0.9,) * 3, mesh=glb.mesh(glb.primitive(ball, glb.glass("glass")), "glass")
        ),
    ]
    eye = (shift, 1.2, 3.0)
    nodes.append(
        glb.node(
            "camera", eye, quaternion(look_rotation(eye, (shift, 0.7, -3.0))), camera=glb.perspective("camera", 0.7)
        )
    )
    glb.scene(nodes)
    return glb.bytes()


@pytest.fixture(scope="module")
def rooms(sheaf_once, tmp_path_factory):
    """Pictures of the room: filtered and not, at two places of the camera, and what many samples make of it."""
    folder = tmp_path_factory.mktemp("rooms")
    calls: dict[tuple[Any, Any], dict[str, Any]] = {}
    for mipmaps in (True, False):
        for shift in (0.0, 0.004):
            path = folder / f"room_{mipmaps}_{shift}.glb"
            path.write_bytes(tiled_room(mipmaps, shift))
            calls[mipmaps, shift] = {"scene": path, "size": "160x90"}
            if shift == 0:
                calls["truth", mipmaps] = {
                    "scene": path,
                    "size": "160x90",
                    "options": ("--spp", 256, "--filter", "box"),
                }
    return dict(zip(calls, [run.frame().rgb for run in sheaf_once.all(calls.values())], strict=True))


def parts_of(picture: np.ndarray) -> dict[str, np.ndarray]:
    return {"far floor": picture[42:56, 62:78], "mirror": picture[40:46, 100:150], "ball": picture[46:60, 28:58]}


def test_filtered_textures_are_near_what_many_samples_show(rooms):
    """Straight on, in a plane mirror and in a convex one. Without levels a sample sees one texel of many."""
    for name, truth in parts_of(rooms["truth", False]).items():
        filtered = rms(parts_of(rooms[True, 0.0])[name] - truth)
        single = rms(parts_of(rooms[False, 0.0])[name] - truth)
        assert filtered < 0.6 * single, (name, filtered, single)


def test_filtered_textures_do_not_shimmer(rooms):
    """A camera that moves by a fraction of a pixel changes little."""
    for name in ("far floor", "mirror"):
        moved = {
            mips: rms(parts_of(rooms[mips, 0.004])[name] - parts_of(rooms[mips, 0.0])[name]) for mips in (True, False)
        }
        assert moved[True] < 0.5 * moved[False], (name, moved)


def test_filtered_textures_are_not_blurred(rooms):
    """Detail that a pixel can hold stays: near the camera, and as much contrast everywhere as many samples leave."""
    near = slice(75, 90)
    assert rms(rooms[True, 0.0][near] - rooms[False, 0.0][near]) < 0.05
    for name, truth in parts_of(rooms["truth", False]).items():
        kept = parts_of(rooms[True, 0.0])[name].std() / truth.std()
        assert 0.8 < kept < 1.25, (name, kept)


def test_levels_do_not_change_what_many_samples_converge_to(rooms):
    for name, truth in parts_of(rooms["truth", False]).items():
        assert rms(parts_of(rooms["truth", True])[name] - truth) < 0.03, name


def test_reference_filters_alike(sheaf, tmp_path):
    """Two implementations of one text: footprints, levels and the cones behind mirrors and glass."""
    scene = tmp_path / "room.glb"
    scene.write_bytes(tiled_room(True))
    device, reference = (
        run.frame().rgb
        for run in sheaf.all(
            {"scene": scene, "size": "96x54", "options": ("--primary", "trace"), "strategy": strategy}
            for strategy in ("bvh", "reference")
        )
    )
    off = np.abs(device - reference).max(axis=2)
    assert np.quantile(off, 0.98) < 0.004  # half a code value of the levels, and half precision
    assert off.mean() < 0.002


ADAPTIVE = ("--spp", "adaptive:0.02:64")


def test_adaptive_samples_go_where_the_error_is(sheaf, tmp_path):
    """Better than as many samples everywhere, even where a third of all pixels are edges."""
    scene = tmp_path / "wires.glb"
    scene.write_bytes(wires())
    adaptive = sheaf.render(scene, "--spp", "adaptive:0.01:256", size="48x24", stats=True)
    truth = filtered_coverage("gaussian")
    spent = adaptive.stats()["frames"][0]["rays"]["primary"] / (48 * 24)
    assert 8 < spent < 120, spent
    error = rms(adaptive.frame().rgb[..., 0] - truth)
    everywhere = sheaf.render(scene, "--spp", math.ceil(spent), size="48x24").frame()
    assert error < 0.8 * rms(everywhere.rgb[..., 0] - truth)


def test_adaptive_pictures_do_not_depend_on_how_they_are_made(sheaf):
    options = [("bvh", 1024, "2"), ("bvh", 16, "1"), ("hybrid", 1024, "1"), ("hybrid", 24, "2"), ("crsh", 64, "2")]
    runs = sheaf.all(
        {
            "scene": "whitted",
            "size": "96x54",
            "strategy": strategy,
            "env": {"LP_NUM_THREADS": threads},
            "options": (*ADAPTIVE, "--memory", memory, "--aov", "Z,N,tests"),
        }
        for strategy, memory, threads in options
    )
    first = runs[0].frame()
    for run in runs[1:]:
        for name in ("R", "G", "B", "A", "Z", "N.X"):
            assert np.array_equal(run.frame().channels[name], first.channels[name]), name
    assert len(np.unique(first.rgba.reshape(-1, 4), axis=0)) > 100


def test_adaptive_reference_is_near(sheaf):
    device, reference = (
        run.frame().rgb
        for run in sheaf.all(
            {"scene": "cornell", "size": "48x27", "options": ADAPTIVE, "strategy": s} for s in ("bvh", "reference")
        )
    )
    assert np.quantile(np.abs(device - reference), 0.97) < 0.03


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (("--spp", "adaptive:0"), "spp"),
        (("--spp", "adaptive:nan"), "spp"),
        (("--spp", "adaptive:"), "spp"),
        (("--spp", "adaptive:0.01:4"), "spp"),
        (("--spp", "adaptive:0.01:x"), "spp"),
        (("--spp", "adaptive:-1"), "spp"),
        (("--spp", "sometimes"), "spp"),
        (("--spp", "1.5"), "spp"),
        (("--spp", ""), "spp"),
        (("--filter", "sinc"), "filter"),
    ],
)
def test_bad_sampling_is_refused_with_a_reason(sheaf, options, word):
    run = sheaf("render", "none.glb", "--out", sheaf.new_folder(), *options, code=(2, 3))
    assert word in run.stderr
    assert run.stderr.count("\n") == 1
