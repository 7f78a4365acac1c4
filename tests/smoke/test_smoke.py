# SPDX-License-Identifier: MIT
"""The strategies on two scenes, end to end: the same bytes, a picture, and stats that add up."""

import json
import os
import pathlib
import subprocess

import numpy as np
import OpenEXR
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHEAF = pathlib.Path(os.environ.get("SHEAF_BUILD", ROOT / "build")) / "sheaf"


def rendered(scene: str, out: pathlib.Path, *options: str) -> tuple[np.ndarray, dict]:
    command = [SHEAF, "render", ROOT / "tests/scenes" / scene, "--out", out, "--size", "64x36", "--name", "f.#.exr"]
    command += ["--stats", out / "stats.json", *options]
    run = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=600, check=False)
    assert run.returncode == 0, run.stderr
    pixels = OpenEXR.File(str(out / "f.0.exr")).channels()["RGBA"].pixels
    return pixels.astype(np.float32), json.loads((out / "stats.json").read_text())


@pytest.mark.parametrize("scene", ["whitted.glb", "cornell.glb"])
def test_strategies_give_the_same_bytes(scene: str, tmp_path: pathlib.Path) -> None:
    wanted, stats = rendered(scene, tmp_path / "bvh", "--strategy", "bvh")
    assert np.isfinite(wanted).all()
    assert wanted[..., :3].std() > 0.01
    frame = stats["frames"][0]
    assert frame["rays"]["primary"] == 64 * 36
    assert frame["tests"]["ray_triangle"]["shadow"] > 0
    others = (["hybrid", "--sort", "on"], ["hybrid", "--sort", "off"], ["crsh"], ["rsh"], ["frustum"], ["classify"])
    for options in others:
        got, _ = rendered(scene, tmp_path / "_".join(options), "--strategy", *options)
        assert (got == wanted).all(), options
