# SPDX-License-Identifier: MIT
"""Every extreme case by every strategy: the known answer, and the same bytes from all that run on the device."""

from __future__ import annotations

import numpy as np
import pytest

import camera_cases
import geometry_cases
import light_cases
import motion_cases
import optics_cases
from case import sane

GROUPS = (geometry_cases, optics_cases, light_cases, camera_cases, motion_cases)
VALIDATED = {"hybrid"}  # the layer costs a second a run; this one has the most stages
CASES = {name: case for group in GROUPS for name, case in group.CASES.items()}
# What fails today, and where the fault seems to lie.
BROKEN: dict[str, str] = {}


def marked(name: str):
    return pytest.param(name, marks=[pytest.mark.xfail(strict=True, reason=BROKEN[name])] if name in BROKEN else [])


@pytest.mark.parametrize("name", [marked(name) for name in CASES])
def test_known_answer(sheaf, device_strategies, tmp_path, name):
    case = CASES[name]
    scene = tmp_path / "scene.glb"
    scene.write_bytes(case.build())
    options = ["--frames=" + ",".join(map(str, case.checks)), *case.options]
    names = [*device_strategies, "reference"]
    codes = {strategy: (0, case.refused[strategy]) if strategy in case.refused else 0 for strategy in names}
    runs = sheaf.all(
        {
            "scene": scene,
            "options": options,
            "strategy": strategy,
            "size": case.size,
            "code": codes[strategy],
            "env": {"LP_NUM_THREADS": "1", "SHEAF_VALIDATION": str(int(strategy in VALIDATED))},
        }
        for strategy in names
    )
    for frame, check in case.checks.items():
        pictures = {strategy: run.frame(frame) for strategy, run in zip(names, runs, strict=True) if run.code == 0}
        for strategy, picture in pictures.items():
            sane(picture)
            if strategy != "reference":
                differs = (picture.rgba.view(np.uint16) != pictures["bvh"].rgba.view(np.uint16)).any(-1)
                assert not differs.any(), (
                    f"{strategy} is not bvh in {differs.sum()} pixels, first {np.argwhere(differs)[0]}"
                )
        check(pictures["bvh"])
        check(pictures["reference"])
