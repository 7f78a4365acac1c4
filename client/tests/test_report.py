# SPDX-License-Identifier: MIT
"""Studies of a fake engine: what is measured, what is concluded, and what stands in the files."""

from __future__ import annotations

import csv
import io
import itertools
import json
import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fake_sheaf
from sheaf._program import Outcome, Program, find_program, option_list
from sheaf.cli import main
from sheaf.report import Study, StudyOptions, study, write_report, write_sample
from sheaf.report._errors import compare, pareto
from sheaf.report._measure import Trial
from sheaf.report._plan import Point
from sheaf.report._sample import ball
from sheaf.report._stability import stability
from sheaf.report._tables import csv_tables, json_text

SMALL = StudyOptions(
    size="16x8", repeats=2, spp=(1, 2), depth=(1, 2), cutoff=(), memory=(), reference_spp=8, strategies=("bvh",)
)
ALL = ("bvh", "crsh", "rsh")


class Engine(Program):
    """The fake in this very process."""

    def render(self, scene: Any, out: Path, settings: Mapping[str, object], **limits: Any) -> Outcome:
        options = [re.fullmatch(r"--([a-z-]+)(?:=(.*))?", text) for text in option_list(settings)]
        try:
            fake_sheaf.render(Path(scene), out, {match[1]: match[2] or "yes" for match in options if match})
        except SystemExit as end:
            return Outcome(int(end.code or 0), 0.1, "sheaf: made to fail")
        return Outcome(0, 0.1)


ENGINE = Engine(Path("sheaf"), "sheaf 9.9.9", ALL, frozenset({"spp", "depth"}), ("draft", "production"))


def found(options: StudyOptions = SMALL, scene: str = "report-moving.glb", **more: Any) -> dict[str, Any]:
    """What a study of a scene finds, as its document says."""
    told: dict[str, Any] = json.loads(json_text(study(ENGINE, [Path(scene)], options=replace(options, **more))))
    return told


@pytest.fixture(scope="module")
def whole() -> Study:
    return study(ENGINE, [Path("report <b>&.glb")], options=replace(SMALL, strategies=ALL))


def test_all_files_are_there_and_agree(whole: Study, tmp_path: Path) -> None:
    paths = write_report(whole, tmp_path)
    assert sorted(paths) == sorted(tmp_path.iterdir())
    assert paths[0].name == "report.html"
    document = json.loads((tmp_path / "report.json").read_text())
    scene = document["scenes"][0]
    assert document["schema"] == 1
    assert document["versions"]["sheaf"] == "9.9.9"
    assert {"processor", "cores", "system"} <= set(document["machine"])
    assert scene["skipped"] == []
    expected = "bvh, crsh sort on, crsh sort off, rsh, crsh sort on primary trace, bvh primary trace"
    assert ", ".join(trial["label"] for trial in scene["strategies"]) == expected
    rows = list(csv.DictReader(io.StringIO((tmp_path / "trials.csv").read_text())))
    trials = scene["strategies"] + scene["memory"] + scene["knobs"]
    assert [row["label"] for row in rows] == [trial["label"] for trial in trials]
    assert [float(row["rmse"]) for row in rows] == [trial["error"]["rmse"] for trial in trials]
    for name in ("error-time", "error-tests", "rays-per-second", "stages", "tests-per-ray", "tests-by-level"):
        assert (tmp_path / f"report <b>&-{name}.png").read_bytes().startswith(b"\x89PNG\r\n\x1a\n")
    check_page((tmp_path / "report.html").read_text())


def test_warm_up_is_left_out_and_the_median_taken() -> None:
    bvh = found()["scenes"][0]["strategies"][0]
    assert bvh["wall_ms"] == {"median": 15.5, "low": 15.0, "high": 16.0, "runs": [15.0, 16.0]}  # not the first, 14
    assert bvh["rays_per_second"] == pytest.approx(240 / 15.5 * 1000)


def test_a_scene_that_stands_still_is_timed_by_a_process_a_run() -> None:
    bvh = found(scene="report-still.glb")["scenes"][0]["strategies"][0]
    assert bvh["wall_ms"]["runs"] == [14.0, 14.0]  # a repeated frame's time is no rendering's


