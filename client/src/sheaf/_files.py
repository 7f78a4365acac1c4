# SPDX-License-Identifier: MIT
"""Downloads to files that appear under their name only when they are whole."""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import secrets
from collections.abc import Iterator
from pathlib import Path

import httpx

from ._errors import TransportError
from ._http import check_length


class WholeFile:
    """Receives an answer's body beside its target, and takes the target's name once it is whole."""

    def __init__(self, target: Path) -> None:
        self._part = _part_name(target)
        self._file = self._part.open("xb")
        self._target = target
        self._received = 0
        self._digest = hashlib.sha256()

    def write(self, data: bytes) -> None:
        """Takes the next bytes."""
        self._file.write(data)
        self._digest.update(data)
        self._received += len(data)

    def finish(self, response: httpx.Response, sha256: str | None = None) -> None:
        """Checks what came against what was announced, in the answer or before, and renames.

        Raises:
            TransportError: bytes are missing, or they are not those that the service has.
        """
        check_length(response, self._received)
        announced = {sha256, sha256_of(response)} - {None}
        if announced - {self._digest.hexdigest()}:
            raise TransportError(f"{response.request.url}: the bytes that came are not those of its checksum")
        self._file.flush()
        os.fsync(self._file.fileno())
        self._file.close()
        self._part.replace(self._target)

    def discard(self) -> None:
        """Removes what is there of an unfinished file; does nothing after `finish`."""
        self._file.close()
        self._part.unlink(missing_ok=True)


@contextlib.contextmanager
def whole_file(target: Path) -> Iterator[WholeFile]:
    """A `WholeFile` that leaves nothing behind where it was not finished."""
    file = WholeFile(target)
    try:
        yield file
    finally:
        file.discard()


def write_whole(target: Path, text: str) -> None:
    """Writes a text file, whole or not at all."""
    write_whole_bytes(target, text.encode())


def write_whole_bytes(target: Path, data: bytes) -> None:
    """Writes a file, whole or not at all."""
    part = _part_name(target)
    try:
        part.write_bytes(data)
        part.replace(target)
    finally:
        part.unlink(missing_ok=True)


def sha256_of(response: httpx.Response) -> str | None:
    """The SHA-256 of the whole body, where the ETag is one."""
    match = re.fullmatch(r'"(?:sha256[-:])?([0-9a-f]{64})"', response.headers.get("etag", ""))
    return match.group(1) if match else None


def file_sha256(path: Path) -> str:
    """The SHA-256 of a file, in hexadecimal."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def _part_name(target: Path) -> Path:
    return target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
