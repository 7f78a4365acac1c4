# SPDX-License-Identifier: MIT
"""`--dump`: every ray that was traced, checked against every triangle in double precision."""

from __future__ import annotations

import numpy as np
import pytest

from rendering import Run

HIT = np.dtype([("t", "<f4"), ("triangle", "<i4"), ("u", "<f4"), ("v", "<f4")])
EDGE = 2e-5  # barycentric: how far outside a triangle a hit may lie, and how far inside it must be for sure


class Dump:
    def __init__(self, run: Run, frame: int = 0):
        self.folder, self.prefix = run.out / "dump", f"f{frame:04}_"
        self.triangles = self.load("triangles")
        self.origin = self.load("origin")
        self.corner = self.triangles[:, 0].astype(float)
        self.edges = self.triangles[:, 1:].astype(float) - self.corner[:, None]

    def load(self, name: str) -> np.ndarray:
        return np.load(self.folder / f"{self.prefix}{name}.npy", allow_pickle=False)

    def batches(self) -> list[tuple[int, str]]:
        names = sorted(path.name[len(self.prefix) :] for path in self.folder.glob(f"{self.prefix}g*_rays.npy"))
        return [(int(name.split("_")[0][1:]), name.split("_")[1]) for name in names]

    def rays(self, generation: int, kind: str) -> tuple[np.ndarray, np.ndarray]:
        stem = f"g{generation}_{kind}"
        return self.load(stem + "_rays"), self.load(stem + "_hits")


