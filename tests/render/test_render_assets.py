# SPDX-License-Identifier: MIT
"""Other people's models: each renders to a picture. Skipped where there are none: SHEAF_ASSETS names their
folder."""

import numpy as np
import pytest

from rendering import ASSETS

MODELS = sorted(path.relative_to(ASSETS).as_posix() for path in ASSETS.rglob("*") if path.suffix in (".glb", ".gltf"))
COMPRESSED = [path for path in MODELS if "glTF-Draco" in path]
TOO_MANY = {"MetalRoughSpheresNoTextures/MetalRoughSpheresNoTextures.glb"}  # a million triangles, for software

pytestmark = pytest.mark.skipif(not MODELS, reason=f"no models in {ASSETS}")


@pytest.mark.parametrize("model", MODELS or ["none"])
def test_renders(sheaf, model):
    path = ASSETS / model
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


@pytest.mark.parametrize("model", COMPRESSED or ["none"])
def test_compressed_models_look_like_their_originals(sheaf, model):
    plain = next((ASSETS / model).parent.parent.glob("glTF-Binary/*.glb"))
    pictures = [sheaf.render(path, "--frames", 7, size="96x96").frame() for path in (plain, ASSETS / model)]
    difference = np.abs(pictures[0].rgb - pictures[1].rgb)
    assert difference.mean() < 0.005, "positions are quantized, and move by less than a pixel"
    assert (difference.max(axis=-1) > 0.05).mean() < 0.02, "edges alone may differ"
