# SPDX-License-Identifier: MIT
"""`--stats`: the schema's keys, counts that add up, what was left out and why, frames that repeat."""

import json

import pytest

from rendering import SCENES

KINDS = {"primary", "shadow", "reflection", "refraction"}
STAGES = {
    "animate", "objects", "raster", "generate", "hash", "compress", "sort", "decompress", "rays_hierarchy",
    "traverse", "compact", "intersect", "shade", "resolve", "write",
}  # fmt: skip
SIZE = (64, 36)


@pytest.fixture(scope="module")
def cornell(sheaf_once) -> dict:
    """The stats of one small picture by each strategy."""
    names = ("brute", "bvh", "hybrid", "crsh", "rsh", "frustum", "classify")
    runs = sheaf_once.all(
        {"scene": "cornell", "strategy": name, "stats": True, "options": ("--spp", 2)} for name in names
    )
    return {name: run.stats() for name, run in zip(names, runs, strict=True)}


@pytest.mark.parametrize("strategy", ["brute", "bvh", "hybrid", "crsh", "rsh", "frustum", "classify"])
def test_schema(cornell, strategy):
    stats = cornell[strategy]
    assert stats["schema"] == 1
    assert {"version", "device", "strategy", "chosen_because", "scene", "left_out", "frames", "totals"} <= stats.keys()
    assert stats["strategy"] == strategy
    assert stats["device"]["name"]
    assert stats["device"]["driver"]
    assert {"triangles", "instances", "meshes", "lights", "materials", "features"} <= stats["scene"].keys()
    assert stats["scene"]["triangles"] == 2504
    assert stats["scene"]["meshes"] == 10
    assert stats["scene"]["lights"] == 1
    (frame,) = stats["frames"]
    assert {
        "frame", "time_s", "wall_ms", "peak_device_mib", "stages", "rays", "hits", "tests", "generations",
    } <= frame.keys()  # fmt: skip
    assert set(frame["stages"]) <= STAGES
    assert {"raster", "generate", "shade", "resolve", "write"} <= set(frame["stages"])
    assert all(ms >= 0 for ms in frame["stages"].values())
    assert 0 < sum(ms for stage, ms in frame["stages"].items() if stage != "write") < 1.5 * frame["wall_ms"] + 5
    assert set(frame["rays"]) == set(frame["hits"]) == KINDS
    assert {"brute_force", "node_object", "node_object_by_level", "ray_box", "ray_triangle"} <= frame["tests"].keys()
    assert frame["peak_device_mib"] > 1


def test_rays_are_the_same_whatever_finds_their_hits(cornell):
    first = cornell["brute"]["frames"][0]
    assert first["rays"]["primary"] == SIZE[0] * SIZE[1] * 2
    assert all(0 < first["hits"][kind] <= first["rays"][kind] for kind in KINDS)
    for stats in cornell.values():
        frame = stats["frames"][0]
        assert frame["rays"] == first["rays"]
        assert {k: v for k, v in frame["hits"].items() if k != "shadow"} == {
            k: v for k, v in first["hits"].items() if k != "shadow"
        }
        assert frame["tests"]["brute_force"] == sum(frame["rays"].values()) * 2504


def test_brute_force_tests_every_triangle_for_every_ray(cornell):
    frame = cornell["brute"]["frames"][0]
    tests = frame["tests"]["ray_triangle"]
    for kind in ("reflection", "refraction"):
        assert tests[kind] == frame["rays"][kind] * 2504
    assert 0 < tests["shadow"] <= frame["rays"]["shadow"] * 2504


def test_hierarchies_test_less(cornell):
    for name in ("bvh", "hybrid", "crsh", "frustum", "classify"):
        frame, totals = cornell[name]["frames"][0], cornell[name]["totals"]
        for kind in ("shadow", "reflection", "refraction"):
            assert 0 < frame["tests"]["ray_triangle"][kind] < 0.7 * frame["rays"][kind] * 2504, (name, kind)
        assert 0 < totals["reduction_vs_brute_force"] < 1
        assert totals["tests_per_ray"] < 2504


@pytest.mark.parametrize("strategy", ["hybrid", "crsh", "rsh", "frustum", "classify"])
def test_levels_add_up(cornell, strategy):
    """Node tests by level, root first, sum to the tests of their kind."""
    tests = cornell[strategy]["frames"][0]["tests"]
    for kind, levels in tests["node_object_by_level"].items():
        assert sum(levels) == tests["node_object"][kind], kind
    spent = tests["node_object"] if strategy != "hybrid" else tests["ray_box"]  # loose bundles go ray by ray
    assert sum(spent.values()) > 0


@pytest.mark.parametrize("strategy", ["hybrid", "crsh", "rsh", "frustum", "classify"])
def test_generations_tell_what_was_built(cornell, strategy):
    frame = cornell[strategy]["frames"][0]
    assert frame["generations"]
    for kind in ("shadow", "reflection", "refraction"):
        of_kind = [g for g in frame["generations"] if g["kind"] == kind]
        assert sum(g["rays"] for g in of_kind) == frame["rays"][kind]
        assert all(isinstance(g["sorted"], bool) and g["rays"] >= g["chunks"] >= 0 for g in of_kind)


