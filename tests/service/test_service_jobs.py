# SPDX-License-Identifier: MIT
"""A job from its submission to its end: listing, cancelling, removing, limits of the queue."""

import hashlib
import re
from collections.abc import Callable

from conftest import Gate
from service import Service, check_problem, gltf


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
