# SPDX-License-Identifier: MIT
"""The page on a phone, light and dark: nothing sticks out, everything can be hit, wide tables scroll by themselves."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import pytest

import sheaf
from conftest import expect

Visit = Callable[..., Any]


@pytest.fixture(
    params=[(360, "light"), (360, "dark"), (390, "light"), (390, "dark")], ids=lambda each: "-".join(map(str, each))
)
def phone(visit: Visit, done: sheaf.Job, request: pytest.FixtureRequest):
    """The page with a job's measurements, on a phone of this width, in this scheme."""
    width, scheme = request.param
    size = {"viewport": {"width": width, "height": 740}, "is_mobile": True, "has_touch": True}
    page = visit(f"#job={done.id}", color_scheme=scheme, **size)
    expect(page.locator("#stats")).to_be_visible()
    ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (sum(map(int, re.findall(r"\d+", ground)[:3])) < 300) == (scheme == "dark")
    return page


def check_fits(page) -> None:
    """No sideways scrolling, and nothing out of reach: only what is in a box of its own may be wider."""
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    beyond = page.evaluate(
        """() => [...document.querySelectorAll("body *")].filter((each) => each.checkVisibility() &&
          !each.closest(".wide > *, .skip") && each.getBoundingClientRect().right > innerWidth + 0.5)
          .map((each) => each.outerHTML)"""
    )
    assert beyond == []


def test_nothing_sticks_out_and_everything_can_be_hit(phone) -> None:
    phone.tap("summary")
    check_fits(phone)
    small = phone.evaluate(
        """() => [...document.querySelectorAll("button, select, summary")].filter((each) => each.offsetParent)
          .map((each) => each.getBoundingClientRect()).filter((box) => box.height < 24 || box.width < 24).length"""
    )
    assert small == 0
    phone.tap("#open")
    expect(phone.locator("#pixel")).to_contain_text("64 × 36")
    assert phone.evaluate("document.querySelector('#viewer').scrollWidth <= innerWidth")


def test_the_table_of_tests_fits(phone) -> None:
    assert phone.locator("#tests th").count() == 5
    assert phone.evaluate(
        "document.querySelector('#tests .wide').scrollWidth <= document.querySelector('#tests .wide').clientWidth"
    )


def test_a_wide_table_scrolls_in_its_own_box(phone) -> None:
    levels = [{"tests": {"node_object_by_level": {kind: [123456] * 9 for kind in ("shadow", "reflection")}}}]
    phone.evaluate("(frames) => levelTable([{ label: 'a strategy', stats: { frames } }])", levels)
    box = phone.get_by_role("region", name="Tests by level")
    assert box.evaluate("(box) => box.scrollWidth > box.clientWidth")
    check_fits(phone)
    box.focus()
    box.evaluate("(box) => { box.scrollLeft = box.scrollWidth; }")
    cells = box.evaluate(
        """(box) => [...box.querySelectorAll("tbody tr:first-child td")].map((cell) => cell.getBoundingClientRect())
          .map(({ left, right }) => [left, right])"""
    )
    assert cells[0][0] >= 0  # whose numbers they are stays in sight
    assert cells[-1][1] <= phone.evaluate("innerWidth")
