# SPDX-License-Identifier: MIT
"""Other people's models: each renders to a picture. Skipped where there are none: SHEAF_ASSETS names their
folder."""

import json
import pathlib

import numpy as np
import pytest

from rendering import ASSETS

MODELS = sorted(path.relative_to(ASSETS).as_posix() for path in ASSETS.rglob("*") if path.suffix in (".glb", ".gltf"))
COMPRESSED = [path for path in MODELS if "glTF-Draco" in path]
# Files of a second folder that come compressed, or with textures that are not PNG or JPEG.
ECOSYSTEM = ASSETS.parent / "ecosystem"
FORMATS = {
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_draco_mesh_compression",
    "EXT_texture_webp",
    "KHR_texture_basisu",
    "MSFT_texture_dds",
    "KHR_materials_pbrSpecularGlossiness",
}
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


def used(path: pathlib.Path) -> set[str]:
    data = path.read_bytes()
    if data[:4] == b"glTF":
        data = data[20 : 20 + int.from_bytes(data[12:16], "little")]
    return set(json.loads(data).get("extensionsUsed", []))


PACKED = sorted(
    path.relative_to(ECOSYSTEM).as_posix()
    for path in ECOSYSTEM.rglob("*")
    if path.suffix in (".glb", ".gltf") and "glTF1" not in path.parts and used(path) & FORMATS
)


@pytest.mark.skipif(not PACKED, reason=f"no models in {ECOSYSTEM}")
@pytest.mark.parametrize("model", PACKED or ["none"])
def test_compressed_files_render_without_a_warning_of_it(sheaf, model):
    run = sheaf.render(ECOSYSTEM / model, size="48x48", env={"SHEAF_VALIDATION": "0"}, stats=True)
    picture = run.frame()
    assert np.isfinite(picture.rgba.astype(float)).all()
    assert (picture.alpha > 0).sum() > 0.005 * 48 * 48, "next to nothing is seen"
    assert picture.rgb[picture.alpha > 0].mean() > 0.01, "black"
    scene = run.stats()["scene"]
    assert set(scene["extensions_read"]) >= used(ECOSYSTEM / model) & FORMATS
    assert not any(name in warning for name in FORMATS for warning in scene["warnings"])


@pytest.mark.parametrize("model", COMPRESSED or ["none"])
def test_compressed_models_look_like_their_originals(sheaf, model):
    plain = next((ASSETS / model).parent.parent.glob("glTF-Binary/*.glb"))
    pictures = [sheaf.render(path, "--frames", 7, size="96x96").frame() for path in (plain, ASSETS / model)]
    difference = np.abs(pictures[0].rgb - pictures[1].rgb)
    assert difference.mean() < 0.005, "positions are quantized, and move by less than a pixel"
    assert (difference.max(axis=-1) > 0.05).mean() < 0.02, "edges alone may differ"
