# SPDX-License-Identifier: MIT
"""The HTTP layer itself: routes and methods, hostile bytes, connections."""

import json
import re
import socket
from collections.abc import Callable

import httpx
import pytest

from service import Service, check_problem, gltf


def status_of(answer: bytes) -> int:
    return int(answer.split(b" ", 2)[1])


def problem_of(answer: bytes) -> dict:
    head, _, body = answer.partition(b"\r\n\r\n")
    assert b"content-type: application/problem+json" in head.lower()
    return json.loads(body)


def test_unknown_routes_and_methods(sheafd: Service) -> None:
    for path in ("/nope", "/v1", "/v1/", "/v1/jobs/", "/v2/jobs", "/healthz/", "/v1/jobs/x/y"):
        check_problem(sheafd.http.get(path), 404, "unknown-route")
    for method, path, allow in (
        ("PUT", "/v1/jobs", "GET, HEAD, OPTIONS, POST"),
        ("POST", "/", "GET, HEAD, OPTIONS"),
        ("PATCH", "/v1/jobs/x", "DELETE, GET, HEAD, OPTIONS"),
        ("DELETE", "/metrics", "GET, HEAD, OPTIONS"),
        ("TRACE", "/", "GET, HEAD, OPTIONS"),
    ):
        reply = sheafd.http.request(method, path)
        check_problem(reply, 405, "method-not-allowed")
        assert reply.headers["Allow"] == allow
    options = sheafd.http.options("/v1/jobs")
    assert options.status_code == 204
    assert options.headers["Allow"] == "GET, HEAD, OPTIONS, POST"
    check_problem(sheafd.http.request("BREW", "/"), 501, "not-implemented")


def test_every_get_route_answers_head_without_a_body(sheafd: Service) -> None:
    job = sheafd.accepted(gltf(), {"frames": 0})
    sheafd.wait(job)
    sheafd.wait_until_ready()
    for path in (
        "/healthz",
        "/readyz",
        "/metrics",
        "/openapi.json",
        "/",
        "/v1/jobs",
        f"/v1/jobs/{job}",
        f"/v1/jobs/{job}/stats.csv",
        f"/v1/jobs/{job}/log",
        "/nope",
    ):
        got, head = sheafd.http.get(path), sheafd.http.head(path)
        assert head.status_code == got.status_code
        assert head.content == b""
        assert head.headers["Content-Type"] == got.headers["Content-Type"]
        if path not in ("/metrics", "/readyz"):
            assert head.headers["Content-Length"] == got.headers["Content-Length"]
        assert got.headers["X-Content-Type-Options"] == "nosniff"
        assert got.headers["X-Request-Id"]


