# SPDX-License-Identifier: MIT
"""Downloads to files that appear under their name only when they are whole.

A symbolic link stays, and what it leads to is replaced; a FIFO or a device is written once all is there.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import secrets
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import httpx

from ._errors import TransportError
from ._http import check_length
from ._targets import find_write_target


class WholeFile:
    """Receives an answer's body beside its target, and takes the target's name once it is whole."""

    def __init__(self, target: Path) -> None:
        self._target = find_write_target(target)
        self._part = None if self._target.is_stream else _part_name(self._target.path)
        self._file: IO[bytes] = (
            tempfile.TemporaryFile()  # noqa: SIM115 - closed by `discard`
            if self._part is None
            else self._part.open("xb")
        )
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
        if self._part is None:
            self._file.seek(0)
            self._target.send(self._file.read())
            return
        self._file.flush()
        os.fsync(self._file.fileno())
        self._file.close()
        self._part.replace(self._target.path)

    def discard(self) -> None:
        """Removes what is there of an unfinished file; does nothing after `finish`."""
        self._file.close()
        if self._part is not None:
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
    end = find_write_target(target)
    if end.is_stream:
        end.send(data)
        return
    part = _part_name(end.path)
    try:
        part.write_bytes(data)
        part.replace(end.path)
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