def test_totals_are_sums(sheaf):
    run = sheaf.render("whitted", "--frames", "0-2", stats=True, strategy="hybrid")
    stats = run.stats()
    frames, totals = stats["frames"], stats["totals"]
    assert [f["frame"] for f in frames] == [0, 1, 2]
    assert [f["time_s"] for f in frames] == pytest.approx([0, 1 / 24, 2 / 24])
    for kind in KINDS:
        assert totals["rays"][kind] == sum(f["rays"][kind] for f in frames)
        assert totals["hits"][kind] == sum(f["hits"][kind] for f in frames)
    assert totals["wall_ms"] == pytest.approx(sum(f["wall_ms"] for f in frames))
    assert totals["rays_per_second"] == pytest.approx(
        sum(sum(f["rays"].values()) for f in frames) / (totals["wall_ms"] / 1000)
    )
    for stage, ms in totals["stages"].items():
        assert ms == pytest.approx(sum(f["stages"].get(stage, 0) for f in frames)), stage
    assert {"skins", "morphs", "moving nodes"} <= set(stats["scene"]["features"])
    assert "animate" in frames[1]["stages"]


def test_still_scenes_are_traced_once(sheaf):
    run = sheaf.render("cornell", "--frames", "3-6", stats=True)
    stats = run.stats()
    assert [f["repeated"] for f in stats["frames"]] == [False, True, True, True]
    assert [f["frame"] for f in stats["frames"]] == [3, 4, 5, 6]
    assert not any(f["stages"].keys() - {"write"} for f in stats["frames"][1:])
    first = run.frame(3)
    for number in (4, 5, 6):
        picture = run.frame(number)
        assert (picture.rgba == first.rgba).all()
        assert picture.header["sheaf:frame"] == number
    moving = sheaf.render("interpolation", "--frames", "0-1", stats=True).stats()
    assert [f["repeated"] for f in moving["frames"]] == [False, False]


def left_out(sheaf, scene: str, *options: object, strategy="bvh") -> dict:
    stats = sheaf.render(scene, *options, stats=True, strategy=strategy, size="16x9").stats()
    return {item["stage"]: item["reason"] for item in stats["left_out"]}


def test_what_a_scene_does_not_need_is_left_out_and_said(sheaf):
    plain = left_out(sheaf, "unlit")
    assert {"reflection", "refraction", "media", "animate", "deform", "normal maps", "alpha test"} <= set(plain)
    assert all(reason.strip() for reason in plain.values())
    rich = left_out(sheaf, "whitted", "--sort", "on", strategy="hybrid")
    assert not {"reflection", "refraction", "media", "animate", "deform", "sort", "rays_hierarchy"} & set(rich)
    unsorted = left_out(sheaf, "whitted", "--sort", "off", strategy="hybrid")
    assert unsorted["sort"] == "--sort off"
    assert "costs more" in left_out(sheaf, "whitted", strategy="hybrid")["sort"]
    assert "sort" not in left_out(sheaf, "whitted", strategy="crsh")
    shallow = left_out(sheaf, "whitted", "--depth", 0)
    assert "--depth 0" in shallow["reflection"]
    assert "raster" in left_out(sheaf, "unlit", "--primary", "trace")
    assert "alpha test" not in left_out(sheaf, "alpha_mask")


def test_a_stage_left_out_costs_nothing(sheaf):
    """Neither rays nor times of what is not there."""
    frame = sheaf.render("point_light", stats=True, strategy="hybrid").stats()["frames"][0]
    assert frame["rays"]["reflection"] == frame["rays"]["refraction"] == 0
    unsorted = sheaf.render("cornell", "--sort", "off", stats=True, strategy="hybrid").stats()["frames"][0]
    assert not {"sort", "compress"} & set(unsorted["stages"])
    traced = sheaf.render("cornell", "--primary", "trace", stats=True).stats()["frames"][0]
    assert "raster" not in traced["stages"]
    assert traced["tests"]["ray_triangle"]["primary"] > 0


def test_ignored_extensions_are_named(sheaf, tmp_path):
    data = (SCENES / "unlit.glb").read_bytes()
    length = int.from_bytes(data[12:16], "little")
    document = json.loads(data[20 : 20 + length])
    document["extensionsUsed"].append("VENDOR_sparkle")
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    path = tmp_path / "sparkle.glb"
    path.write_bytes(
        b"glTF"
        + (2).to_bytes(4, "little")
        + (20 + len(text) + len(rest)).to_bytes(4, "little")
        + len(text).to_bytes(4, "little")
        + b"JSON"
        + text
        + rest
    )
    run = sheaf.render(path, stats=True, size="16x9")
    assert "VENDOR_sparkle" in run.stderr
    assert "VENDOR_sparkle" in json.dumps(run.stats()["scene"])
    assert "VENDOR_sparkle" in json.dumps(json.loads(sheaf("inspect", path, "--json").stdout))


def test_stats_elsewhere(sheaf, tmp_path):
    """A file in a folder that is not there is an error that names it, not a lost run."""
    run = sheaf.render("unlit", "--stats", tmp_path / "nowhere" / "stats.json", size="16x9", code=6)
    assert "stats.json" in run.stderr


@pytest.mark.parametrize("strategy", ["crsh", "rsh", "frustum", "classify"])
def test_pairs_of_every_level_are_told(cornell, strategy):
    """Root first. A pair of a node that has fewer than four children is made, and found not to be there: no test."""
    frame = cornell[strategy]["frames"][0]
    pairs = [g["pairs_per_level"] for g in frame["generations"]]
    assert all(len(levels) > 1 and min(levels) > 0 for levels in pairs)
    tests = sum(frame["tests"]["node_object"].values())
    assert tests <= sum(map(sum, pairs)) < 1.2 * tests


def test_no_pairs_where_no_levels_are_walked(cornell):
    assert all(not g["pairs_per_level"] for g in cornell["bvh"]["frames"][0]["generations"])