def test_errors_fronts_and_named_settings() -> None:
    scene = found()["scenes"][0]
    knobs = {(trial["settings"].get("spp"), trial["settings"].get("depth")): trial for trial in scene["knobs"]}
    # Wrong by 0.1/spp + 0.05/(depth + 1); the reference by 0.05/17; in half precision.
    assert knobs[(2, 1)]["error"]["rmse"] == pytest.approx(0.05 + 0.025 - 0.05 / 17, rel=0.01)
    assert knobs[(2, 1)]["error"]["worst"] == pytest.approx(0.075 - 0.05 / 17, abs=1e-3)
    assert 0 < knobs[(2, 1)]["error"]["flip"] < 1
    # What the program itself names, by its own meaning.
    assert [trial["name"] for trial in scene["knobs"][:3]] == ["draft", "production", None]
    assert [trial["settings"] for trial in scene["knobs"][:2]] == [
        {"strategy": "bvh", "quality": name} for name in ("draft", "production")
    ]
    assert scene["knobs"][1]["error"]["rmse"] == pytest.approx(0.025 + 0.05 / 7 - 0.05 / 17, rel=0.01)
    assert knobs[(1, 1)]["pareto"] == {"time": True, "tests": True}  # the cheapest of all
    assert scene["strategies"][1]["pareto"]["tests"] is False  # the same error for more


def test_the_program_says_which_settings_are_named() -> None:
    assert find_program(fake_sheaf.__file__).qualities == ("draft", "production", "exact")


def test_further_knobs_are_tried() -> None:
    labels = [trial["label"] for trial in found(knobs={"key-bits": ("16", "32")})["scenes"][0]["knobs"]]
    assert {"bvh spp 2 depth 2 key-bits 16", "bvh spp 2 depth 2 key-bits 32"} <= set(labels)


def test_savings_are_those_of_the_counts(whole: Study) -> None:
    tables = {name: list(csv.DictReader(io.StringIO(text))) for name, text in csv_tables(whole).items()}
    savings = {row["part"]: row for row in tables["savings.csv"]}
    # 100 shadow rays: 2 node tests each with sorting, 3 without, and one triangle test whichever way.
    assert float(savings["sorting, in crsh"]["saved_shadow"]) == pytest.approx(1 - 201 / 301)
    assert float(savings["rasterising, in crsh"]["saved_primary"]) == pytest.approx(1 - 1 / 201)
    levels = [row for row in tables["levels.csv"] if (row["part"], row["kind"]) == ("sorting, in crsh", "shadow")]
    assert (levels[0]["level"], levels[0]["tests_whole"], levels[0]["tests_without"]) == ("0", "100", "150")


