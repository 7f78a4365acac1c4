# SPDX-License-Identifier: MIT
"""What a visitor can do: send a scene, watch it, play it, look into a frame, read what it cost, stop and remove it."""

from __future__ import annotations

import json
import pathlib
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import sheaf
from conftest import PATIENCE_MS, SCENES, expect, running

Visit = Callable[..., Any]


def send(page, scene: pathlib.Path, frames: str = "0-2") -> None:
    page.set_input_files("#files", scene)
    page.select_option("[name=size]", "320x180")
    page.select_option("[name=quality]", "draft")
    page.click("summary")
    page.select_option("[name=strategy]", "reference")
    page.fill("[name=frames]", frames)
    page.click("#submit")


def test_a_scene_is_sent_watched_and_measured(visit: Visit) -> None:
    page = visit()
    expect(page.locator("#submit")).to_be_disabled()
    page.set_input_files("#files", SCENES / "whitted.glb")
    expect(page.locator("#scene-facts")).to_contain_text("6 meshes")
    expect(page.locator("[name=frames]")).to_have_value("0-95")  # 4 s at 24 frames per second
    assert page.locator("[name=animation] option").all_text_contents()[2:] == ["whitted"]
    send(page, SCENES / "whitted.glb")
    expect(page.locator("#job-title")).to_have_text("whitted.glb")
    expect(page.locator("#job-state")).to_have_text("done")
    expect(page.locator("#job-words")).to_contain_text("3 of 3 frames")
    expect(page.locator("#strip li.done")).to_have_count(3)
    expect(page.locator("#screen")).to_have_attribute("data-frame", "2")
    expect(page.locator("#stages svg rect").first).to_be_attached()
    expect(page.locator("#tests tbody tr")).to_have_count(4)  # all kinds of rays
    assert page.locator("#left-out li").count() >= 1
    expect(page.locator("#jobs button").first).to_have_attribute("aria-current", "true")


def test_frames_arrive_while_one_watches(visit: Visit, client: sheaf.Client) -> None:
    job = client.submit(SCENES / "whitted.glb", frames="0-999", size="320x180", strategy="reference")
    page = visit(f"#job={job.id}")
    expect(page.locator("#job-state")).to_have_text("running")
    expect(page.locator("#strip li.done").nth(2)).to_be_attached()
    page.get_by_role("button", name="Cancel").click()
    expect(page.locator("#job-state")).to_have_text("cancelled")
    page.once("dialog", lambda dialog: dialog.accept())
    page.get_by_role("button", name="Remove").click()
    expect(page.locator("#job-title")).to_have_text("No job chosen")
    with pytest.raises(sheaf.NotFound):
        job.refresh()


def test_a_job_that_ends_while_it_is_cancelled_keeps_its_frames(visit: Visit, client: sheaf.Client) -> None:
    job = client.submit(SCENES / "whitted.glb", frames="0-999", size="320x180", strategy="reference")
    page = visit(f"#job={job.id}")
    expect(page.locator("#strip li.done").nth(1)).to_be_attached()

    def end_before(route) -> None:
        if route.request.method in ("POST", "DELETE"):
            job.cancel()
            with pytest.raises(sheaf.JobCancelled):
                job.wait()
        route.continue_()

    page.route("**/v1/jobs/**", end_before)
    page.get_by_role("button", name="Cancel").click()
    expect(page.locator("#job-state")).to_have_text("cancelled")
    assert next(iter(job.frames())).rgba.shape == (180, 320, 4)


def test_playing_by_mouse_and_keyboard(visit: Visit, done: sheaf.Job) -> None:
    page = visit(f"#job={done.id}")
    screen = page.locator("#screen")
    expect(screen).to_have_attribute("data-frame", "3")
    page.keyboard.press("ArrowLeft")
    expect(screen).to_have_attribute("data-frame", "2")
    page.locator("#strip button", has_text="0").click()
    expect(screen).to_have_attribute("data-frame", "0")
    page.locator("#job").focus()
    page.keyboard.press("Space")
    expect(page.locator("#play")).to_have_text("Pause")
    expect(screen).not_to_have_attribute("data-frame", "0")
    page.click("#play")
    expect(page.locator("#play")).to_have_attribute("aria-pressed", "false")
    page.locator("#scrub").focus()
    page.keyboard.press("Home")
    expect(screen).to_have_attribute("data-frame", "0")


