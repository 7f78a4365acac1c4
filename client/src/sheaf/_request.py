# SPDX-License-Identifier: MIT
"""What a request to the service is made of, whoever sends it."""

from __future__ import annotations

import base64
import contextlib
import hashlib
from typing import Any

import httpx

from ._http import Call, Part
from ._version import __version__


def checked_url(url: str) -> str:
    """The address of a service.

    Raises:
        ValueError: it is not an http or https one.
    """
    try:
        scheme = httpx.URL(url).scheme
    except httpx.InvalidURL as error:
        raise ValueError(f"{url!r}: {error}") from error
    if scheme not in ("http", "https"):
        raise ValueError(f"{url!r}: the service's address must begin with http:// or https://")
    return url


def own_headers(token: str | None) -> dict[str, str]:
    """What every request says."""
    headers = {"user-agent": f"sheaf-client/{__version__}", "accept": "application/json"}
    return headers | ({"authorization": f"Bearer {token}"} if token else {})


def build_request(
    http: httpx.Client | httpx.AsyncClient, call: Call[Any], files: contextlib.ExitStack | None = None
) -> httpx.Request:
    """The request of a call; its files are closed by `files`, and without it there are none."""
    multipart = [_opened(part, files) for part in call.parts] if files is not None else []
    request = http.build_request(
        call.method, call.path, params=call.params, headers=call.headers, files=multipart or None
    )
    if call.read_timeout is not None:
        request.extensions["timeout"]["read"] = call.read_timeout
    return request


def tell_digest(request: httpx.Request, call: Call[Any]) -> None:
    """Adds the checksum of an upload, for the service to hold against what arrives (RFC 9530). Reads its files once."""
    if not call.parts or not isinstance(request.stream, httpx.SyncByteStream):
        return
    digest = hashlib.sha256()
    for block in request.stream:
        digest.update(block)
    request.headers["content-digest"] = f"sha-256=:{base64.b64encode(digest.digest()).decode()}:"


def _opened(part: Part, files: contextlib.ExitStack) -> tuple[str, tuple[str | None, Any, str]]:
    content = part.open()
    if hasattr(content, "close"):
        files.callback(content.close)
    return part.field, (part.filename, content, part.content_type)
