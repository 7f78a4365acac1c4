# SPDX-License-Identifier: MIT
"""The service's routes: one function each, giving what to send and how to read the answer."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal
from urllib.parse import quote

import httpx

from ._camera import CameraPath
from ._errors import ProtocolError, SceneError
from ._http import Call, Part, json_object, whole_body
from ._models import EventPage, JobInfo, JobPage
from ._scene import collect_scene
from ._settings import wire_settings
from ._stats import Stats
from ._watch import SILENCE_SECONDS

CameraSource = str | os.PathLike[str] | Mapping[str, Any] | CameraPath
SceneSource = str | os.PathLike[str] | bytes

# Frames are compressed inside; asking for them as they are lets their length be checked.
_AS_THEY_ARE = {"accept": "*/*", "accept-encoding": "identity"}


def submit(
    scene: SceneSource, camera: CameraSource | None, settings: Mapping[str, Any], idempotency_key: str
) -> Call[JobInfo]:
    """`POST /v1/jobs`."""
    text = json.dumps(wire_settings(settings), allow_nan=False)
    parts = [_json_part("settings", text.encode())]
    if camera is not None:
        parts.append(_json_part("camera", _camera_bytes(camera)))
    parts += collect_scene(scene).parts()
    # The same boundary in every try: the service compares bodies under one key.
    boundary = hashlib.sha256(idempotency_key.encode()).hexdigest()[:32]
    headers = {
        "idempotency-key": idempotency_key,
        "content-type": f"multipart/form-data; boundary=sheaf-{boundary}",
    }
    return Call("POST", "v1/jobs", _job_info, headers=headers, parts=parts)


def job(job_id: str) -> Call[JobInfo]:
    """`GET /v1/jobs/{id}`."""
    return Call("GET", _path(job_id), _job_info)


def jobs(state: str | None, cursor: str | None, limit: int | None) -> Call[JobPage]:
    """`GET /v1/jobs`."""
    params = {"state": state, "cursor": cursor, "limit": None if limit is None else str(limit)}
    given = {name: value for name, value in params.items() if value is not None}
    return Call("GET", "v1/jobs", lambda response: JobPage.from_json(json_object(response)), params=given)


def cancel(job_id: str) -> Call[JobInfo]:
    """`POST /v1/jobs/{id}/cancel`: never removes a job, whatever it does meanwhile."""
    return Call("POST", _path(job_id, "cancel"), _job_info)


def delete(job_id: str) -> Call[None]:
    """`DELETE /v1/jobs/{id}`."""
    return Call("DELETE", _path(job_id), lambda response: None)


def listen(job_id: str, after: str | None) -> Call[None]:
    """`GET /v1/jobs/{id}/events` as a stream."""
    headers = {"accept": "text/event-stream", "cache-control": "no-store"}
    if after is not None:
        headers["last-event-id"] = after
    return Call("GET", _path(job_id, "events"), lambda _: None, headers=headers, read_timeout=SILENCE_SECONDS)


def poll(job_id: str, after: str | None, seconds: float) -> Call[EventPage]:
    """`GET /v1/jobs/{id}/events?wait=`."""
    params = {"wait": f"{seconds:.3f}".rstrip("0").rstrip(".")}
    if after is not None:
        params["after"] = after
    return Call(
        "GET",
        _path(job_id, "events"),
        lambda response: EventPage.from_json(json_object(response)),
        params=params,
        read_timeout=seconds + 10.0,  # the service answers late by its own delays, not by more
    )


def frame(job_id: str, number: int, kind: Literal["exr", "png"], have: str | None = None) -> Call[bytes]:
    """`GET /v1/jobs/{id}/frames/{n}.exr` or `.png`; `have`, the SHA-256 of a file that is there, allows a 304."""
    headers = dict(_AS_THEY_ARE)
    if have is not None:
        headers["if-none-match"] = f'"{have}", "{have[:32]}"'  # the service's tags are the checksum, or its first half
    accept = frozenset((304,) if have is not None else ())
    return Call("GET", _path(job_id, "frames", f"{number}.{kind}"), whole_body, headers=headers, accept=accept)


def stats(job_id: str) -> Call[Stats]:
    """`GET /v1/jobs/{id}/stats`."""
    return Call("GET", _path(job_id, "stats"), _stats)


def log(job_id: str) -> Call[str]:
    """`GET /v1/jobs/{id}/log`."""
    return Call("GET", _path(job_id, "log"), lambda response: response.text, headers={"accept": "text/plain"})


def health(name: Literal["healthz", "readyz"]) -> Call[dict[str, Any]]:
    """`GET /healthz` or `/readyz`; a text answer is given as `{"status": text}`."""
    return Call("GET", name, _health)


def _path(*steps: str) -> str:
    if any(step in ("", ".", "..") for step in steps):
        raise ValueError(f"{steps[0]!r} is not a job's id")
    return "v1/jobs/" + "/".join(quote(step, safe="") for step in steps)


def _job_info(response: httpx.Response) -> JobInfo:
    return JobInfo.from_json(json_object(response))


def _stats(response: httpx.Response) -> Stats:
    body = json_object(response)
    if body.get("schema") != 1:
        raise ProtocolError(f"{response.request.url}: stats of schema {body.get('schema')!r}, not 1")
    return body  # type: ignore[return-value]


def _health(response: httpx.Response) -> dict[str, Any]:
    if "json" in response.headers.get("content-type", ""):
        return json_object(response)
    return {"status": response.text.strip()}


def _json_part(name: str, text: bytes) -> Part:
    return Part(name, f"{name}.json", "application/json", lambda: text)


def _camera_bytes(camera: CameraSource) -> bytes:
    if isinstance(camera, CameraPath):
        camera = camera.to_dict()
    if isinstance(camera, Mapping):
        return json.dumps(dict(camera), allow_nan=False).encode()
    try:
        return Path(camera).read_bytes()
    except OSError as error:
        raise SceneError(f"{os.fspath(camera)}: {error.strerror or error}") from error
