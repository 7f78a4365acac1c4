# SPDX-License-Identifier: MIT
"""Watching jobs: event streams and long polls."""

import json
import pathlib
import resource
import socket
import threading
import time
from collections.abc import Callable, Iterator

import httpx
import pytest

from conftest import Gate
from service import Service, check_problem, gltf


def parse(lines: Iterator[str]) -> Iterator[dict]:
    """Server-sent events as a browser reads them; comments too, as {"comment": ...}."""
    event: dict = {}
    for line in lines:
        if line == "":
            if "event" in event:
                yield event
            event = {}
        elif line.startswith(":"):
            yield {"comment": line[1:].strip()}
        else:
            key, _, value = line.partition(": ")
            event[key] = json.loads(value) if key == "data" else value


def stream(service: Service, job: str, **headers: str) -> list[dict]:
    with service.http.stream("GET", f"/v1/jobs/{job}/events", headers=headers) as reply:
        assert reply.status_code == 200
        assert reply.headers["Content-Type"] == "text/event-stream"
        return list(parse(reply.iter_lines()))


def test_a_stream_tells_everything_and_ends(sheafd: Service, gate: Gate) -> None:
    job = sheafd.accepted(gltf(gates={"1": gate.path}, warnings=["dim"]), {"frames": "0-1"})
    with sheafd.http.stream("GET", f"/v1/jobs/{job}/events") as reply:
        heard = []
        for event in parse(reply.iter_lines()):
            heard.append(event)
            if event.get("event") == "frame" and event["data"]["frame"] == 0:
                threading.Thread(target=gate.open).start()
    assert [(e["event"], e["data"].get("state", e["data"].get("frame"))) for e in heard] == [
        ("state", "queued"),
        ("state", "running"),
        ("start", None),
        ("warning", None),
        ("frame", 0),
        ("frame", 1),
        ("state", "done"),
    ]
    assert [e["id"] for e in heard] == [str(i) for i in range(1, 8)]
    assert heard[3]["data"]["message"] == "dim"
    assert heard[4]["data"]["done"] == 1
    assert heard[4]["data"]["total"] == 2
    assert all(e["data"]["time"] for e in heard)


def test_a_stream_resumes_where_it_was(sheafd: Service) -> None:
    job = sheafd.accepted(gltf(), {"frames": "0-2"})
    sheafd.wait(job)
    everything = stream(sheafd, job)
    for seen in range(len(everything)):
        assert stream(sheafd, job, **{"Last-Event-ID": str(seen)}) == everything[seen:]
    done = sheafd.http.get(f"/v1/jobs/{job}/events", headers={"Last-Event-ID": str(len(everything))})
    assert done.status_code == 204
    assert "Content-Length" not in done.headers
    check_problem(sheafd.http.get(f"/v1/jobs/{job}/events", headers={"Last-Event-ID": "x"}), 400, "malformed-request")
    check_problem(sheafd.http.get(f"/v1/jobs/{job}/events?after=-1"), 400, "malformed-request")
    assert sheafd.http.get(f"/v1/jobs/{job}/events?after=5", headers={"Last-Event-ID": "0"}).text.startswith("retry")


def test_an_idle_stream_is_kept_alive(start: Callable[..., Service], gate: Gate) -> None:
    service = start("--heartbeat", "0.05")
    job = service.accepted(gltf(gates={"0": gate.path}), {"frames": 0})
    service.wait(job, "running")
    with service.http.stream("GET", f"/v1/jobs/{job}/events", headers={"Last-Event-ID": "3"}) as reply:
        heard = parse(reply.iter_lines())
        assert [next(heard) for _ in range(2)] == [{"comment": "keep-alive"}] * 2
        gate.open()
        assert [e["event"] for e in heard if "event" in e] == ["frame", "state"]


def test_long_poll(sheafd: Service, gate: Gate) -> None:
    job = sheafd.accepted(gltf(gates={"0": gate.path}), {"frames": 0})
    sheafd.wait(job, "running")

    def poll(wait: float | str, after: int) -> dict:
        reply = sheafd.http.get(f"/v1/jobs/{job}/events", params={"wait": wait, "after": after})
        assert reply.status_code == 200, reply.text
        return reply.json()

    while poll(30, 2)["last"] < 3:
        pass
    assert poll(0, 3) == {"events": [], "last": 3, "ended": False}
    assert poll(0.01, 3)["events"] == []
    first = poll(0, 0)
    assert [e["id"] for e in first["events"]] == [1, 2, 3]
    assert first["last"] == 3
    opener = threading.Thread(target=gate.open)
    opener.start()
    assert poll(30, 3)["events"][0]["event"] == "frame"
    opener.join()
    sheafd.wait(job)
    assert poll(30, 5) == {"events": [], "last": 5, "ended": True}
    for wait in ("x", "-1", "nan", ""):
        reply = sheafd.http.get(f"/v1/jobs/{job}/events", params={"wait": wait})
        check_problem(reply, 400, "malformed-request")


