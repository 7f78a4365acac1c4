# SPDX-License-Identifier: MIT
"""A sheafd made of Python's own HTTP server: real sockets, no rendering, and faults on demand."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from email.parser import BytesParser
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, urlsplit

Fault = Callable[["Handler"], None]


@dataclass
class FakeJob:
    """What the service knows of a job; tests set it as they need it."""

    id: str
    state: str = "done"
    frames: dict[int, bytes] = field(default_factory=dict)  # rendered ones
    pending: list[int] = field(default_factory=list)
    events: list[tuple[str, dict[str, Any]]] = field(default_factory=list)  # event n has the id n, from 1
    settings: dict[str, Any] = field(default_factory=dict)
    error: dict[str, Any] | None = None
    name: str = "box.%04d.exr"
    warnings: list[str] = field(default_factory=list)
    cancel_requested: bool = False
    slow_to_stop: bool = False
    ends_unseen: bool = False  # between a look at it and the next request that changes something
    after_events: str | None = None  # the state once all events have been told
    parts: list[tuple[str, str | None, bytes]] = field(default_factory=list)

    def to_json(self) -> dict[str, Any]:
        frames: list[dict[str, Any]] = [
            {"frame": n, "state": "done", "name": self.name % n, "bytes": len(data), "sha256": sha256(data)}
            for n, data in self.frames.items()
        ]
        frames += [{"frame": n, "state": "pending"} for n in self.pending]
        done, total = len(self.frames), len(frames)
        progress = {"done": done, "total": total or None, "fraction": done / total if total else 0, "eta_s": None}
        return {
            "id": self.id,
            "state": self.state,
            "progress": progress,
            "frames": frames,
            "settings": self.settings,
            "error": self.error,
            "warnings": self.warnings,
            "cancel_requested": self.cancel_requested,
            "created": "2031-02-03T04:05:06Z",
            "expires": None,
        }

    def summary(self) -> dict[str, Any]:
        return {name: value for name, value in self.to_json().items() if name != "frames"}


class FakeService:
    """Serves on a port that the system chose."""

    def __init__(self) -> None:
        self.jobs: dict[str, FakeJob] = {}
        self.keys: dict[str, tuple[bytes, str]] = {}
        self.requests: list[tuple[str, str, dict[str, str]]] = []  # method, target, headers in lower case
        self.faults: list[tuple[re.Pattern[str], Fault]] = []
        self.new_job: Callable[[FakeJob], None] = lambda job: None
        self.stats: dict[str, Any] = {"schema": 1, "strategy": "hybrid", "totals": {"rays_per_second": 5.0}}
        self.health: tuple[int, dict[str, Any]] = (200, {"status": "ok"})
        self.token: str | None = None
        self.etag: Callable[[bytes], str | None] = lambda data: None
        service = self

        class Bound(Handler):
            owner = service

        self._server = ThreadingHTTPServer(("127.0.0.1", 0), Bound)
        self._server.daemon_threads = True
        self.url = f"http://127.0.0.1:{self._server.server_address[1]}"
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.01,))
        self._thread.start()

    def close(self) -> None:
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def add(self, job: FakeJob) -> FakeJob:
        self.jobs[job.id] = job
        return job

    def fault(self, pattern: str, fault: Fault, times: int = 1) -> None:
        """The next requests whose "METHOD target" matches get `fault` in place of their answer."""
        self.faults += [(re.compile(pattern), fault)] * times

    def asked(self, pattern: str) -> list[tuple[str, str, dict[str, str]]]:
        return [request for request in self.requests if re.search(pattern, f"{request[0]} {request[1]}")]


class Handler(BaseHTTPRequestHandler):
    """One connection."""

    owner: FakeService
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True

    def do_GET(self) -> None:
        self._serve()

    do_POST = do_DELETE = do_GET  # noqa: N815

    def _serve(self) -> None:
        owner = self.owner
        headers = {name.lower(): value for name, value in self.headers.items()}
        body = self.rfile.read(int(headers.get("content-length", 0)))
        if headers.get("transfer-encoding") == "chunked":
            body = self._chunks()
        owner.requests.append((self.command, self.path, headers))
        for index, (pattern, fault) in enumerate(owner.faults):
            if pattern.search(f"{self.command} {self.path}"):
                del owner.faults[index]
                fault(self)
                return
        if owner.token and headers.get("authorization") != f"Bearer {owner.token}":
            self.problem(401, "A token is needed", headers={"WWW-Authenticate": "Bearer"})
            return
        self._route(urlsplit(self.path).path, headers, body)

    def _chunks(self) -> bytes:
        body = b""
        while size := int(self.rfile.readline(), 16):
            body += self.rfile.read(size)
            self.rfile.readline()
        self.rfile.readline()
        return body

    def _route(self, path: str, headers: dict[str, str], body: bytes) -> None:
        query = {name: values[0] for name, values in parse_qs(urlsplit(self.path).query).items()}
        if path in ("/readyz", "/healthz"):
            status, answer = self.owner.health
            self.json(status, answer)
        elif path == "/v1/jobs" and self.command == "POST":
            self._submit(headers, body)
        elif path == "/v1/jobs":
            self._list(query)
        elif match := re.fullmatch(r"/v1/jobs/([^/]+)(/.*)?", path):
            job = self.owner.jobs.get(match.group(1))
            if job is None:
                self.problem(404, "There is no such job", f"no job {match.group(1)}")
            else:
                self._job(job, match.group(2) or "", headers, query)
        else:
            self.problem(404, "There is no such route")

    def _submit(self, headers: dict[str, str], body: bytes) -> None:
        digest = base64.b64encode(hashlib.sha256(body).digest()).decode()
        if headers["content-digest"] != f"sha-256=:{digest}:":
            self.problem(422, "Not what its digest says", type="urn:sheaf:problem:digest-mismatch")
            return
        key = headers["idempotency-key"]
        known = self.owner.keys.get(key)
        if known and known[0] != body:
            self.problem(422, "The Idempotency-Key was used for another request")
            return
        if known:
            self.json(202, self.owner.jobs[known[1]].to_json())
            return
        message = BytesParser().parsebytes(b"Content-Type: " + headers["content-type"].encode() + b"\r\n\r\n" + body)
        job = FakeJob(f"job{len(self.owner.jobs) + 1}", state="queued")
        for part in message.get_payload():
            name = part.get_param("name", header="content-disposition")  # type: ignore[union-attr]
            job.parts.append((str(name), part.get_filename(), part.get_payload(decode=True)))  # type: ignore[union-attr,arg-type]
        job.settings = json.loads(next(data for name, _, data in job.parts if name == "settings"))
        self.owner.keys[key] = (body, job.id)
        self.owner.new_job(self.owner.add(job))
        self.json(202, job.to_json(), {"Location": f"/v1/jobs/{job.id}"})

    def _list(self, query: dict[str, str]) -> None:
        jobs = [job for job in self.owner.jobs.values() if query.get("state") in (None, job.state)]
        begin, limit = int(query.get("cursor", 0)), int(query.get("limit", 2))
        following = str(begin + limit) if begin + limit < len(jobs) else None
        page = [job.summary() for job in jobs[begin : begin + limit]]
        self.json(200, {"jobs": page, "next": following})

    def _job(self, job: FakeJob, rest: str, headers: dict[str, str], query: dict[str, str]) -> None:
        if job.ends_unseen and self.command != "GET":
            job.state = "done"
        if rest == "/cancel" and self.command == "POST":
            running = job.state in ("queued", "running")
            if running:
                job.cancel_requested = True
                job.state = "running" if job.slow_to_stop else "cancelled"
            self.json(202 if running else 200, job.to_json())
        elif not rest and self.command == "DELETE":
            if job.state in ("queued", "running") and not job.cancel_requested:
                job.cancel_requested = True
                job.state = "running" if job.slow_to_stop else "cancelled"
                self.json(202, job.to_json())
            else:
                del self.owner.jobs[job.id]
                self.send(204, b"", {})
        elif not rest:
            self.json(200, job.to_json())
        elif rest == "/events":
            self._events(job, headers, query)
        elif rest == "/stats":
            self.json(200, self.owner.stats)
        elif rest == "/log":
            self.send(200, b"rendered two frames\n", {"Content-Type": "text/plain; charset=utf-8"})
        elif match := re.fullmatch(r"/frames/(-?\d+)\.(exr|png)", rest):
            self._frame(job, int(match.group(1)), match.group(2))

    def _frame(self, job: FakeJob, number: int, kind: str) -> None:
        if number in job.pending:
            self.problem(409, "The frame is not rendered yet")
        elif number not in job.frames:
            self.problem(404, "The job has no such frame")
        else:
            data = job.frames[number] if kind == "exr" else b"\x89PNG of %d" % number
            etag = self.owner.etag(data)
            if etag and etag in self.headers.get("If-None-Match", "").split(", "):
                self.send(304, b"", {"ETag": etag})
                return
            self.send(200, data, {"Content-Type": "image/x-exr"} | ({"ETag": etag} if etag else {}))

    def _events(self, job: FakeJob, headers: dict[str, str], query: dict[str, str]) -> None:
        after = int(headers.get("last-event-id") or query.get("after") or 0)
        told = [(number, *event) for number, event in enumerate(job.events, start=1) if number > after]
        if "wait" not in query and not told and job.state in ("done", "failed", "cancelled"):
            self.send(204, b"", {})
            return
        if "wait" in query:
            self._finish(job)
            entries = [{"id": str(number), "event": kind, "data": data} for number, kind, data in told]
            self.json(200, {"events": entries, "last": str(len(job.events))})
            return
        self.begin_stream()
        for number, kind, data in told:
            self.tell(number, kind, data)
        self._finish(job)

    def _finish(self, job: FakeJob) -> None:
        job.state = job.after_events or job.state

    def begin_stream(self) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "text/event-stream")
        self.send_header("Connection", "close")
        self.end_headers()

    def tell(self, number: int, kind: str, data: dict[str, Any]) -> None:
        self.wfile.write(f"id: {number}\nevent: {kind}\ndata: {json.dumps(data)}\n\n".encode())

    def json(self, status: int, body: dict[str, Any], headers: dict[str, str] | None = None) -> None:
        self.send(status, json.dumps(body).encode(), {"Content-Type": "application/json"} | (headers or {}))

    def problem(
        self, status: int, title: str, detail: str = "", headers: dict[str, str] | None = None, **extra: Any
    ) -> None:
        body = {"type": "urn:sheaf:problem:test", "title": title, "status": status, "detail": detail, **extra}
        kind = {"Content-Type": "application/problem+json"}
        self.send(status, json.dumps(body).encode(), kind | (headers or {}))

    def send(self, status: int, body: bytes, headers: dict[str, str], announced: int | None = None) -> None:
        """Answers; `announced` other than the body's length cuts the answer short and hangs up."""
        self.send_response(status)
        for name, value in headers.items():
            self.send_header(name, value)
        self.send_header("Content-Length", str(len(body) if announced is None else announced))
        self.end_headers()
        self.wfile.write(body)
        if announced is not None:
            self.close_connection = True

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002
        pass


def sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
