# SPDX-License-Identifier: MIT
"""Submitting, listing, cancelling and removing jobs."""

import hashlib
import re
from collections.abc import Callable

import pytest

from conftest import Gate
from service import Service, arguments, check_problem, gltf


def test_a_job_from_submission_to_its_end(sheafd: Service) -> None:
    reply = sheafd.submit(gltf(), {"frames": "4-8:2", "size": "64x36"})
    assert reply.status_code == 202
    job = reply.json()
    assert re.fullmatch("[a-z2-7]{26}", job["id"])
    assert reply.headers["Location"] == f"/v1/jobs/{job['id']}"
    assert job["state"] in ("queued", "running")
    assert job["settings"] == {"frames": "4-8:2", "size": "64x36", "preview": True}
    assert [(f["frame"], f["state"]) for f in job["frames"]] == [(4, "pending"), (6, "pending"), (8, "pending")]

    job = sheafd.wait(job["id"])
    assert job["state"] == "done"
    assert job["progress"] == {"done": 3, "total": 3, "fraction": 1.0, "eta_s": None}
    assert [(f["frame"], f["state"], f["name"]) for f in job["frames"]] == [
        (4, "done", "scene.0004.exr"),
        (6, "done", "scene.0006.exr"),
        (8, "done", "scene.0008.exr"),
    ]
    assert job["created"] <= job["started"] <= job["finished"] < job["expires"]
    assert job["error"] is None
    for link in job["links"].values():
        assert sheafd.http.get(link).status_code in (200, 204)


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
            "--scene-name=Night", "--environment=0.5,1,2.5", "--count=on",
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


def test_idempotency(sheafd: Service) -> None:
    key = {"Idempotency-Key": "k1"}
    first = sheafd.submit(gltf(), {"frames": 0}, headers=key)
    again = sheafd.submit(gltf(), {"frames": 0}, headers=key)  # another multipart boundary
    assert first.status_code == again.status_code == 202
    assert first.json()["id"] == again.json()["id"]
    assert again.headers["Idempotent-Replayed"] == "true"
    assert "Idempotent-Replayed" not in first.headers
    check_problem(sheafd.submit(gltf(), {"frames": 1}, headers=key), 422, "idempotency-mismatch")
    assert sheafd.submit(gltf(), {"frames": 0}).json()["id"] != first.json()["id"]
    check_problem(sheafd.submit(gltf(), headers={"Idempotency-Key": "a b"}), 400, "malformed-request")
    assert len(list((sheafd.data / "jobs").iterdir())) == 2

    job = first.json()["id"]
    sheafd.wait(job)
    assert sheafd.http.delete(f"/v1/jobs/{job}").status_code == 204
    assert sheafd.submit(gltf(), {"frames": 1}, headers=key).json()["id"] != job


def test_listing(sheafd: Service) -> None:
    jobs = [sheafd.accepted(gltf(), {"frames": 0}) for _ in range(5)]
    for job in jobs:
        sheafd.wait(job)
    failed = sheafd.accepted(gltf(exit={"code": 3, "message": "bad"}), {"frames": 0})
    sheafd.wait(failed)

    def page(**query: str | int) -> dict:
        return sheafd.http.get("/v1/jobs", params=query).json()

    assert [j["id"] for j in page()["jobs"]] == [failed, *reversed(jobs)]
    assert "frames" not in page()["jobs"][0]
    assert page()["next"] is None
    seen: list[str] = []
    cursor: dict = {}
    while True:
        part = page(limit=2, **cursor)
        seen += [j["id"] for j in part["jobs"]]
        if part["next"] is None:
            break
        cursor = {"cursor": part["next"]}
    assert seen == [failed, *reversed(jobs)]
    assert [j["id"] for j in page(state="failed")["jobs"]] == [failed]
    for query in ({"limit": 0}, {"limit": 201}, {"limit": "x"}, {"state": "lost"}, {"cursor": "x"}, {"colour": 1}):
        check_problem(sheafd.http.get("/v1/jobs", params=query), 400, "malformed-request")
    check_problem(sheafd.http.get("/v1/jobs?limit=1&limit=2"), 400, "malformed-request")


def test_cancel_a_queued_job(sheafd: Service, gate: Gate) -> None:
    running = sheafd.accepted(gltf(gates={"0": gate.path}))
    sheafd.wait(running, "running")
    queued = sheafd.accepted(gltf())
    reply = sheafd.http.delete(f"/v1/jobs/{queued}")
    assert reply.status_code == 202
    assert reply.json()["state"] == "cancelled"
    assert sheafd.job(queued)["state"] == "cancelled"
    assert sheafd.http.delete(f"/v1/jobs/{queued}").status_code == 204
    check_problem(sheafd.http.get(f"/v1/jobs/{queued}"), 410, "job-removed")
    check_problem(sheafd.http.delete(f"/v1/jobs/{queued}"), 410, "job-removed")
    assert not (sheafd.data / "jobs" / queued).exists()
    gate.open()
    assert sheafd.wait(running)["state"] == "done"


