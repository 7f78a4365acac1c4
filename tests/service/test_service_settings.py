# SPDX-License-Identifier: MIT
"""A job's settings: how they reach the worker, and which are refused."""

from collections.abc import Callable

import pytest

from service import Service, arguments, check_problem, gltf


def test_settings_become_the_workers_arguments(sheafd: Service) -> None:
    settings = {
        "frames": [1, 2],
        "fps": 25,
        "animation": "Walk",
        "camera-node": 1,
        "size": [32, 18],
        "quality": "draft",
        "spp": "adaptive:0.01:64",
        "filter": "triangle",
        "depth": 3,
        "cutoff": 0.01,
        "strategy": "hybrid",
        "sort": "on",
        "primary": "trace",
        "instances": "shared",
        "aov": ["Z", "N"],
        "z-background": "inf",
        "compression": "piz",
        "name": "shot.####.exr",
        "memory": 512,
        "device": 0,
        "scene-name": "Night",
        "variant": 1,
        "environment": [0.5, 1, 2.5],
        "count": "on",
        "opaque": True,
        "preview": False,
    }
    job = sheafd.accepted(gltf(), settings)
    assert sheafd.wait(job)["state"] == "done"
    told = arguments(sheafd, job, 1)
    assert told[0] == "render"
    assert told[1].endswith("/scene/scene.gltf")
    assert told[told.index("--progress") + 1] == "json"
    assert sorted(a for a in told[2:] if "=" in a or a == "--opaque") == sorted(
        [
            "--frames=1,2", "--fps=25", "--animation=Walk", "--camera-node=1", "--size=32x18",
            "--quality=draft", "--spp=adaptive:0.01:64", "--filter=triangle", "--depth=3", "--cutoff=0.01",
            "--strategy=hybrid", "--sort=on", "--primary=trace", "--instances=shared", "--z-background=inf",
            "--aov=Z,N", "--compression=piz", "--name=shot.####.exr", "--memory=512", "--device=0", "--opaque",
            "--scene-name=Night", "--variant=1", "--environment=0.5,1,2.5", "--count=on",
        ]
    )  # fmt: skip
    assert "--preview" not in told
    check_problem(sheafd.http.get(f"/v1/jobs/{job}/frames/1.png"), 404, "not-produced")


@pytest.mark.parametrize(
    ("settings", "slug", "pointer"),
    [
        ({"colour": 1}, "bad-settings", "/colour"),
        ({"out": "/etc"}, "bad-settings", "/out"),
        ({"stats": "x"}, "bad-settings", "/stats"),
        ({"dump": "x"}, "bad-settings", "/dump"),
        ({"resume": True}, "bad-settings", "/resume"),
        ({"frames": "8-4"}, "bad-settings", "/frames"),
        ({"frames": []}, "bad-settings", "/frames"),
        ({"frames": [1.5]}, "bad-settings", "/frames"),
        ({"frames": "0-10000"}, "limit-exceeded", "/frames"),
        ({"size": "640"}, "bad-settings", "/size"),
        ({"size": "640x"}, "bad-settings", "/size"),
        ({"size": "0x4"}, "bad-settings", "/size"),
        ({"size": "65535x65535"}, "limit-exceeded", "/size"),
        ({"size": "99999999999999999999x1"}, "bad-settings", "/size"),
        ({"spp": 0}, "bad-settings", "/spp"),
        ({"spp": -1}, "bad-settings", "/spp"),
        ({"spp": "4"}, "bad-settings", "/spp"),
        ({"spp": "adaptive:"}, "bad-settings", "/spp"),
        ({"spp": "adaptive:nan"}, "bad-settings", "/spp"),
        ({"spp": "adaptive:0.01:4"}, "bad-settings", "/spp"),
        ({"spp": "adaptive:0.01:100000"}, "limit-exceeded", "/spp"),
        ({"quality": "best"}, "bad-settings", "/quality"),
        ({"filter": "sinc"}, "bad-settings", "/filter"),
        ({"spp": 1e9}, "bad-settings", "/spp"),
        ({"spp": 1000000}, "limit-exceeded", "/spp"),
        ({"cutoff": 2}, "bad-settings", "/cutoff"),
        ({"fps": 0}, "bad-settings", "/fps"),
        ({"fps": "24/0"}, "bad-settings", "/fps"),
        ({"strategy": "fast"}, "bad-settings", "/strategy"),
        ({"aov": "Z;rm"}, "bad-settings", "/aov"),
        ({"aov": "Z,motion"}, "bad-settings", "/aov"),
        ({"aov": "N", "compression": "dwaa"}, "bad-settings", "/compression"),
        ({"instances": "both"}, "bad-settings", "/instances"),
        ({"memory": 15}, "bad-settings", "/memory"),
        ({"camera": "path.json"}, "bad-settings", "/camera"),
        ({"z-background": "far"}, "bad-settings", "/z-background"),
        ({"aov": "motion"}, "bad-settings", "/aov"),
        ({"aov": ["Z", "z"]}, "bad-settings", "/aov"),
        ({"aov": []}, "bad-settings", "/aov"),
        ({"name": "../frame.####.exr"}, "bad-settings", "/name"),
        ({"name": "frame.exr"}, "bad-settings", "/name"),
        ({"preview": "yes"}, "bad-settings", "/preview"),
        ({"animation": ""}, "bad-settings", "/animation"),
        ({"animation": "a\nb"}, "bad-settings", "/animation"),
    ],
)
def test_bad_settings_are_refused_by_name(sheafd: Service, settings: dict, slug: str, pointer: str) -> None:
    problem = check_problem(sheafd.submit(gltf(), settings), 422, slug)
    assert problem["pointer"] == pointer
    assert pointer[1:] in problem["detail"]
    if slug == "limit-exceeded":
        assert problem["value"] > problem["limit"]