@pytest.mark.parametrize(
    ("request_bytes", "status"),
    [
        (b"GET / HTTP/1.1\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n", 400),
        (b"GET  / HTTP/1.1\r\nHost: a\r\n\r\n", 400),
        (b"GET / HTTP/2.0\r\nHost: a\r\n\r\n", 400),
        (b"GET /\r\n\r\n", 400),
        (b"GET / HTTP/1.1\nHost: a\n\n\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\nHost: a\r\n folded: x\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\nHost: a\r\nBad Name: x\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\nHost : a\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\nHost: a\r\nX: \x00\r\n\r\n", 400),
        (b"GET /%zz HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n", 400),
        (b"GET /%00 HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n", 400),
        (b"GET http:///healthz HTTP/1.1\r\nHost: a\r\n\r\n", 400),
        (b"GET http://me@a/healthz HTTP/1.1\r\nHost: a\r\n\r\n", 400),
        (b"GET http://a:b/healthz HTTP/1.1\r\nHost: a\r\n\r\n", 400),
        (b"GET http://a/%zz HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n", 400),
        (b"GET http://a/healthz HTTP/1.1\r\n\r\n", 400),
        (b"GET http://a/healthz HTTP/1.1\r\nHost: a\r\nHost: a\r\n\r\n", 400),
        (b"GET ftp://a/healthz HTTP/1.1\r\nHost: a\r\n\r\n", 400),
        (b"GET a/healthz HTTP/1.1\r\nHost: a\r\n\r\n", 400),
        (b"GET * HTTP/1.1\r\nHost: a\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\nHost: a/b\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\nHost: a b\r\n\r\n", 400),
        (b"POST /v1/jobs HTTP/1.1\r\nHost: a\r\nContent-Length: 5\r\nContent-Length: 6\r\n\r\n", 400),
        (b"POST /v1/jobs HTTP/1.1\r\nHost: a\r\nContent-Length: -1\r\n\r\n", 400),
        (b"POST /v1/jobs HTTP/1.1\r\nHost: a\r\nContent-Length: 99999999999999999999\r\n\r\n", 400),
        (b"POST /v1/jobs HTTP/1.1\r\nHost: a\r\nContent-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n", 400),
        (b"POST /v1/jobs HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: gzip, chunked\r\n\r\n", 400),
        (b"GET / HTTP/1.1\r\nHost: a\r\n" + b"X: y\r\n" * 101 + b"\r\n", 431),
        (b"GET / HTTP/1.1\r\nHost: a\r\nX: " + b"y" * 40_000 + b"\r\n\r\n", 431),
        (b"GET /" + b"y" * 5000 + b" HTTP/1.1\r\nHost: a\r\n\r\n", 414),
        (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n", 400),
    ],
)
def test_malformed_heads(sheafd: Service, request_bytes: bytes, status: int) -> None:
    answer = sheafd.raw(request_bytes)
    assert status_of(answer) == status
    assert problem_of(answer)["status"] == status
    assert sheafd.http.get("/healthz").status_code == 200


@pytest.mark.parametrize(
    ("target", "host", "status"),
    [
        (b"http://a/healthz", b"a", 200),
        (b"HTTP://A:8080/healthz", b"a:8080", 200),
        (b"https://farm.example.org:/healthz", b"farm.example.org", 200),
        (b"http://[::1]:8080/healthz", b"[::1]:8080", 200),
        (b"http://a/healthz", b"another", 200),  # the target's host holds, and any is served
        (b"http://a/healthz", b"", 200),
        (b"http://a", b"a", 200),
        (b"http://a/v1/jobs?limit=1", b"a", 200),
        (b"http://a?limit=1", b"a", 400),  # the page takes no arguments
        (b"http://a/v1/jobs?limit=0", b"a", 400),
        (b"http://a/nope", b"a", 404),
    ],
)
def test_targets_in_absolute_form(sheafd: Service, target: bytes, host: bytes, status: int) -> None:
    """As clients send them to what they take for a proxy (RFC 9112, 3.2.2)."""
    answer = sheafd.raw(b"GET " + target + b" HTTP/1.1\r\nHost: " + host + b"\r\nConnection: close\r\n\r\n")
    assert status_of(answer) == status
    if status == 404:
        assert problem_of(answer)["instance"] == "/nope"


def test_a_client_that_takes_the_service_for_a_proxy(sheafd: Service) -> None:
    with httpx.Client(proxy=sheafd.url) as client:
        reply = client.post(sheafd.url + "/v1/jobs", files=[("scene", ("a.gltf", gltf()))])
        assert reply.status_code == 202
        assert reply.headers["Location"] == "/v1/jobs/" + reply.json()["id"]
        assert client.get(sheafd.url + reply.headers["Location"]).json()["id"] == reply.json()["id"]
    while not any(entry.get("path") == reply.headers["Location"] for entry in sheafd.log):
        pass  # the log's line comes after the answer


def test_options_of_the_whole_service(sheafd: Service) -> None:
    for target in b"*", b"http://a":
        answer = sheafd.raw(b"OPTIONS " + target + b" HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n")
        assert status_of(answer) == 204
        assert b"Allow: DELETE, GET, HEAD, OPTIONS, POST\r\n" in answer


CHUNKED = (
    b"POST /v1/jobs HTTP/1.1\r\nHost: a\r\nContent-Type: multipart/form-data; boundary=b\r\n"
    b"Transfer-Encoding: chunked\r\nConnection: close\r\n\r\n"
)


@pytest.mark.parametrize(
    "body",
    [
        b"zz\r\n",
        b"5\r\nabc",
        b"3\r\nabcd\r\n",
        b"ffffffffffffffffffff\r\n",
        b"1;" + b"x" * 999,
        b"\r\n",
        b"0x5\r\nhello\r\n0\r\n\r\n",
        b"-1\r\n",
    ],
)
def test_malformed_chunks(sheafd: Service, body: bytes) -> None:
    assert status_of(sheafd.raw(CHUNKED + body, half_close=True)) == 400


def test_a_chunked_submission_with_extensions_and_trailers(sheafd: Service) -> None:
    body = b'--b\r\nContent-Disposition: form-data; name="scene"; filename="s.gltf"\r\n\r\n' + gltf() + b"\r\n--b--\r\n"
    chunks = b"".join(b"%x;note=1\r\n%c\r\n" % (1, byte) for byte in body) + b"0\r\nTrailer: x\r\n\r\n"
    assert status_of(sheafd.raw(CHUNKED + chunks)) == 202


def test_an_upload_that_breaks_off_leaves_nothing(sheafd: Service) -> None:
    body = b'--b\r\nContent-Disposition: form-data; name="scene"; filename="s.gltf"\r\n\r\n' + b" " * 5000
    head = CHUNKED.replace(b"Transfer-Encoding: chunked", b"Content-Length: 90000")
    assert status_of(sheafd.raw(head + body, half_close=True)) == 400
    assert not list((sheafd.data / "incoming").iterdir())


def test_pipelined_requests_are_kept_apart(sheafd: Service) -> None:
    smuggled = b"GET /smuggled HTTP/1.1\r\nHost: a\r\n\r\n"
    first = b"GET /healthz HTTP/1.1\r\nHost: a\r\n\r\n"
    last = b"GET /nope HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n"
    answer = sheafd.raw(first + first + last)
    assert answer.count(b"HTTP/1.1 200") == 2
    assert answer.count(b"HTTP/1.1 404") == 1
    # A body that no route reads is not taken for a request: the connection ends.
    unread = b"GET /healthz HTTP/1.1\r\nHost: a\r\nContent-Length: %d\r\n\r\n" % len(smuggled)
    answer = sheafd.raw(unread + smuggled + last)
    assert answer.count(b"HTTP/1.1") == 1
    assert b"Connection: close" in answer
    assert not any(entry.get("path") == "/smuggled" for entry in sheafd.log)


def test_expect_continue(sheafd: Service) -> None:
    head = (
        b"POST %s HTTP/1.1\r\nHost: a\r\nContent-Type: multipart/form-data; boundary=b\r\nExpect: 100-continue\r\n"
        b"Content-Length: %d\r\nConnection: close\r\n\r\n"
    )
    body = b'--b\r\nContent-Disposition: form-data; name="scene"; filename="s.gltf"\r\n\r\n{}\r\n--b--\r\n'
    answer = sheafd.raw(head % (b"/v1/jobs", len(body)) + body)
    assert answer.startswith(b"HTTP/1.1 100 Continue\r\n\r\nHTTP/1.1 202 ")
    assert sheafd.raw(head % (b"/nope", 1 << 20)).startswith(b"HTTP/1.1 404")
    assert sheafd.raw(head % (b"/v1/jobs", 1 << 40)).startswith(b"HTTP/1.1 413")


def test_http_1_0(sheafd: Service) -> None:
    job = sheafd.accepted(gltf(), {"frames": 0})
    sheafd.wait(job)
    answer = sheafd.raw(b"GET /v1/jobs/%s/events HTTP/1.0\r\n\r\n" % job.encode())
    assert b"chunked" not in answer
    assert answer.rstrip().endswith(b"}")
    assert status_of(sheafd.raw(b"GET /healthz HTTP/1.0\r\n\r\n")) == 200


def test_slow_heads_and_bodies_time_out_and_stop_nobody(start: Callable[..., Service]) -> None:
    service = start("--head-timeout", "0.2", "--io-timeout", "0.2", "--http-threads", "3", "--max-streams", "2")
    host, port = service.address.rsplit(":", 1)
    idle = [socket.create_connection((host, int(port)), 60) for _ in range(50)]
    slow = [socket.create_connection((host, int(port)), 60) for _ in range(2)]
    slow[0].sendall(b"GET / HT")
    slow[1].sendall(CHUNKED + b"5\r\nab")
    assert service.http.get("/healthz").status_code == 200
    for connection in slow:
        answer = connection.recv(65536)
        assert status_of(answer) == 408, answer
    for connection in idle + slow:
        connection.close()


def test_slow_clients_hold_up_nobody(start: Callable[..., Service]) -> None:
    """Far more of them than threads: in the middle of a body, or not reading a reply."""
    service = start("--http-threads", "2", "--max-stalled", "4", "--io-timeout", "1000")
    job = service.accepted(gltf(padding=20 << 20), {"frames": 0})
    service.wait(job)
    host, port = service.address.rsplit(":", 1)
    slow = []
    for i in range(20):
        connection = socket.create_connection((host, int(port)), 60)
        if i % 2:
            connection.sendall(CHUNKED + b"5\r\nab")
        else:
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            connection.sendall(b"GET /v1/jobs/%s/frames/0.exr HTTP/1.1\r\nHost: a\r\n\r\n" % job.encode())
        slow.append(connection)
        assert service.http.get("/healthz").status_code == 200
    assert service.wait(service.accepted(gltf(), {"frames": 0}))["state"] == "done"
    for connection in slow:
        connection.close()


def test_connections_are_bounded(start: Callable[..., Service]) -> None:
    service = start("--max-connections", "5")
    host, port = service.address.rsplit(":", 1)
    held = [socket.create_connection((host, int(port)), 60) for _ in range(5)]
    for connection in held:
        connection.sendall(b"GET /healthz HTTP/1.1\r\nHost: a\r\n\r\n")
        assert status_of(connection.recv(65536)) == 200
    answer = service.raw(b"")
    assert status_of(answer) == 503
    assert b"Retry-After" in answer
    for connection in held:
        connection.close()
    while True:  # until the service has seen that they are gone
        try:
            if status_of(service.raw(b"GET /healthz HTTP/1.0\r\n\r\n")) == 200:
                break
        except ConnectionResetError:  # refused before the request was read
            continue


def test_the_page(sheafd: Service) -> None:
    reply = sheafd.http.get("/")
    assert reply.headers["Content-Type"].startswith("text/html")
    assert "<title>Sheaf</title>" in reply.text
    assert "default-src 'none'" in reply.headers["Content-Security-Policy"]
    assert not re.search(r'(src|href)="(https?:)?//', reply.text)
