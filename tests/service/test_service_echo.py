# SPDX-License-Identifier: MIT
"""Whatever a client sends, a refusal repeats at most 200 characters of it, on one line."""

import io
import json
import zipfile
from collections.abc import Callable

import httpx
import pytest

from service import Service, gltf

LONG = "x" * 100_000
NAME = "x" * 900  # as long as a request target, a multipart header or a zip entry may well be


def archive(name: str) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as zipped:
        zipped.writestr(name, b"")
        zipped.writestr(name + ".gltf", gltf())
        zipped.writestr(name + ".glb", gltf())
    return out.getvalue()


def multipart(disposition: str) -> Callable[[Service], httpx.Response]:
    body = f"--b\r\nContent-Disposition: form-data; {disposition}\r\n\r\n\r\n--b--\r\n"
    headers = {"Content-Type": "multipart/form-data; boundary=b"}
    return lambda sheafd: sheafd.http.post("/v1/jobs", content=body, headers=headers)


def settings(text: str) -> Callable[[Service], httpx.Response]:
    return lambda sheafd: sheafd.submit(gltf(), parts=[("settings", (None, text))])


REFUSED: dict[str, Callable[[Service], httpx.Response]] = {
    "a setting's name": settings(json.dumps({LONG: 1})),
    "a setting's name in another script": settings(json.dumps({"\u6728" * 30_000: 1})),
    "a name with line ends": settings(json.dumps({"a\n" * 30_000: 1})),
    "a layer": settings(json.dumps({"aov": LONG})),
    "a layer of a list": settings(json.dumps({"aov": ["Z" + NAME[:200]] * 100})),
    "frames": settings(json.dumps({"frames": LONG})),
    "a range of frames": settings(json.dumps({"frames": "1-2:" + LONG})),
    "a file name's pattern": settings(json.dumps({"name": NAME[:255]})),
    "a choice": settings(json.dumps({"strategy": LONG})),
    "a size": settings(json.dumps({"size": LONG})),
    "a string that does not end": settings('{"' + LONG),
    "a number that JSON does not hold": settings("1" * 100_000 + "e"),
    "a scene's file name": lambda sheafd: sheafd.submit(b"", name=NAME),
    "a file's name": lambda sheafd: sheafd.submit(gltf(), parts=[("file", (NAME, b""))]),
    "a file's absolute name": lambda sheafd: sheafd.submit(gltf(), parts=[("file", ("/" + NAME, b""))]),
    "a file's name twice": lambda sheafd: sheafd.submit(
        gltf(), parts=[("file", (f"{NAME[:250]}/{NAME[:250]}", b""))] * 2
    ),
    "a part's name": multipart(f'name="{NAME}"'),
    "a parameter twice": multipart(f'name="file"; {NAME}="1"; {NAME}="2"'),
    "a media type": lambda sheafd: sheafd.http.post("/v1/jobs", files=[("scene", ("", b"", "a/" + NAME))]),
    "names in an archive": lambda sheafd: sheafd.submit(archive(f"{NAME[:250]}/{NAME[:240]}"), name="s.zip"),
    "an archive's long name": lambda sheafd: sheafd.submit(archive(NAME), name="s.zip"),
    "a query's argument": lambda sheafd: sheafd.http.get("/v1/jobs", params={NAME: 1}),
    "a query's value": lambda sheafd: sheafd.http.get("/v1/jobs", params={"limit": NAME}),
    "a path": lambda sheafd: sheafd.http.get("/" + NAME),
    "a job": lambda sheafd: sheafd.http.get("/v1/jobs/" + NAME),
    "a method": lambda sheafd: sheafd.http.request(NAME, "/"),
    "a method at a path": lambda sheafd: sheafd.http.put("/v1/jobs/" + NAME),
    "a header": lambda sheafd: sheafd.http.post("/v1/jobs", headers={"Idempotency-Key": NAME}),
    "a digest": lambda sheafd: sheafd.http.post("/v1/jobs", headers={"Content-Digest": "sha-256=" + NAME}),
    "a token": lambda sheafd: sheafd.http.get("/v1/jobs/x", headers={"Authorization": "Bearer " + NAME}),
}


@pytest.mark.parametrize("what", REFUSED)
def test_a_refusal_is_short(sheafd: Service, what: str) -> None:
    reply = REFUSED[what](sheafd)
    assert 400 <= reply.status_code <= 501, reply.text[:1000]
    problem = reply.json()
    assert len(reply.content) < 2000
    for text in problem.values():
        if isinstance(text, str):
            assert "x" * 201 not in text
            assert "\u6728" * 201 not in text
            assert not any(ord(character) < 32 for character in text)


def test_a_short_name_is_repeated_whole(sheafd: Service) -> None:
    problem = sheafd.submit(gltf(), {"y" * 200: 1}).json()
    assert problem["detail"] == "settings." + "y" * 200 + ": there is no such setting"
    assert problem["pointer"] == "/" + "y" * 200
    problem = sheafd.submit(gltf(), {"y" * 201: 1}).json()
    assert problem["detail"] == "settings." + "y" * 200 + "…: there is no such setting"
    assert "pointer" not in problem