def test_cancel_a_running_job_keeps_its_whole_frames(sheafd: Service, gate: Gate) -> None:
    job = sheafd.accepted(gltf(gates={"1": gate.path}), {"frames": "0-3"})
    sheafd.wait_for_frame(job, 0)
    reply = sheafd.http.delete(f"/v1/jobs/{job}")
    assert reply.status_code == 202
    assert reply.json()["cancel_requested"] is True
    end = sheafd.wait(job)
    assert end["state"] == "cancelled"
    assert end["error"] is None
    assert [f["state"] for f in end["frames"]] == ["done", "missing", "missing", "missing"]
    assert sheafd.http.get(f"/v1/jobs/{job}/frames/0.exr").status_code == 200
    check_problem(sheafd.http.get(f"/v1/jobs/{job}/frames/1.exr"), 404, "not-produced")
    assert sheafd.http.delete(f"/v1/jobs/{job}").status_code == 204
    check_problem(sheafd.http.get(f"/v1/jobs/{job}/frames/0.exr"), 410, "job-removed")


def test_cancelling_never_removes(sheafd: Service, gate: Gate) -> None:
    job = sheafd.accepted(gltf(gates={"1": gate.path}), {"frames": "0-1"})
    queued = sheafd.accepted(gltf(), {"frames": 0})
    sheafd.wait_for_frame(job, 0)
    reply = sheafd.http.post(f"/v1/jobs/{queued}/cancel")
    assert reply.status_code == 200
    assert reply.json()["state"] == "cancelled"
    reply = sheafd.http.post(f"/v1/jobs/{job}/cancel")
    assert reply.status_code == 202
    assert reply.json()["cancel_requested"] is True
    assert sheafd.wait(job)["state"] == "cancelled"
    for _ in range(3):  # DELETE would have removed it by now
        reply = sheafd.http.post(f"/v1/jobs/{job}/cancel")
        assert reply.status_code == 200
        assert reply.json()["state"] == "cancelled"
    done = sheafd.accepted(gltf(), {"frames": 0})
    sheafd.wait(done)
    assert sheafd.http.post(f"/v1/jobs/{done}/cancel").json()["state"] == "done"
    assert sheafd.http.get(f"/v1/jobs/{done}/frames/0.exr").status_code == 200
    check_problem(sheafd.http.post(f"/v1/jobs/{'a' * 26}/cancel"), 404, "unknown-job")
    sheafd.http.delete(f"/v1/jobs/{done}")
    check_problem(sheafd.http.post(f"/v1/jobs/{done}/cancel"), 410, "job-removed")


def test_no_depth_at_all(sheafd: Service) -> None:
    job = sheafd.accepted(gltf(), {"frames": 0, "depth": 0})
    assert sheafd.wait(job)["settings"]["depth"] == 0
    assert "--depth=0" in arguments(sheafd, job)


def test_checksums_of_frames_and_previews(sheafd: Service) -> None:
    job = sheafd.accepted(gltf(), {"frames": "0-1"})
    for frame in sheafd.wait(job)["frames"]:
        for kind in ("", "png_"):
            data = sheafd.http.get(frame[kind.rstrip("_") or "exr"]).content
            assert frame[kind + "sha256"] == hashlib.sha256(data).hexdigest()
            assert frame[kind + "bytes"] == len(data)
    bare = sheafd.accepted(gltf(), {"frames": 0, "preview": False})
    assert sheafd.wait(bare)["frames"][0]["png_sha256"] is None


def test_a_finished_job_expires(start: Callable[..., Service]) -> None:
    service = start("--retention", "0.0003")  # about a second
    job = service.accepted(gltf(), {"frames": 0})
    assert service.wait(job)["expires"] is not None
    while (reply := service.http.get(f"/v1/jobs/{job}")).status_code == 200:
        pass
    check_problem(reply, 410, "job-removed")
    assert start("--retention", "0").submit(gltf()).json()["expires"] is None


def test_unknown_jobs(sheafd: Service) -> None:
    for path in ("a" * 26, "nope", "..", "%2e%2e"):
        for rest in ("", "/events", "/frames/0.exr", "/frames/0.png", "/frames.zip", "/stats", "/stats.csv", "/log"):
            check_problem(
                sheafd.http.get(f"/v1/jobs/{path}{rest}"), 404, "unknown-route" if path == ".." else "unknown-job"
            )


def test_the_queue_is_bounded(start: Callable[..., Service], gate: Gate) -> None:
    service = start("--max-queue", "1")
    running = service.accepted(gltf(gates={"0": gate.path}))
    service.wait(running, "running")
    waiting = service.accepted(gltf())
    reply = service.submit(gltf())
    problem = check_problem(reply, 503, "queue-full")
    assert problem["limit"] == 1
    assert int(reply.headers["Retry-After"]) > 0
    check_problem(service.http.get("/readyz"), 503, "not-ready")
    service.http.delete(f"/v1/jobs/{waiting}")
    assert service.submit(gltf()).status_code == 202
    gate.open()
    service.wait(running)


def test_no_job_is_taken_on_a_full_disk(start: Callable[..., Service]) -> None:
    service = start("--min-free", str(1 << 40))
    check_problem(service.submit(gltf()), 503, "storage")
    check_problem(service.http.get("/readyz"), 503, "not-ready")


def test_pages_of_other_sites_are_refused(sheafd: Service) -> None:
    check_problem(sheafd.submit(gltf(), headers={"Sec-Fetch-Site": "cross-site"}), 403, "foreign-origin")
    assert sheafd.submit(gltf(), headers={"Sec-Fetch-Site": "same-origin"}).status_code == 202