def test_an_unknown_layer_is_refused_with_those_that_there_are(sheafd: Service) -> None:
    problem = check_problem(sheafd.submit(gltf(), {"aov": ["Z", "motion"]}), 422, "bad-settings")
    assert all(f" {layer}" in problem["detail"] for layer in ("Z", "N", "P", "albedo", "UV", "id", "tests", "all"))


def test_what_a_quality_stands_for_is_held_against_the_limits(start: Callable[..., Service]) -> None:
    few = start("--max-depth", "16")
    problem = check_problem(few.submit(gltf(), {"quality": "exact"}), 422, "limit-exceeded")
    assert (problem["pointer"], problem["limit_name"], problem["value"]) == ("/quality", "max-depth", 32)
    assert few.submit(gltf(), {"quality": "exact", "depth": 8}).status_code == 202  # what is given beside it counts


def test_a_layer_that_there_is_not_is_refused_with_those_that_there_are(sheafd: Service) -> None:
    problem = check_problem(sheafd.submit(gltf(), {"aov": "Z,motion"}), 422, "bad-settings")
    assert "motion: there is Z, N, P, albedo, UV, id, tests, all" in problem["detail"]
    for layers in "Z", "Z,N,P,albedo,UV,id,tests", "all", ["Z", "id"], ["all"]:
        assert sheafd.submit(gltf(), {"aov": layers}).status_code == 202


def test_a_key_in_a_pointer_is_escaped(sheafd: Service) -> None:
    problem = check_problem(sheafd.submit(gltf(), {"a/b~c": 1}), 422, "bad-settings")
    assert problem["pointer"] == "/a~1b~0c"
    assert "settings.a/b~c: " in problem["detail"]


def test_a_value_is_never_read_as_an_option(sheafd: Service) -> None:
    job = sheafd.accepted(gltf(), {"animation": "--out=/tmp/elsewhere", "frames": "0"})
    assert sheafd.wait(job)["state"] == "done"
    assert "--animation=--out=/tmp/elsewhere" in arguments(sheafd, job)


def test_negative_frames(sheafd: Service) -> None:
    job = sheafd.accepted(gltf(), {"frames": "-2"})
    assert [f["frame"] for f in sheafd.wait(job)["frames"]] == [-2]
    assert sheafd.http.get(f"/v1/jobs/{job}/frames/-2.exr").status_code == 200
