# SPDX-License-Identifier: MIT
"""The form for a new job: it offers what the engine offers, and sends what was chosen and nothing else."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from typing import Any

import pytest

from conftest import BUILD

Visit = Callable[..., Any]


@pytest.fixture(scope="module")
def table() -> dict[str, dict]:
    """What the engine says of each setting."""
    said = subprocess.run([BUILD / "sheaf", "options", "--json"], capture_output=True, text=True, check=True).stdout
    return {setting["name"]: setting for setting in json.loads(said)}


def test_every_setting_of_the_service_is_offered(visit: Visit, table: dict[str, dict]) -> None:
    page = visit()
    offered = {name for name in page.evaluate("[...new FormData($('new')).keys()]") if name != "error"}
    boxes = page.locator("#new [type=checkbox]").evaluate_all("(boxes) => boxes.map((box) => box.name)")
    # A name of files and a device are no visitor's matter, and the page needs its previews.
    assert (offered | set(boxes)) - {""} == {n for n, s in table.items() if s["http"]} - {"name", "device", "preview"}


@pytest.mark.parametrize("name", ["strategy", "sort", "primary", "instances", "filter", "compression", "quality"])
def test_every_choice_of_the_engine_is_offered(visit: Visit, table: dict[str, dict], name: str) -> None:
    field = visit().locator(f"[name={name}]")
    choices = field.evaluate("(field) => [...field.options].map((option) => option.value)")
    assert choices == table[name]["choices"]
    assert len(choices) > 2
    assert table[name]["default"] is None or field.input_value() == table[name]["default"]


def test_ranges_are_those_of_the_engine(visit: Visit, table: dict[str, dict]) -> None:
    page = visit()
    for name in ("depth", "cutoff", "memory", "spp"):
        field = page.locator(f"[name={name}]")
        assert [float(field.get_attribute("min")), float(field.get_attribute("max"))] == table[name]["range"]


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
    chosen |= {"instances": "shared", "count": "on"}
    for name, value in chosen.items():
        page.select_option(f"[name={name}]", value)
    page.fill("[name=depth]", "0")
    page.fill("[name=cutoff]", "0.01")
    page.fill("[name=spp]", "16")
    page.check("[value=P]")
    page.check("[name=opaque]")
    page.fill("[name=environment]", "1,1,0.5")
    page.fill("[name=z-background]", "inf")
    page.fill("[name=scene-name]", "0")
    wanted = {**chosen, "depth": 0, "cutoff": 0.01, "spp": 16, "aov": "Z,N,P,id,tests", "opaque": True}
    wanted |= {"environment": "1,1,0.5", "z-background": "inf", "scene-name": 0}
    assert {name: sent(page).get(name) for name in wanted} == wanted
    page.fill("[name=error]", "0.02")
    assert sent(page)["spp"] == "adaptive:0.02:16"
    page.fill("[name=spp]", "")
    assert sent(page)["spp"] == "adaptive:0.02"
