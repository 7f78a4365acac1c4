# SPDX-License-Identifier: MIT
"""The form for a new job: it offers what the engine offers, and sends what was chosen and nothing else."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable

import pytest
from conftest import BUILD

Visit = Callable[..., object]


@pytest.fixture(scope="module")
def options() -> dict[str, tuple[str | None, str]]:
    """Of each option of `sheaf render`: its default, and what the help says of it."""
    said = subprocess.run([BUILD / "sheaf", "render", "--help"], capture_output=True, text=True, check=True).stdout
    found = re.findall(r"^  --([a-z-]+) TEXT(?:=(\S+))? +(.+)$", said, re.M)
    return {name: (default or None, words) for name, default, words in found}


@pytest.mark.parametrize(
    ("name", "choices"),
    [
        ("strategy", r"(\w+)(?:,|$)"),
        ("sort", r"(\w+)(?:,|$| or )"),
        ("primary", r"(\w+)(?:,|:| or )"),
        ("filter", r"(\w+)(?:,|$| or )"),
        ("compression", r"(\w+)(?:,|$)"),
        ("quality", r"(\w+) = "),
    ],
)
def test_every_choice_of_the_engine_is_offered(
    visit: Visit, options: dict[str, tuple[str | None, str]], name: str, choices: str
) -> None:
    default, words = options[name]
    known = set(re.findall(choices, words.split(": ", 1)[-1] if name == "filter" else words))
    field = visit().locator(f"[name={name}]")
    assert len(known) > 2
    assert set(field.evaluate("(field) => [...field.options].map((option) => option.value)")) == known
    assert default is None or field.input_value() == default


def sent(page) -> dict:
    return page.evaluate("settings()")


def test_what_nobody_chose_is_left_to_the_engine(visit: Visit) -> None:
    assert sent(visit()) == {
        "frames": "0",
        "size": "640x360",
        "quality": "production",
        "fps": 24,
        "aov": "Z,N,id,tests",
    }


def test_what_was_chosen_is_sent(visit: Visit) -> None:
    page = visit()
    page.click("summary")
    chosen = {"strategy": "classify", "sort": "on", "primary": "raster", "filter": "box", "compression": "piz"}
    for name, value in chosen.items():
        page.select_option(f"[name={name}]", value)
    page.fill("[name=depth]", "0")
    page.fill("[name=cutoff]", "0.01")
    page.fill("[name=spp]", "16")
    page.check("[value=P]")
    wanted = {**chosen, "depth": 0, "cutoff": 0.01, "spp": 16, "aov": "Z,N,id,P,tests"}
    assert {name: sent(page).get(name) for name in wanted} == wanted
    page.fill("[name=error]", "0.02")
    assert sent(page)["spp"] == "adaptive:0.02:16"
    page.fill("[name=spp]", "")
    assert sent(page)["spp"] == "adaptive:0.02"
