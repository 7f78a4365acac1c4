# SPDX-License-Identifier: MIT
"""Other people's models: each renders to a picture, or is refused by the name of what it needs. Skipped where there are
none: SHEAF_ASSETS names their folder."""

import json

import numpy as np
import pytest

from rendering import ASSETS

MODELS = sorted(path.relative_to(ASSETS).as_posix() for path in ASSETS.rglob("*") if path.suffix in (".glb", ".gltf"))
REFUSED = {"KHR_draco_mesh_compression"}
TOO_MANY = {"MetalRoughSpheresNoTextures/MetalRoughSpheresNoTextures.glb"}  # a million triangles, for software

pytestmark = pytest.mark.skipif(not MODELS, reason=f"no models in {ASSETS}")


def required(path) -> set[str]:
    data = path.read_bytes()
    if data[:4] == b"glTF":
        data = data[20 : 20 + int.from_bytes(data[12:16], "little")]
    return set(json.loads(data).get("extensionsRequired", []))


@pytest.mark.parametrize("model", MODELS or ["none"])
def test_renders_or_is_refused_by_name(sheaf, model):
    path = ASSETS / model
    cannot = required(path) & REFUSED
    if cannot:
        run = sheaf("render", path, "--out", sheaf.new_folder(), code=3)
        assert path.name in run.stderr
        assert any(name in run.stderr for name in cannot)
        return
    picture = sheaf.render(
        path, "--frames", 7, size="96x96", env={"SHEAF_VALIDATION": "0" if model in TOO_MANY else "1"}
    ).frame()
    rgba = picture.rgba.astype(float)
    assert np.isfinite(rgba).all()
    assert ((picture.alpha >= 0) & (picture.alpha <= 1)).all()
    seen = rgba[picture.alpha > 0][:, :3]
    assert len(seen) > 0.01 * 96 * 96, "next to nothing is seen"
    assert seen.mean() > 0.01, "black"
    assert len(np.unique(rgba.reshape(-1, 4).round(3), axis=0)) > 2, "uniform"
