# SPDX-License-Identifier: MIT
"""`sheaf options`, and the committed files that follow from it."""

import json
import pathlib
import re
import subprocess
import sys

import pytest

from rendering import BUILD

ROOT = pathlib.Path(__file__).resolve().parents[2]
GENERATE = ROOT / "engine/settings/generate.py"


def table(sheaf) -> dict[str, dict]:
    return {setting["name"]: setting for setting in json.loads(sheaf("options", "--json").stdout)}


def test_every_option_of_the_help_is_told(sheaf):
    helped = re.findall(r"^  --([a-z-]+)", sheaf("render", "--help").stdout, re.M)
    assert sorted(helped) == sorted(table(sheaf))
    words = sheaf("options").stdout
    for name, setting in table(sheaf).items():
        assert f"--{name}" in words
        assert setting["help"] in words


def test_what_is_told_of_a_setting(sheaf):
    told = table(sheaf)
    assert told["cutoff"] | {"type": "number", "range": [0, 1], "default": 0.002, "http": True} == told["cutoff"]
    assert told["instances"]["choices"] == ["auto", "copied", "shared"]
    assert told["memory"]["unit"] == "MiB"
    assert told["out"] | {"http": False, "required": True} == told["out"]
    assert told["quality"]["presets"]["draft"] == {"spp": 1, "depth": 2, "cutoff": 0.02}


@pytest.mark.parametrize("bound", [0, 1])
def test_ranges_hold(sheaf, tmp_path, bound):
    """Just outside of each range that is told is refused; no scene is read for that."""
    for name, setting in table(sheaf).items():
        if setting["type"] not in ("integer", "number", "rate") or not setting["range"]:
            continue
        value = setting["range"][bound] + (1 if bound else -1)
        run = sheaf("render", tmp_path / "none.glb", "--out", tmp_path / "out", f"--{name}={value:.0f}", code=(2, 3))
        assert f"--{name}" in run.stderr


def test_committed_files_are_what_the_table_says():
    run = subprocess.run(
        [sys.executable, GENERATE, "--check", "--sheaf", BUILD / "sheaf"], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stdout + run.stderr
