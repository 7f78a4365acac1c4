# SPDX-License-Identifier: MIT
"""What the service or the network refuses becomes an exception, and is tried again where that helps."""

from __future__ import annotations

import httpx
import pytest

import sheaf
from fake_service import FakeJob, FakeService
from faults import hang_up, problem

GLTF = b'{"asset": {"version": "2.0"}}'


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
