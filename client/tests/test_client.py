# SPDX-License-Identifier: MIT
"""Submitting, listing, errors and second tries over real HTTP."""

from __future__ import annotations

import json
from pathlib import Path

import httpx
import pytest

import sheaf
from fake_service import FakeJob, FakeService, hang_up, problem

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


@pytest.mark.parametrize(
    ("status", "kind"),
    [
        (400, sheaf.InvalidRequest),
        (401, sheaf.Unauthorized),
        (403, sheaf.Unauthorized),
        (404, sheaf.NotFound),
        (409, sheaf.Conflict),
        (410, sheaf.NotFound),
        (413, sheaf.TooLarge),
        (422, sheaf.InvalidRequest),
        (418, sheaf.ApiError),
        (500, sheaf.ApiError),
        (302, sheaf.ApiError),
    ],
)
def test_problems_become_exceptions(
    client: sheaf.Client, service: FakeService, status: int, kind: type[sheaf.ApiError], pauses: list[float]
) -> None:
    service.fault("GET", problem(status, "Bad", "keys[2]: no", limit=5))
    with pytest.raises(sheaf.ApiError) as caught:
        client.job("abc")
    error = caught.value
    assert type(error) is kind
    assert (error.status, error.type, error.title, error.detail) == (
        status,
        "urn:sheaf:problem:test",
        "Bad",
        "keys[2]: no",
    )
    assert error.extra == {"limit": 5}
    assert str(error) == f"{status} Bad: keys[2]: no"
    assert pauses == []


def test_an_exceeded_limit_is_too_large_whatever_its_status(client: sheaf.Client, service: FakeService) -> None:
    service.fault("GET", lambda h: h.json(422, {"type": "urn:sheaf:problem:limit-exceeded", "title": "A limit"}))
    with pytest.raises(sheaf.TooLarge):
        client.job("abc")


def test_errors_that_are_no_problem_json(client: sheaf.Client, service: FakeService) -> None:
    service.fault("GET", lambda h: h.send(502, b"<html>proxy</html>", {}))
    with pytest.raises(sheaf.ApiError, match="502 Bad Gateway") as caught:
        client.job("abc")
    assert (caught.value.type, caught.value.detail) == ("about:blank", "")


@pytest.mark.parametrize(
    ("value", "seconds"),
    [("7", 7.0), ("Thu, 01 Jan 1970 00:00:00 GMT", 0.0), ("Thu, 01 Jan 1970 00:00:00 -0000", 0.0), ("soon", None)],
)
def test_unavailable_says_when_to_come_back(
    service: FakeService, value: str, seconds: float | None, pauses: list[float]
) -> None:
    service.fault("GET", problem(503, headers={"Retry-After": value}))
    with (
        sheaf.Client(service.url, retry=sheaf.RetryPolicy(attempts=1)) as client,
        pytest.raises(sheaf.Unavailable) as caught,
    ):
        client.job("abc")
    assert caught.value.retry_after == seconds
    assert pauses == []


def test_retry_after_is_obeyed_up_to_a_limit(
    client: sheaf.Client, service: FakeService, done_job: FakeJob, pauses: list[float]
) -> None:
    service.fault("GET", problem(429, headers={"Retry-After": "3"}))
    assert client.job("abc").id == "abc"
    assert pauses == [3.0]
    service.fault("GET", problem(503, headers={"Retry-After": "3600"}))
    with pytest.raises(sheaf.Unavailable):
        client.job("abc")
    assert pauses == [3.0]


def test_gives_up_after_the_policys_attempts(client: sheaf.Client, service: FakeService, pauses: list[float]) -> None:
    service.fault("GET", hang_up, times=10)
    with pytest.raises(sheaf.TransportError, match=r"GET .*/v1/jobs/abc"):
        client.job("abc")
    assert len(service.asked("GET")) == 4
    assert pauses == [0.25, 0.5, 1.0]


def test_nobody_there_and_silence(pauses: list[float]) -> None:
    def refuse(request: httpx.Request) -> httpx.Response:
        raise httpx.ConnectError("connection refused", request=request)

    def silence(request: httpx.Request) -> httpx.Response:
        raise httpx.ReadTimeout("", request=request)

    for handler, text in ((refuse, "connection refused"), (silence, "no answer")):
        client = sheaf.Client("http://x", transport=httpx.MockTransport(handler))
        with client, pytest.raises(sheaf.TransportError, match=text):
            client.job("abc")


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"[]",
        b"<html>",
        b'{"id": "x"}',
        b'{"id": 5, "state": "done"}',
        b'{"id": "x", "state": "done", "frames": 5}',
        b'{"id": "x", "state": "done", "frames": [5]}',
        b'{"id": "x", "state": "done", "settings": 5}',
        b'{"id": "x", "state": "done", "progress": {"done": true}}',
    ],
)
def test_answers_of_something_else(body: bytes) -> None:
    transport = httpx.MockTransport(lambda request: httpx.Response(200, content=body))
    with sheaf.Client("http://x", transport=transport) as client, pytest.raises(sheaf.ProtocolError):
        client.job("abc")


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