def intersect(dump: Dump, rays: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """t of every ray with every triangle's plane, the least barycentric coordinate there, and |cosine| with the plane.
    Möller and Trumbore's determinants, in double precision."""
    origin, direction = rays[:, None, 0:3].astype(float), rays[:, None, 4:7].astype(float)
    e1, e2 = dump.edges[None, :, 0], dump.edges[None, :, 1]
    normal = np.cross(e1, e2)
    with np.errstate(divide="ignore", invalid="ignore"):
        facing = np.sum(direction * normal, -1)
        cosine = np.abs(facing) / (np.linalg.norm(normal, axis=-1) * np.linalg.norm(direction, axis=-1))
        away = origin - dump.corner[None]
        t = -np.sum(away * normal, -1) / facing
        turn = np.cross(away, direction)
        u, v = -np.sum(e2 * turn, -1) / facing, np.sum(e1 * turn, -1) / facing
        least = np.minimum(np.minimum(u, v), 1 - u - v)
    sliver = ~(np.isfinite(least) & (cosine > 1e-6))
    return np.where(sliver, np.inf, t), np.where(sliver, -np.inf, least), np.where(sliver, 1, cosine)


def bound(dump: Dump, rays: np.ndarray, t: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """How exactly t can be known: single precision of where things are, over the angle with the plane."""
    scale = np.abs(dump.triangles).max() + np.abs(rays[:, 0:3]).max(-1).astype(float)
    return 1e-6 * (scale[:, None] + np.abs(t)) / np.maximum(cosine, 1e-3)


def in_parts(rays: np.ndarray, hits: np.ndarray, triangles: int):
    step = max(1, 1_500_000 // max(triangles, 1))
    for first in range(0, len(rays), step):
        yield rays[first : first + step], hits[first : first + step]


def check_closest(dump: Dump, rays: np.ndarray, hits: np.ndarray) -> int:
    """No hit that is none, no nearer one missed. Gives how many hits there were."""
    for ray, hit in in_parts(rays, hits, len(dump.triangles)):
        t, least, cosine = intersect(dump, ray)
        with np.errstate(invalid="ignore"):
            slack = np.where(np.isfinite(t), bound(dump, ray, np.where(np.isfinite(t), t, 0), cosine), 0)
        rows, found = np.arange(len(ray)), hit["triangle"] >= 0
        k = np.where(found, hit["triangle"], 0)
        assert (least[rows, k][found] > -EDGE - slack[rows, k][found]).all(), "a hit outside its triangle"
        error = np.abs(hit["t"] - t[rows, k])
        assert (error[found] <= slack[rows, k][found]).all(), "a hit at another distance"
        assert (hit["t"][found] >= ray[found, 3]).all()
        assert (hit["t"][found] <= ray[found, 7]).all()
        limit = np.where(found, hit["t"], ray[:, 7].astype(float))[:, None]
        nearer = (least > EDGE) & (t > ray[:, 3:4] + slack) & (t < limit - slack)
        assert not nearer.any(), f"a nearer triangle missed by {nearer.any(1).sum()} rays"
    return int((hits["triangle"] >= 0).sum())


def check_shadows(dump: Dump, rays: np.ndarray, hits: np.ndarray) -> int:
    """A hit is a real occluder between light and point; without a hit nothing stands surely in between."""
    for ray, hit in in_parts(rays, hits, len(dump.triangles)):
        t, least, cosine = intersect(dump, ray)
        slack = bound(dump, ray, np.where(np.isfinite(t), t, 0), cosine)
        rows, found = np.arange(len(ray)), hit["triangle"] >= 0
        k = np.where(found, hit["triangle"], 0)
        assert (least[rows, k][found] > -EDGE - slack[rows, k][found]).all(), "an occluder that is none"
        within = (t[rows, k] >= ray[:, 3] - slack[rows, k]) & (t[rows, k] <= ray[:, 7] + slack[rows, k])
        assert within[found].all(), "an occluder behind the light or the point"
        blocking = (least > EDGE) & (t > ray[:, 3:4] + slack) & (t < ray[:, 7:8] - slack)
        assert not blocking[~found].any(), "light through an opaque surface"
    return int((hits["triangle"] >= 0).sum())


def check_barycentric(dump: Dump, rays: np.ndarray, hits: np.ndarray) -> None:
    """corner + u (second - first) + v (third - first) is where the ray is at t."""
    found = hits["triangle"] >= 0
    k, u, v = hits["triangle"][found], hits["u"][found].astype(float), hits["v"][found].astype(float)
    point = dump.corner[k] + u[:, None] * dump.edges[k, 0] + v[:, None] * dump.edges[k, 1]
    along = rays[found, 0:3] + hits["t"][found, None].astype(float) * rays[found, 4:7]
    size = np.abs(dump.edges[k]).max((1, 2)) + np.abs(along).max(1)
    assert (u >= -1e-5).all()
    assert (v >= -1e-5).all()
    assert (u + v <= 1 + 1e-5).all()
    assert (np.linalg.norm(point - along, axis=1) < 2e-4 * size).all()


def dumped(sheaf, scene: str, *options: object, **named) -> Run:
    out = sheaf.new_folder()
    return sheaf.render(scene, "--dump", out / "dump", "--back-faces", "show", *options, out=out, stats=True, **named)


@pytest.mark.parametrize(
    ("scene", "strategy", "options"),
    [
        ("cornell", "bvh", ("--primary", "trace", "--opaque")),
        (
            "cornell",
            "hybrid",
            (
                "--sort",
                "on",
            ),
        ),
        ("still_life", "crsh", ("--primary", "trace")),
        ("nested_glass", "hybrid", ("--primary", "trace", "--depth", 6)),
        ("still_life_far", "rsh", ()),
        ("cornell", "frustum", ("--primary", "trace")),
        ("whitted", "classify", ("--primary", "trace")),
        ("degenerate", "brute", ("--primary", "trace")),
        ("interpolation", "bvh", ("--frames", "7")),
    ],
)
def test_every_hit_is_right(sheaf, scene, strategy, options):
    frame = 7 if "--frames" in options else 0
    run = dumped(sheaf, scene, *options, strategy=strategy, size="40x22")
    dump = Dump(run, frame)
    stats = run.stats()["frames"][0]
    opaque = "--opaque" in options or scene not in ("cornell", "nested_glass", "whitted")
    hit_something = 0
    for generation, kind in dump.batches():
        rays, hits = dump.rays(generation, kind)
        if kind == "shadow":
            hit_something += check_shadows(dump, rays, hits) if opaque else 0
        elif kind != "primary" or "trace" in options:
            hit_something += check_closest(dump, rays, hits)
            check_barycentric(dump, rays, hits)
        else:
            hit_something += int((hits["triangle"] >= 0).sum())
    assert hit_something > 20
    for kind in ("primary", "shadow", "reflection", "refraction"):  # nothing left unsaid
        told = sum(len(dump.rays(g, k)[0]) for g, k in dump.batches() if k == kind)
        assert told == stats["rays"][kind], kind


def test_arrays_as_specified(sheaf):
    run = dumped(sheaf, "whitted", "--frames", "12", size="32x18")
    dump = Dump(run, 12)
    assert dump.triangles.dtype == np.dtype("<f4")
    assert dump.triangles.shape == (13490, 3, 3)
    assert dump.origin.dtype == np.dtype("<f8")
    assert dump.origin.shape == (3,)
    batches = dump.batches()
    assert (0, "primary") in batches
    assert {kind for _, kind in batches} == {"primary", "shadow", "reflection", "refraction"}
    assert {g for g, kind in batches if kind == "reflection"} <= {1, 2, 3, 4}
    for generation, kind in batches:
        rays, hits = dump.rays(generation, kind)
        assert rays.dtype == np.dtype("<f4")
        assert rays.shape == (len(hits), 8)
        assert hits.dtype == HIT
        assert np.isfinite(rays[:, :7]).all()
        np.testing.assert_allclose(np.linalg.norm(rays[:, 4:7], axis=1), 1, atol=1e-5)
        assert (rays[:, 7] >= rays[:, 3]).all()
        assert (hits["triangle"] < 13490).all()
    primary, _ = dump.rays(0, "primary")
    assert len(primary) == 32 * 18


def test_triangles_are_in_the_world(sheaf):
    """far_vertices.glb: 10⁷ m away; only the origin tells, so the triangles keep their digits."""
    dump = Dump(dumped(sheaf, "far_vertices"))
    world = dump.triangles.astype(float) + dump.origin
    np.testing.assert_allclose(world.reshape(-1, 3).min(0), (1e7 - 4, -2, -1), atol=1e-3)
    np.testing.assert_allclose(world.reshape(-1, 3).max(0), (1e7 + 4, 2, 1), atol=1e-3)
    moved = Dump(dumped(sheaf, "interpolation", "--fps", 2, "--frames", "1"), 1)  # half a second
    squares = (moved.triangles.astype(float) + moved.origin).reshape(4, 2, 3, 3)
    centres = [(s.reshape(-1, 3).min(0) + s.reshape(-1, 3).max(0)) / 2 for s in squares]
    np.testing.assert_allclose(centres, [(0, 0.75, 0), (0.5, 0.25, 0), (0.75, -0.25, 0), (0, -0.75, 0)], atol=1e-6)


def test_rasterised_primary_hits(sheaf):
    """What the rasteriser saw: the nearest triangle, but for samples within its subpixel step of an edge."""
    dump = Dump(dumped(sheaf, "cornell", size="48x27"))
    rays, hits = dump.rays(0, "primary")
    wrong = 0
    for ray, hit in in_parts(rays, hits, len(dump.triangles)):
        t, least, _ = intersect(dump, ray)
        sure = np.where((least > 0.01) & (t > ray[:, 3:4]) & (t <= ray[:, 7:8]), t, np.inf)  # 1 % of a triangle inside
        nearest = np.argmin(sure, 1)
        known = np.isfinite(sure[np.arange(len(ray)), nearest])
        any_near = np.where((least > -0.01) & (t > ray[:, 3:4]), t, np.inf).min(1)
        clear = known & (any_near == sure[np.arange(len(ray)), nearest])
        assert clear.any()
        wrong += (hit["triangle"] != nearest)[clear].sum()
        assert (hit["triangle"][~np.isfinite(any_near)] == -1).all()
    assert wrong == 0


def test_tiles_and_samples_append(sheaf):
    """A budget that cuts the picture into tiles, some of them traced again in parts, tells every ray once."""
    runs = [dumped(sheaf, "whitted", "--memory", mib, "--depth", 3, size="256x144") for mib in (16, 1024)]
    dumps = [Dump(run) for run in runs]
    assert dumps[0].batches() == dumps[1].batches()
    for generation, kind in dumps[0].batches():
        (a, hits_a), (b, hits_b) = (d.rays(generation, kind) for d in dumps)
        assert a.shape == b.shape

        def ordered(rays, hits, kind=kind):
            if kind == "shadow":  # which occluder is free
                rows = np.concatenate([rays, (hits["triangle"] >= 0)[:, None]], 1)
            else:
                rows = np.concatenate([rays, hits["triangle"][:, None], hits["t"][:, None]], 1)
            return rows[np.lexsort(rows.T)]

        assert np.array_equal(ordered(a, hits_a), ordered(b, hits_b)), (generation, kind)
    assert runs[0].stats()["frames"][0]["rays"] == runs[1].stats()["frames"][0]["rays"]


def test_dump_into_a_file_is_6(sheaf, tmp_path):
    (tmp_path / "taken").write_text("")
    run = sheaf.render("unlit", "--dump", tmp_path / "taken", code=6)
    assert "taken" in run.stderr
