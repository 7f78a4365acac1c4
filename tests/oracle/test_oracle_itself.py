# SPDX-License-Identifier: MIT
"""The checker tells right from wrong: dumps written here by hand, each with one known answer."""

from __future__ import annotations

import pathlib
import subprocess

import numpy as np
import pytest

from oracle import check_dump, oracle_program

HIT = np.dtype([("t", "<f4"), ("triangle", "<i4"), ("u", "<f4"), ("v", "<f4")])
MISS = (0, -1, 0, 0)
# Two squares [-1, 1]² facing +Z, at z = 0 (triangles 0, 1) and z = -1 (2, 3), each cut along its diagonal x = y.
CORNERS = ((-1, -1), (1, -1), (1, 1), (-1, 1))
SQUARES = [[(*CORNERS[k], z) for k in face] for z in (0, -1) for face in ((0, 1, 2), (0, 2, 3))]


def down(x: float, y: float, tmin: float = 0, tmax: float = np.inf) -> tuple:
    """A ray along -Z from z = 1, 1 m above the first square."""
    return (x, y, 1, tmin, 0, 0, -1, tmax)


def dump(
    folder: pathlib.Path, rays: list[tuple], hits: list[tuple], kind="reflection", triangles=SQUARES
) -> pathlib.Path:
    folder.mkdir(exist_ok=True)
    np.save(folder / "f0000_triangles.npy", np.array(triangles, "<f4"))
    np.save(folder / "f0000_origin.npy", np.zeros(3))
    np.save(folder / f"f0000_g1_{kind}_rays.npy", np.array(rays, "<f4"))
    np.save(folder / f"f0000_g1_{kind}_hits.npy", np.array(hits, HIT))
    return folder


JUST_OFF = float(np.nextafter(np.float32(1), np.float32(2)))  # of the squares, by 1.2e-7
CASES = {  # ray, hit, verdict, kind
    "right": (down(0.5, 0.2), (1, 0, 0, 0), "same", "reflection"),
    "a miss that is one": (down(3, 0), MISS, "same", "reflection"),
    "a miss through a triangle": (down(0.5, 0.2), MISS, "missed", "reflection"),
    "a miss through the edge of two triangles": (down(0.5, 0.5), MISS, "missed", "reflection"),
    "a miss beside that edge": (down(0.5, 0.5 + 6e-8), MISS, "missed", "reflection"),
    "a miss at the border": (down(1, 0.2), MISS, "free", "reflection"),
    "a hit at the border": (down(JUST_OFF, 0.2), (1, 0, 0, 0), None, "reflection"),
    "a hit past the border": (down(1.00001, 0.2), (1, 0, 0, 0), "false_hit", "reflection"),
    "another triangle": (down(0.5, 0.2), (1, 1, 0, 0), "false_hit", "reflection"),
    "no such triangle": (down(0.5, 0.2), (1, 4, 0, 0), "false_hit", "reflection"),
    "the square behind": (down(0.5, 0.2), (2, 2, 0, 0), "wrong_nearest", "reflection"),
    "the square behind, through the edge": (down(0.5, 0.5), (2, 3, 0, 0), "wrong_nearest", "reflection"),
    "t too large": (down(0.5, 0.2), (1.0001, 0, 0, 0), "wrong_t", "reflection"),
    "t too small": (down(0.5, 0.2), (0.9999, 0, 0, 0), "wrong_t", "reflection"),
    "before its range": (down(0.5, 0.2, 1.5, 3), (1, 0, 0, 0), "false_hit", "reflection"),
    "behind its range": (down(0.5, 0.2, 0, 0.5), (1, 0, 0, 0), "false_hit", "reflection"),
    "the first in its range": (down(0.5, 0.2, 1.5, 3), (2, 2, 0, 0), "same", "reflection"),
    "ends at the surface": (down(0.5, 0.2, 0, 1), MISS, "free", "reflection"),
    "either triangle of an edge": (down(0.5, 0.5), (1, 1, 0, 0), None, "reflection"),
    "any occluder": (down(0.5, 0.2), (2, 2, 0, 0), "same", "shadow"),
    "light through a surface": (down(0.5, 0.2), MISS, "missed", "shadow"),
    "an occluder behind the light": (down(0.5, 0.2, 0, 1.5), (2, 2, 0, 0), "false_hit", "shadow"),
    "no number": ((np.nan, 0, 1, 0, 0, 0, -1, 9), MISS, "bad_ray", "reflection"),
    "no direction": ((0, 0, 1, 0, 0, 0, 0, 9), MISS, "bad_ray", "shadow"),
}


@pytest.mark.parametrize("case", CASES)
def test_verdict(tmp_path, case):
    ray, hit, verdict, kind = CASES[case]
    found = check_dump(dump(tmp_path / "dump", [ray], [hit], kind), 1000)
    told = {name for name, count in found.verdicts.items() if count}
    assert told == {verdict} if verdict else told <= {"same", "tie", "free"}


def test_one_wrong_among_many_is_named(tmp_path):
    spots = np.random.default_rng(1).uniform(-0.9, 0.9, (5000, 2))
    rays = [down(x, y) for x, y in spots]
    hits = [(1, 0 if x > y else 1, 0, 0) for x, y in spots]
    hits[3210] = MISS
    found = check_dump(dump(tmp_path / "dump", rays, hits), 1000)
    assert found.verdicts["missed"] == found.failures == 1
    assert [(d["ray"], d["engine"], d["verdict"]) for d in found.listed] == [(3210, None, "missed")]
    assert found.listed[0]["embree"]["t"] == pytest.approx(1)


def test_double_precision_finds_what_embree_is_not_asked(tmp_path):
    """Samples alone: with all rays sampled, the brute force sees the same failures."""
    rays, hits = [down(0.3, 0.2), down(0.2, 0.3)], [(2, 2, 0, 0), (1, 1, 0, 0)]
    found = check_dump(dump(tmp_path / "dump", rays, hits), 10**6)
    assert found.verdicts["wrong_nearest"] == 1
    assert found.sampled == 1  # what is already known to be wrong is not asked again


def test_a_broken_dump_is_refused(tmp_path):
    folder = dump(tmp_path / "dump", [down(0, 0.1)], [(1, 1, 0, 0)])
    path = folder / "f0000_g1_reflection_hits.npy"
    path.write_bytes(path.read_bytes()[:-4])
    done = subprocess.run([str(oracle_program()), str(folder)], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "reflection_hits.npy" in done.stderr