class _Page(HTMLParser):
    """What a page would fetch, and whether its tags pair up."""

    def __init__(self) -> None:
        super().__init__()
        self.fetched: list[str] = []
        self.open: list[str] = []
        self.anchors: list[str] = []
        self.ids: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.fetched += [value for name in ("src", "srcset") if (value := given.get(name))]
        self.ids += [value for value in [given.get("id")] if value]
        if tag == "a" and (target := given.get("href")):
            self.anchors.append(target)
        if tag not in ("meta", "img", "source", "link", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def check_page(text: str) -> None:
    """Nothing is fetched, tags pair up, links lead somewhere, and what it should say is there."""
    page = _Page()
    page.feed(text)
    assert page.open == []
    assert page.fetched
    assert all(source.startswith("data:image/png;base64,") for source in page.fetched)
    assert page.anchors
    assert {anchor.removeprefix("#") for anchor in page.anchors} <= set(page.ids)
    assert "report &lt;b&gt;&amp;" in text
    assert "url(" not in text
    for words in ("draft", "Pareto front", "same again", "llvmpipe (made up)", "9.9.9"):
        assert words in text


def test_what_there_is_no_time_for_is_listed(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = found(minutes=1e-9)["scenes"][0]
    assert "time was over" in scene["failure"]
    ticks = itertools.count()  # a clock of a second a look: the time is over in the midst of the work
    monkeypatch.setattr("sheaf.report._measure.time.monotonic", lambda: float(next(ticks)))
    scene = found(minutes=0.6, strategies=ALL)["scenes"][0]
    assert scene["failure"] is None
    assert scene["skipped"]
    labels = [trial["label"] for trial in scene["strategies"] + scene["knobs"]]
    assert not set(labels) & set(scene["skipped"])


def test_a_scene_that_fails_costs_no_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FAKE_SHEAF_FAULTS", str(tmp_path))
    (tmp_path / "fail-0-3").touch()
    result = study(ENGINE, [Path("report-bad.glb"), Path("report-good.glb")], options=SMALL)
    assert result.scenes[0].failure == "sheaf: made to fail"
    assert result.scenes[1].failure is None
    assert {row.scene for row in result.stability} == {"report-good"}


def test_pixels_that_are_no_numbers_are_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FAKE_SHEAF_FAULTS", str(tmp_path))
    (tmp_path / "always-nan").touch()
    result = study(ENGINE, [], [Path("report-bad.glb")], SMALL)
    assert [row.finite for row in result.stability] == [False, False]
    assert not any(row.is_good for row in result.stability)
    assert write_report(result, tmp_path / "out")


def test_stability_compares_bits_and_hits() -> None:
    right = np.full((2, 3, 3), 0.5, np.float32)
    other = right.copy()
    other[1, 2, 0] = np.nextafter(np.float32(0.5), np.float32(1))
    depth = np.ones((2, 3), np.float32)
    ids = np.ones((2, 3), np.uint32)

    def trial(strategy: str, picture: Any, z: Any, **more: Any) -> Trial:
        return Trial(Point({"strategy": strategy}), picture=picture, hits={"Z": z, "id.object": ids}, **more)

    far = depth.copy()
    far[0, 0], far[0, 1] = 1.001, np.inf
    trials = [trial("bvh", right, depth, same_again=True), trial("rsh", other, far, same_again=False)]
    trials.append(Trial(Point({"strategy": "crsh"}), failure="it broke"))
    rows = stability("box", trials, trial("reference", right, depth))
    assert [row.other_pixels for row in rows] == [0, 1, None]
    assert [row.other_hits for row in rows] == [0, 2, None]
    assert [row.is_good for row in rows] == [True, False, False]
    assert rows[2].ended == "it broke"


def test_compare() -> None:
    reference = np.zeros((4, 5, 3), np.float32)
    reference[...] = 0.5
    picture = reference.copy()
    assert compare(picture, reference).rmse == compare(picture, reference).worst == 0
    picture[2, 3] = (0.5, 1.5, 0.5)
    errors = compare(picture, reference)
    assert errors.rmse == pytest.approx((1 / 60) ** 0.5)
    assert errors.relative_mse == pytest.approx(1 / 60 / 0.26)
    assert (errors.worst, errors.worst_at) == (1.0, (3, 2))
    assert errors.flip is not None
    assert errors.flip > 0
    picture[0, 0, 0] = np.nan
    assert compare(picture, reference).worst_at == (0, 0)
    assert compare(picture, reference).worst == np.inf
    with pytest.raises(ValueError, match="cannot be compared"):
        compare(picture[1:], reference)
    assert compare(np.zeros((8, 8, 3), np.float32), np.zeros((8, 8, 3), np.float32)).flip == 0


def test_pareto() -> None:
    assert pareto([(1, 5), (2, 2), (3, 3), (2, 2), (5, 1), (1, 6)]) == [True, True, False, True, True, False]
    assert pareto([]) == []


@pytest.fixture
def command(tmp_path: Path) -> Callable[..., int]:
    """The command, over the fake as a program of its own."""
    program = tmp_path / "sheaf"
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{fake_sheaf.__file__}" "$@"\n')
    program.chmod(0o755)

    def run(*arguments: str) -> int:
        try:
            return main(["report", "--out", str(tmp_path / "out"), "--sheaf", str(program), *arguments])
        except SystemExit as end:
            return int(end.code or 0)

    return run


def test_the_command(command: Callable[..., int], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "report.glb"
    scene.touch()
    small = "--size 16x8 --repeats 1 --spp 1 --depth 1 --cutoff 0 --memory 1 --strategies bvh --camera-node 2"
    assert command(str(scene), *small.split(), "--progress", "json") == 0
    events = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert events[0] == {"event": "progress", "step": "report: reference", "fraction": 0.0}
    assert events[-1]["event"] == "done"
    document = json.loads((tmp_path / "out" / "report.json").read_text())
    assert document["options"]["common"] == {"camera-node": "2"}
    assert document["stability"]
    assert all(row["good"] for row in document["stability"])


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        ("--spp a", 2),
        ("--repeats 0", 2),
        ("--knob key-bits", 2),
        ("--spp ,", 2),
        ("--sheaf /no/such/program", 6),
        ("/no/such/scene.glb", 3),
    ],
)
def test_wrong_usage(command: Callable[..., int], arguments: str, code: int) -> None:
    assert command(*arguments.split()) == code


def test_the_sample_is_closed_and_always_the_same(tmp_path: Path) -> None:
    assert write_sample(tmp_path / "a.glb").read_bytes() == write_sample(tmp_path / "b.glb").read_bytes()
    points, faces = ball()
    assert len(faces) == 8 * 4**3
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    # Every edge is there once in either direction, and every face looks outward.
    assert len(np.unique(edges, axis=0)) == len(edges) == 3 * len(faces)
    np.testing.assert_array_equal(np.unique(edges, axis=0), np.unique(edges[:, ::-1], axis=0))
    a, b, c = (points[faces[:, corner]] for corner in range(3))
    assert np.all(np.einsum("ij,ij->i", np.cross(b - a, c - a), a + b + c) > 0)