def test_a_frame_is_opened_with_all_its_layers(visit: Visit, done: sheaf.Job) -> None:
    frame = done.frame(3)
    page = visit(f"#job={done.id}")
    page.click("#open")
    expect(page.locator("#pixel")).to_contain_text("64 × 36")
    layers = page.locator("#layer option").all_text_contents()
    assert layers == ["colour", "depth", "normal", "object id", "material id", "tests"]
    pictures = {}
    for layer in layers:
        page.select_option("#layer", layer)
        pictures[layer] = page.locator("#canvas").screenshot()
    assert len(set(pictures.values())) == len(layers)
    box = page.locator("#canvas").bounding_box()
    scale = min(box["width"] / 64, box["height"] / 36)
    left = box["x"] + (box["width"] - 64 * scale) / 2
    top = box["y"] + (box["height"] - 36 * scale) / 2
    page.select_option("#layer", "depth")
    for column, row in ((5, 30), (31, 20), (63, 35)):
        page.mouse.move(left + (column + 0.5) * scale, top + (row + 0.5) * scale)
        expect(page.locator("#pixel")).to_contain_text(f"({column}, {row}): Z ")
        shown = float(page.locator("#pixel").text_content().rsplit(" ", 1)[1])
        np.testing.assert_allclose(shown, frame.layers["Z"][row, column], rtol=1e-4)
    page.select_option("#layer", "colour")
    page.locator("#exposure").fill("3")
    expect(page.locator("#exposure-value")).to_have_text("3.0")
    assert page.locator("#canvas").screenshot() != pictures["colour"]
    page.keyboard.press("Escape")
    expect(page.locator("#viewer")).not_to_be_visible()


def test_two_jobs_side_by_side(visit: Visit, client: sheaf.Client, done: sheaf.Job) -> None:
    settings: dict[str, Any] = {"size": "64x36", "strategy": "reference", "primary": "trace"}
    client.submit(SCENES / "cornell.glb", frames=0, **settings).wait(timeout=PATIENCE_MS / 1000)
    page = visit(f"#job={done.id}")
    expect(page.locator("#tests tbody tr")).to_have_count(4)
    option = page.locator("#compare option", has_text="cornell.glb, reference traced").first
    page.select_option("#compare", option.get_attribute("value"))
    expect(page.locator("#tests tbody tr").nth(4)).to_be_attached()


def test_refusals_are_shown_in_words(visit: Visit, tmp_path: pathlib.Path) -> None:
    bad = tmp_path / "bad.glb"
    bad.write_bytes(b"this is no scene")
    page = visit()
    page.set_input_files("#files", bad)
    page.click("#submit")
    expect(page.get_by_role("alert").filter(has_text=re.compile("glTF|glb|scene", re.I)).first).to_be_visible()
    page.set_input_files("#files", [__file__])
    expect(page.locator("#new-error")).to_contain_text("None of these is a scene")
    expect(page.locator("#submit")).to_be_disabled()
    page.goto(page.url.split("#")[0] + f"#job={'a' * 26}")
    page.reload()
    expect(page.locator("#job-hint")).to_contain_text("no job")


def test_a_token_is_asked_for_and_serves_everything(visit: Visit, guarded: tuple[str, str]) -> None:
    """The list, the upload, the event stream, pictures and stats: each carries it."""
    address, token = guarded
    page = visit(at=address)
    expect(page.locator("#token-dialog")).to_be_visible()
    page.fill("#token", "wrong")
    page.keyboard.press("Enter")
    expect(page.locator("#token-dialog")).to_be_visible()
    page.fill("#token", token)
    page.keyboard.press("Enter")
    expect(page.locator("#jobs")).to_contain_text("None yet.")
    send(page, SCENES / "cornell.glb", "0-1")
    expect(page.locator("#job-state")).to_have_text("done")
    expect(page.locator("#screen")).to_have_attribute("data-frame", "1")
    expect(page.locator("#tests tbody tr").first).to_be_attached()
    page.click("#open")
    expect(page.locator("#pixel")).to_contain_text("320 × 180")
    with page.expect_download() as download:
        page.keyboard.press("Escape")
        page.get_by_role("button", name="All frames").click()
    assert download.value.suggested_filename == "cornell.glb.zip"


