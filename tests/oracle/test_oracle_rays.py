# SPDX-License-Identifier: MIT
"""A few hundred thousand rays of the engine's, from every strategy: none is wrong. check_rays.py does any number."""

from __future__ import annotations

import shutil

import numpy as np
import pytest

from oracle import HERE, check_dump, orbit, render_dump
from soups import SOUPS

CASES = [
    ("soup", "crsh", 1), ("lattice", "hybrid", 1), ("coincident", "rsh", 1), ("needles", "bvh", 1),
    ("shells", "hybrid", 1), ("soup", "frustum", 1), ("coincident", "frustum", 1), ("soup", "classify", 1),
    ("shells", "classify", 1), ("soup_far", "bvh", 1), ("whitted", "hybrid", 2), ("cornell", "bvh", 2),
]  # fmt: skip
SIZE = "192x108"


@pytest.mark.parametrize(("name", "strategy", "samples"), CASES)
def test_no_ray_is_wrong(tmp_path, name, strategy, samples):
    scene = HERE.parent / "scenes" / f"{name}.glb"
    if name in SOUPS:
        scene = tmp_path / f"{name}.glb"
        scene.write_bytes(SOUPS[name]())
    options = ("--camera", orbit(scene, tmp_path), "--frames", 307) if name in SOUPS else ("--frames", 7)
    dump = render_dump(
        scene,
        tmp_path / "out",
        "--size", SIZE, "--depth", 4, "--cutoff", 0, "--strategy", strategy, "--opaque", "--spp", samples,
        *options,
    )  # fmt: skip
    found = check_dump(dump, 2_000_000)
    assert found.failures == 0, [d for d in found.listed if d["verdict"] not in ("tie", "free", "embree")]
    assert found.rays > 20_000
    assert found.hits > 200
    assert found.sampled > 500
    # Made wrong by hand, it is seen: the same dump with one hit taken away.
    (path, *_) = sorted(dump.glob("*_g0_primary_hits.npy"))
    hits = np.load(path)
    inside = np.flatnonzero(hits["triangle"] >= 0)
    hits["triangle"][inside[len(inside) // 2]] = -1
    np.save(path, hits)
    for other in dump.glob("*_g[1-9]_*.npy"):
        other.unlink()
    broken = check_dump(dump, 1000)
    assert broken.failures == broken.verdicts["missed"] == 1 or name == "needles"
    shutil.rmtree(dump)
