# SPDX-License-Identifier: MIT
"""Submitting, listing and second tries over real HTTP."""

from __future__ import annotations

import json
from pathlib import Path

import httpx
import pytest

import sheaf
from fake_service import FakeJob, FakeService
from faults import hang_up, problem

GLTF = b'{"asset": {"version": "2.0"}}'


def test_submit_sends_scene_files_camera_and_settings(
    client: sheaf.Client, service: FakeService, tmp_path: Path
) -> None:
    (tmp_path / "a b.bin").write_bytes(b"\0\r\n--\xff" * 1000)
    scene = tmp_path / "box.gltf"
    scene.write_text(json.dumps({"buffers": [{"uri": "a%20b.bin"}]}))
    camera = sheaf.CameraPath.look_at_keys([(0, (0, 0, 3), (0, 0, 0))])
    job = client.submit(
        scene,
        camera,
        frames=range(0, 6, 2),
        size=(64, 36),
        camera_node=None,
        spp=4,
        cutoff=0.01,
        aov=["Z", "N"],
        opaque=True,
        strategy="hybrid",
        animation=0,
    )
    assert (job.id, job.state) == ("job1", "queued")
    parts = {name: (filename, data) for name, filename, data in service.jobs["job1"].parts}
    assert parts["scene"] == ("box.gltf", scene.read_bytes())
    assert parts["file"] == ("a b.bin", b"\0\r\n--\xff" * 1000)
    assert json.loads(parts["camera"][1]) == camera.to_dict()
    assert service.jobs["job1"].settings == {
        "frames": "0-4:2",
        "size": "64x36",
        "spp": 4,
        "cutoff": 0.01,
        "aov": "Z,N",
        "opaque": True,
        "strategy": "hybrid",
        "animation": 0,
    }


def test_camera_from_file_and_mapping(client: sheaf.Client, service: FakeService, tmp_path: Path) -> None:
    nerfstudio = '{"camera_path": [], "render_width": 1.50}'
    (tmp_path / "path.json").write_text(nerfstudio)
    client.submit(GLTF, tmp_path / "path.json")
    client.submit(GLTF, {"version": 1, "keys": []})
    sent = [next(data for name, _, data in job.parts if name == "camera") for job in service.jobs.values()]
    assert sent == [nerfstudio.encode(), b'{"version": 1, "keys": []}']
    with pytest.raises(sheaf.SceneError, match=r"absent\.json"):
        client.submit(GLTF, tmp_path / "absent.json")


def test_wrong_settings_are_found_before_sending(client: sheaf.Client, service: FakeService) -> None:
    with pytest.raises(TypeError, match="unknown setting sise; there are"):
        client.submit(GLTF, sise="64x36")  # type: ignore[call-arg]
    with pytest.raises(ValueError, match="cutoff must be finite"):
        client.submit(GLTF, cutoff=float("nan"))
    with pytest.raises(ValueError, match="size"):
        client.submit(GLTF, size=(64, 36, 3))  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="depth cannot be a list"):
        client.submit(GLTF, depth=[1])  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="at least one frame"):
        client.submit(GLTF, frames=[])
    assert service.requests == []


def test_same_key_same_job_and_other_body_is_refused(client: sheaf.Client) -> None:
    first = client.submit(GLTF, frames=1, idempotency_key="k")
    assert client.submit(GLTF, frames=1, idempotency_key="k").id == first.id
    with pytest.raises(sheaf.InvalidRequest, match="Idempotency-Key"):
        client.submit(GLTF, frames=2, idempotency_key="k")


def test_a_lost_submit_is_sent_again_under_the_same_key(
    client: sheaf.Client, service: FakeService, pauses: list[float]
) -> None:
    service.fault("POST /v1/jobs", hang_up)
    service.fault("POST /v1/jobs", problem(503))
    job = client.submit(GLTF)
    sent = service.asked("POST /v1/jobs")
    assert len(sent) == 3
    assert len({headers["idempotency-key"] for _, _, headers in sent}) == 1
    assert len({headers["content-type"] for _, _, headers in sent}) == 1
    assert list(service.jobs) == [job.id]
    assert pauses == [0.25, 0.5]


