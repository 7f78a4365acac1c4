# SPDX-License-Identifier: MIT
"""Textures of Basis Universal against another decoder, byte for byte. Skipped where the packages are absent:
`pip install alktx2 opengl-basisu` (an encoder, and a decoder that shares no code with ours)."""

import subprocess

import numpy as np
import pytest

from png import rgba
from rendering import BUILD

alktx2 = pytest.importorskip("alktx2")
opengl_basisu = pytest.importorskip("opengl_basisu")


def pictures() -> dict[str, np.ndarray]:
    y, x = np.mgrid[0:37, 0:61]
    random = np.random.default_rng(7)
    ramp = np.stack([x * 4 % 256, y * 6 % 256, x * y // 9 % 256, 255 - x * 2], -1).astype(np.uint8)
    noise = random.integers(0, 256, (32, 32, 4)).astype(np.uint8)
    blocks = random.integers(0, 256, (12, 12, 4)).astype(np.uint8).repeat(4, 0).repeat(4, 1)
    return {
        "ramp": ramp[..., :3],
        "ramp with alpha": ramp,
        "noise": noise[..., :3],
        "noise with alpha": noise,
        "grey with alpha": np.concatenate([ramp[..., :1]] * 3 + [ramp[..., 1:2]], -1),
        "blocks with alpha": blocks,
    }


@pytest.mark.parametrize("codec", ["etc1s", "uastc"])
def test_texels_are_another_decoders(tmp_path, codec):
    dump = BUILD / "tests" / "image_dump"
    for name, picture in pictures().items():
        source, packed = tmp_path / "source.png", tmp_path / "packed.ktx2"
        source.write_bytes(rgba(picture))
        for quality, level in ((5, 3), (100, None)):
            alktx2.encode_image_to_ktx2(
                str(source), str(packed), codec=codec, quality=quality, srgb=False, linear=True, mipmaps=True,
                zstd_supercompression_level=level if codec == "uastc" else None,
            )  # fmt: skip
            expected = np.asarray(opengl_basisu.open(str(packed)).transcode("rgba8", level=0).data)
            found = np.frombuffer(subprocess.run([dump, packed], stdout=subprocess.PIPE, check=True).stdout, np.uint8)
            assert (found.reshape(expected.shape) == expected).all(), f"{name}, quality {quality}"
            if quality == 100 and "noise" not in name:
                assert np.abs(expected[..., :3].astype(int) - picture[..., :3]).mean() < 16, "the oracle reads it too"