def test_watchers_are_bounded_and_do_not_starve_others(start: Callable[..., Service], gate: Gate) -> None:
    service = start("--max-streams", "3", "--http-threads", "2", "--heartbeat", "0.05")
    job = service.accepted(gltf(gates={"0": gate.path}), {"frames": 0})
    streams = [httpx.stream("GET", f"{service.url}/v1/jobs/{job}/events", timeout=60) for _ in range(3)]
    for watched in streams:
        assert watched.__enter__().status_code == 200
    reply = service.http.get(f"/v1/jobs/{job}/events")
    problem = check_problem(reply, 503, "too-many-streams")
    assert problem["limit"] == 3
    assert reply.headers["Retry-After"]
    check_problem(service.http.get(f"/v1/jobs/{job}/events?wait=1&after=9"), 503, "too-many-streams")
    assert service.http.get(f"/v1/jobs/{job}").status_code == 200
    assert "sheaf_event_streams 3" in service.http.get("/metrics").text
    streams[0].__exit__(None, None, None)  # a watcher that goes makes room at the next heartbeat
    while service.http.get(f"/v1/jobs/{job}/events?wait=0.01&after=9").status_code == 503:
        pass
    gate.open()
    for watched in streams[1:]:
        watched.__exit__(None, None, None)


def test_a_thousand_idle_streams_cost_no_thread(start: Callable[..., Service], gate: Gate) -> None:
    service = start("--http-threads", "2", "--heartbeat", "1000")
    job = service.accepted(gltf(gates={"0": gate.path}), {"frames": 0})
    while service.http.get(f"/v1/jobs/{job}/events?wait=30&after=2").json()["last"] < 3:
        pass
    host, port = service.address.rsplit(":", 1)
    count = min(1000, resource.getrlimit(resource.RLIMIT_NOFILE)[0] // 2)
    streams = [socket.create_connection((host, int(port)), 60) for _ in range(count)]
    for i, connection in enumerate(streams):  # half of them long polls
        query = b"?wait=60&after=3" if i % 2 else b""
        connection.sendall(b"GET /v1/jobs/%s/events%s HTTP/1.1\r\nHost: a\r\n\r\n" % (job.encode(), query))
    while f"sheaf_event_streams {count}\n" not in service.http.get("/metrics").text:
        pass
    threads = len(list(pathlib.Path(f"/proc/{service.process.pid}/task").iterdir()))
    assert threads < 15
    began = time.monotonic()
    for _ in range(20):
        assert service.http.get(f"/v1/jobs/{job}").status_code == 200
    assert time.monotonic() - began < 10
    for connection in streams[: count // 4]:
        connection.close()
    while f"sheaf_event_streams {count - count // 4}\n" not in service.http.get("/metrics").text:
        pass
    gate.open()
    for connection in streams[count // 4 :]:
        heard = b""
        while not heard.endswith(b"0\r\n\r\n"):
            block = connection.recv(65536)
            assert block
            heard += block
        assert b'"done"' in heard
        connection.close()
    service.wait(job)


def test_a_connection_goes_on_after_a_long_poll(sheafd: Service, gate: Gate) -> None:
    job = sheafd.accepted(gltf(gates={"0": gate.path}), {"frames": 0})
    sheafd.wait(job, "running")
    host, port = sheafd.address.rsplit(":", 1)
    poll = b"GET /v1/jobs/%s/events?wait=0.05&after=3 HTTP/1.1\r\nHost: a\r\n\r\n" % job.encode()
    with socket.create_connection((host, int(port)), 60) as connection:
        for _ in range(3):
            connection.sendall(poll)
            heard = b""
            while not heard.endswith(b"0\r\n\r\n"):
                heard += connection.recv(65536)
            assert b'"ended":false' in heard
    gate.open()


def test_a_client_that_does_not_read_stops_nobody(start: Callable[..., Service], gate: Gate) -> None:
    service = start("--io-timeout", "0.5")
    job = service.accepted(gltf(gates={"1": gate.path}, warnings=["w" * 2000] * 150), {"frames": "0-1"})
    service.wait_for_frame(job, 0)
    host, port = service.address.rsplit(":", 1)
    stuck = socket.socket()
    stuck.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    stuck.connect((host, int(port)))
    stuck.sendall(b"GET /v1/jobs/%s/events HTTP/1.1\r\nHost: a\r\n\r\n" % job.encode())
    while "sheaf_event_streams 1\n" not in service.http.get("/metrics").text:
        pass
    with service.http.stream("GET", f"/v1/jobs/{job}/events") as reply:
        gate.open()
        assert [e for e in parse(reply.iter_lines()) if "event" in e][-1]["data"]["state"] == "done"
    while "sheaf_event_streams 0\n" not in service.http.get("/metrics").text:  # cut off after --io-timeout
        pass
    stuck.close()


def test_removal_ends_a_stream(sheafd: Service, gate: Gate) -> None:
    job = sheafd.accepted(gltf(gates={"0": gate.path}, stubborn=True), {"frames": 0})
    with sheafd.http.stream("GET", f"/v1/jobs/{job}/events") as reply:
        for event in parse(reply.iter_lines()):
            if event["event"] == "start":
                assert httpx.delete(f"{sheafd.url}/v1/jobs/{job}").status_code == 202
                assert httpx.delete(f"{sheafd.url}/v1/jobs/{job}").status_code == 204
    check_problem(sheafd.http.get(f"/v1/jobs/{job}/events"), 410, "job-removed")


@pytest.mark.parametrize("query", ["", "?wait=60&after=3"])
def test_stopping_lets_watchers_go(start: Callable[..., Service], gate: Gate, query: str) -> None:
    service = start()
    job = service.accepted(gltf(gates={"0": gate.path}), {"frames": 0})
    service.wait(job, "running")
    answered = threading.Event()

    def watch() -> None:
        with httpx.stream("GET", f"{service.url}/v1/jobs/{job}/events{query}", timeout=60) as reply:
            reply.read()
        answered.set()

    watcher = threading.Thread(target=watch)
    watcher.start()
    while "sheaf_event_streams 1" not in service.http.get("/metrics").text:
        pass
    assert service.stop() == 0
    watcher.join(60)
    assert answered.is_set()
