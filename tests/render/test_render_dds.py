# SPDX-License-Identifier: MIT
"""DDS textures of random blocks against another decoder. Skipped where the package is absent: `pip install pillow`."""

import io
import struct
import subprocess

import numpy as np
import pytest

from rendering import BUILD

Image = pytest.importorskip("PIL.Image")
SIZE = 64, 36


def dds(blocks: np.ndarray, number: int) -> bytes:
    width, height = SIZE
    pixels = struct.pack("<II4sIIIII", 32, 4, b"DX10", 0, 0, 0, 0, 0)
    head = struct.pack("<IIIIIII", 124, 0x81007, height, width, 0, 0, 1) + bytes(44) + pixels
    return (
        b"DDS "
        + head
        + struct.pack("<IIIII", 0x1000, 0, 0, 0, 0)
        + struct.pack("<IIIII", number, 3, 0, 1, 0)
        + blocks.tobytes()
    )


def texels(tmp_path, file: bytes) -> tuple[np.ndarray, np.ndarray]:
    """Ours, and the other decoder's."""
    path = tmp_path / "x.dds"
    path.write_bytes(file)
    dump = subprocess.run([BUILD / "tests" / "image_dump", path], stdout=subprocess.PIPE, check=True).stdout
    picture = Image.open(io.BytesIO(file))
    other = np.asarray(picture).reshape(SIZE[1], SIZE[0], -1).astype(int)
    return np.frombuffer(dump, np.uint8).reshape(SIZE[1], SIZE[0], 4)[..., : other.shape[-1]].astype(int), other


def random_blocks(size: int) -> np.ndarray:
    return np.random.default_rng(size).integers(0, 256, (SIZE[0] * SIZE[1] // 16, size)).astype(np.uint8)


@pytest.mark.parametrize("mode", range(8))
def test_bc7_is_exact(tmp_path, mode):
    blocks = random_blocks(16)
    blocks[:, 0] = blocks[:, 0] & (255 & -(2 << mode)) | 1 << mode
    ours, other = texels(tmp_path, dds(blocks, 98))
    assert (ours == other).all()


@pytest.mark.parametrize(("number", "size"), [(71, 8), (74, 16), (77, 16), (80, 8), (83, 16)])
def test_bc1_to_5_differ_in_rounding_alone(tmp_path, number, size):
    ours, other = texels(tmp_path, dds(random_blocks(size), number))
    assert np.abs(ours - other).max() <= 1
    assert (ours == other).mean() > 0.7
