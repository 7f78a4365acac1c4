# SPDX-License-Identifier: MIT
"""Settings that mean nothing: 2 (not a value of the option's kind) or 3 (out of range), one line that names the option,
and nothing written."""

import pytest

from rendering import SCENES

BAD = {
    "spp": ("0", "-1", "0.5", "65537", "1e9", "nan", "inf", "", "99999999999999999999"),
    "depth": ("-1", "4097", "1.5", "nan", "1e3", "99999999999999999999"),
    "cutoff": ("nan", "-nan", "-0.001", "1.001", "inf", "-inf", "1e400", "half", ""),
    "size": ("0x0", "0x9", "16x0", "-16x9", "16385x1", "1x16385", "16x9x3", "16x", "x9", "16.5x9", "nanxnan",
             "4294967312x9"),
    "memory": ("0", "-1", "15", "nan", "1e99", "1.5", "99999999999999999999"),
    "fps": ("0", "-24", "nan", "inf", "1e7", "24/0", ""),
    "environment": ("nan,0,0", "0,inf,0", "-1,0,0", "1e7,0,0", "1,1", "1,1,1,1", "1,,1", ","),
    "frames": ("", "a", "1-", "5-1", "1-5:0", "1-5:-1", "nan", "1e3", "0-99999999999", "99999999999999999999", "1,,2",
               "1;2"),
    "camera-node": ("99", "-1", "nobody"),
    "animation": ("99", "-1", "walk"),
    "scene-name": ("99", "-1", "nowhere"),
    "variant": ("99", "-1", "red"),
    "device": ("99", "no such device"),
    "sort": ("1", ""),
    "primary": ("", "Raster"),
    "count": ("2",),
    "progress": ("2",),
    "aov": ("z", "Z;N"),
    "compression": ("ZIP", ""),
    "name": ("", "a.exr", "####", "/tmp/####.exr", "a/####.exr"),
}  # fmt: skip
CASES = [(option, value) for option, values in BAD.items() for value in values]


@pytest.mark.parametrize(("option", "value"), CASES, ids=[f"{o}={v}" for o, v in CASES])
def test_is_refused(sheaf, tmp_path, option, value):
    run = sheaf(
        "render",
        SCENES / "interpolation.glb",
        "--out",
        tmp_path / "out",
        f"--{option}={value}",
        code=(4,) if option == "device" else (2, 3),
    )
    (line,) = [line for line in run.stderr.splitlines() if line]
    assert line.startswith("sheaf: ")
    assert option.split("-")[0] in line or (value and value in line), line
    assert not list(tmp_path.glob("out/*"))