def test_two_submits_are_two_jobs(client: sheaf.Client) -> None:
    assert client.submit(GLTF).id != client.submit(GLTF).id


@pytest.mark.parametrize("url", ["", "127.0.0.1:8080", "ftp://x", "http://x:port"])
def test_wrong_addresses(url: str) -> None:
    with pytest.raises(ValueError, match=r"x|http|127"):
        sheaf.Client(url)


def test_a_path_in_the_address_is_kept_and_ids_are_quoted() -> None:
    seen = []

    def answer(request: httpx.Request) -> httpx.Response:
        seen.append(request.url.raw_path)
        return httpx.Response(200, json={"id": "a/b", "state": "done"})

    with sheaf.Client("http://x/render/", transport=httpx.MockTransport(answer)) as client:
        client.job("a/b").refresh()
    assert seen == [b"/render/v1/jobs/a%2Fb"] * 2
    for job_id in ("", ".", ".."):
        with pytest.raises(ValueError, match="not a job's id"):
            client.job(job_id)


def test_token(service: FakeService, done_job: FakeJob) -> None:
    service.token = "secret"
    with sheaf.Client(service.url, token="secret") as client:
        assert client.job("abc").state == "done"
    with sheaf.Client(service.url) as client, pytest.raises(sheaf.Unauthorized):
        client.job("abc")


def test_jobs_walks_all_pages(client: sheaf.Client, service: FakeService) -> None:
    for number in range(5):
        service.add(FakeJob(f"j{number}", state="done" if number % 2 else "failed"))
    assert [job.id for job in client.jobs()] == ["j0", "j1", "j2", "j3", "j4"]
    assert len(service.asked("GET /v1/jobs")) == 3
    assert [job.id for job in client.jobs("failed", page_size=1)] == ["j0", "j2", "j4"]


def test_a_text_answer_is_health_too() -> None:
    with sheaf.Client("http://x", transport=httpx.MockTransport(lambda _: httpx.Response(200, text="ok\n"))) as client:
        assert client.health() == {"status": "ok"}


def test_a_broken_encoding_is_a_broken_answer(client: sheaf.Client, service: FakeService) -> None:
    service.fault("GET", lambda h: h.send(200, b"not gzip", {"Content-Encoding": "gzip"}), times=4)
    with pytest.raises(sheaf.TransportError, match="encoding"):
        client.job("abc")


def test_a_redirect_to_another_protocol_is_no_way_out(client: sheaf.Client, service: FakeService) -> None:
    service.fault("GET", lambda h: h.send(302, b"", {"Location": "file:///etc/passwd"}))
    with pytest.raises(sheaf.ApiError, match="302"):
        client.job("abc")


def test_health(client: sheaf.Client, service: FakeService) -> None:
    assert client.health() == {"status": "ok"}
    service.health = (503, {"type": "urn:x", "title": "Not ready", "detail": "disk is low", "disk": False})
    with pytest.raises(sheaf.Unavailable, match="disk is low") as caught:
        client.health()
    assert caught.value.extra == {"disk": False}


def test_uploads_tell_their_checksum(
    client: sheaf.Client, service: FakeService, tmp_path: Path, pauses: list[float]
) -> None:
    (tmp_path / "a.bin").write_bytes(bytes(range(256)) * 1000)
    scene = tmp_path / "box.gltf"
    scene.write_text(json.dumps({"buffers": [{"uri": "a.bin"}]}))
    client.submit(scene, frames=0)  # the fake service holds the checksum against what came
    assert not pauses
    client.job("job1")
    assert "content-digest" not in service.requests[-1][2]


def test_an_upload_that_arrived_damaged_is_sent_again(
    client: sheaf.Client, service: FakeService, pauses: list[float]
) -> None:
    damaged = problem(422, "Not what its digest says", type="urn:sheaf:problem:digest-mismatch")
    service.fault("POST /v1/jobs$", damaged)
    assert client.submit(GLTF).id == "job1"
    assert len(pauses) == 1
    service.fault("POST /v1/jobs$", damaged, times=4)
    with pytest.raises(sheaf.DamagedUpload):
        client.submit(GLTF)