def test_everything_has_a_name_and_is_reached_by_keyboard(visit: Visit, done: sheaf.Job) -> None:
    page = visit(f"#job={done.id}")
    expect(page.locator("#stats")).to_be_visible()
    nameless = page.evaluate(
        """() => [...document.querySelectorAll("button, input, select")].filter((each) => each.offsetParent &&
          !(each.labels?.length || each.getAttribute("aria-label") || each.textContent.trim()))
          .map((each) => each.outerHTML)"""
    )
    assert nameless == []
    reached = []
    for _ in range(60):
        page.keyboard.press("Tab")
        reached.append(page.evaluate("document.activeElement.id || document.activeElement.name"))
    for name in ("files", "frames", "size", "quality", "play", "scrub", "open", "compare"):
        assert name in reached, name


def study(**more: object) -> dict:
    """A report as `sheaf-client report` writes it, with what the page reads."""

    def trial(label: str, milliseconds: float | None, rmse: float | None, front: bool, name: str | None = None) -> dict:
        wall = milliseconds and {
            "median": milliseconds,
            "low": milliseconds,
            "high": milliseconds,
            "runs": [milliseconds],
        }
        error = (rmse is not None and {"rmse": rmse, "worst": "inf"}) or None
        pareto = {"time": front, "tests": False}
        return {"label": label, "name": name, "wall_ms": wall, "error": error, "pareto": pareto, "failure": None}

    knobs = [
        trial("spp 1", 12.0, 0.2, True, "draft"),
        trial("spp 4", 40.0, 0.05, True, "production"),
        trial("spp 4, depth 9", 90.0, 0.06, False),
        trial("spp 16", 700.0, 0.0004, True, "exact"),
        trial("equal", 900.0, 0.0, True),
        trial("failed", None, None, False),
    ]
    scenes = [{"scene": "whitted", "knobs": knobs, "strategies": []}, {"scene": "empty", "knobs": [], "strategies": []}]
    return {
        "schema": 1,
        "made": "2031-02-03",
        "device": {"name": "a device"},
        "options": {"size": "64x36"},
        "scenes": scenes,
    }


def check_plot(page) -> None:
    expect(page.locator("#report")).to_be_visible()
    assert page.locator("#report-scene option").all_text_contents() == ["whitted"]
    expect(page.locator("#report-made")).to_have_text("a device · 64x36 · 2031-02-03")
    expect(page.locator("#report-plot circle")).to_have_count(4)  # an error of 0 has no place on a logarithmic axis
    across = page.evaluate(
        """[...document.querySelectorAll("#report-plot circle")]
          .map((dot) => [+dot.getAttribute("cx"), +dot.getAttribute("cy")])"""
    )
    # Logarithmic both ways: twice the share is twice the distance.
    (x1, y1), (x4, y4), _, (x16, y16) = across
    assert (x16 - x1) / (x4 - x1) == pytest.approx(np.log(700 / 12) / np.log(40 / 12), rel=1e-3)
    assert (y16 - y1) / (y4 - y1) == pytest.approx(np.log(0.2 / 0.0004) / np.log(0.2 / 0.05), rel=1e-3)
    rows = page.locator("#report-plot tbody tr").all_text_contents()
    assert len(rows) == 4
    assert rows[0].startswith("draft: spp 1")
    assert rows[3].endswith("0.00")


def test_a_report_is_shown_when_it_is_dropped(visit: Visit, tmp_path: pathlib.Path) -> None:
    (tmp_path / "report.json").write_text(json.dumps(study()))
    page = visit()
    expect(page.locator("#report")).not_to_be_visible()
    page.set_input_files("#files", tmp_path / "report.json")
    check_plot(page)
    expect(page.locator("#submit")).to_be_disabled()  # it is no scene, and no complaint either
    expect(page.locator("#new-error")).not_to_be_visible()
    page.set_input_files("#files", [SCENES / "cornell.glb", tmp_path / "report.json"])
    expect(page.locator("#submit")).to_be_enabled()
    assert "report.json" not in page.locator("#drop-text").text_content()


def test_the_services_own_report(visit: Visit, tmp_path: pathlib.Path) -> None:
    (tmp_path / "report.json").write_text(json.dumps(study()))
    with running(tmp_path / "data", "--report", str(tmp_path / "report.json")) as address:
        page = visit(at=address)
        check_plot(page)
