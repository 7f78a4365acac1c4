# SPDX-License-Identifier: MIT
"""Compressed files give the picture of what was compressed, bit for bit where the codec loses nothing."""

import pytest

from packing import pack
from rendering import SCENES


@pytest.mark.parametrize("scene", ["skin", "morph", "interleaved"])
def test_meshopt_loses_nothing(sheaf, tmp_path, scene):
    packed = tmp_path / "packed.glb"
    packed.write_bytes(pack(SCENES / f"{scene}.glb", "KHR_meshopt_compression"))
    pictures = [sheaf.render(path, "--frames", 7).frame() for path in (SCENES / f"{scene}.glb", packed)]
    assert (pictures[0].rgba == pictures[1].rgba).all()
    assert (pictures[0].alpha > 0).any()
