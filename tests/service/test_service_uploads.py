# SPDX-License-Identifier: MIT
"""What comes in with a job: scenes, files beside them, archives, cameras; and what must not."""

import base64
import hashlib
import io
import json
import pathlib
import stat
import zipfile
from collections.abc import Callable

import httpx
import pytest

from service import Service, arguments, check_problem, glb, gltf


def archive(entries: dict[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", method) as zipped:
        for name, data in entries.items():
            zipped.writestr(name, data)
    return out.getvalue()


def test_a_gltf_with_its_files(sheafd: Service) -> None:
    parts = [("file", ("scene.bin", b"buffer")), ("file", ("textures/wood grain.png", b"image"))]
    job = sheafd.accepted(gltf(), parts=parts)
    folder = sheafd.data / "jobs" / job / "scene"
    assert (folder / "scene.bin").read_bytes() == b"buffer"
    assert (folder / "textures" / "wood grain.png").read_bytes() == b"image"


@pytest.mark.parametrize("written", ["say %22hi%22.png", 'say \\"hi\\".png'])
def test_file_names_with_quotes(sheafd: Service, written: str) -> None:
    part = b'--b\r\nContent-Disposition: form-data; name="%s"; filename="%s"\r\n\r\n{}\r\n'
    body = part % (b"scene", b"s.gltf") + part % (b"file", written.encode()) + b"--b--\r\n"
    reply = sheafd.http.post("/v1/jobs", content=body, headers={"Content-Type": "multipart/form-data; boundary=b"})
    assert reply.status_code == 202, reply.text
    assert (sheafd.data / "jobs" / reply.json()["id"] / "scene" / 'say "hi".png').read_text() == "{}"


def test_a_camera_is_passed_on(sheafd: Service) -> None:
    camera = {"version": 1, "keys": []}
    job = sheafd.accepted(gltf(), {"frames": 0}, parts=[("camera", ("path.json", json.dumps(camera)))])
    assert sheafd.wait(job)["scene"]["camera"] is True
    told = [a for a in arguments(sheafd, job) if a.startswith("--camera=")]
    assert json.loads(pathlib.Path(told[0].removeprefix("--camera=")).read_text()) == camera
    refused = sheafd.submit(gltf(), {"camera-node": 0}, parts=[("camera", (None, "{}"))])
    check_problem(refused, 422, "bad-settings")
    check_problem(sheafd.submit(gltf(), parts=[("camera", (None, "{nope"))]), 400, "malformed-json")
    check_problem(sheafd.submit(gltf(), parts=[("camera", (None, "[]"))]), 422, "bad-settings")


def test_scenes_by_name_media_type_and_content(sheafd: Service) -> None:
    assert sheafd.wait(sheafd.accepted(glb(), name="C:\\models\\Box.GLB"))["scene"]["name"] == "Box.GLB"
    untyped = [("scene", ("upload", glb(), "model/gltf-binary"))]
    assert sheafd.http.post("/v1/jobs", files=untyped).json()["scene"]["name"] == "upload.glb"
    check_problem(sheafd.submit(b"solid", name="scene.stl"), 415, "unsupported-media-type")
    check_problem(sheafd.submit(b"", name="scene.gltf"), 422, "bad-scene")
    check_problem(sheafd.submit(gltf(), name="scene.glb"), 422, "bad-scene")
    check_problem(sheafd.submit(b"PK nonsense", name="scene.zip"), 422, "bad-scene")


def test_a_zipped_scene(sheafd: Service) -> None:
    zipped = archive({"dir/": b"", "scene.gltf": gltf(), "dir/a.bin": b"1", "__MACOSX/._scene.gltf": b"?"})
    job = sheafd.wait(sheafd.accepted(zipped, name="scene.zip"))
    assert job["state"] == "done"
    assert job["scene"]["name"] == "scene.gltf"
    assert not (sheafd.data / "jobs" / job["id"] / "upload.zip").exists()


@pytest.mark.parametrize(
    "entries",
    [
        {"a.gltf": gltf(), "b.glb": glb()},
        {"one/a.gltf": gltf(), "two/b.glb": glb()},
        {"one/a.gltf": gltf(), "two/deeper/b.glb": glb()},
        {"dir/a.bin": b"", "__MACOSX/a.gltf": gltf(), "dir/._a.gltf": gltf()},
        {"dir\\..\\..\\a.gltf": gltf()},
        {"C:\\models\\a.gltf": gltf()},
        {"\\\\host\\share\\a.gltf": gltf()},
        {"a.gltf": gltf(), "tex/b": b"1", "tex\\b": b"2"},
        {"a.gltf": gltf(), "./a.gltf": gltf()},
        {"../a.gltf": gltf()},
        {"/a.gltf": gltf()},
        {"a.gltf": gltf(), "b/../../c": b""},
        {"a.gltf": gltf(), "x\\..\\y": b""},
        {"a.gltf": gltf(), "a.gltf/b": b""},
        {},
    ],
)
def test_bad_archives(sheafd: Service, entries: dict[str, bytes]) -> None:
    check_problem(sheafd.submit(archive(entries), name="s.zip"), 422, "bad-scene")
    assert not list((sheafd.data / "incoming").iterdir())


@pytest.mark.parametrize(
    ("entries", "scene"),
    [
        ({"model/": b"", "model/a.gltf": gltf(), "model/tex/a.bin": b"1"}, "model/a.gltf"),
        ({"for you/model/a.gltf": gltf(), "for you/model/tex/a.bin": b"1"}, "for you/model/a.gltf"),
        ({"a.gltf": gltf(), "tex\\a.bin": b"1"}, "a.gltf"),
        ({"model\\": b"", "model\\a.gltf": gltf(), "model\\tex\\a.bin": b"1"}, "model/a.gltf"),
        ({"./model/a.gltf": gltf(), "./model/tex/a.bin": b"1"}, "model/a.gltf"),
        (
            {
                "model/a.gltf": gltf(),
                "model/tex/a.bin": b"1",
                "model/.DS_Store": b"?",
                "model/Icon\r": b"",
                "__MACOSX/model/._a.gltf": b"?",
                "__MACOSX/._model": b"?",
            },
            "model/a.gltf",
        ),
        (
            {"model/a.gltf": gltf(), "model/tex/a.bin": b"1", "model/old/b.gltf": gltf(), "model/old/c.glb": b""},
            "model/a.gltf",
        ),
        ({"source/a.GLTF": gltf(), "source/tex/a.bin": b"1", "textures/b.png": b"2"}, "source/a.GLTF"),
    ],
)
def test_archives_as_people_make_them(sheafd: Service, entries: dict[str, bytes], scene: str) -> None:
    job = sheafd.wait(sheafd.accepted(archive(entries), {"frames": 0}, name="s.zip"))
    assert job["state"] == "done", job
    assert job["scene"]["name"] == scene
    folder = sheafd.data / "jobs" / job["id"] / "scene"
    assert ((folder / scene).parent / "tex" / "a.bin").read_bytes() == b"1"
    left = [str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()]
    assert not [name for name in left if "MACOSX" in name or "._" in name or "DS_Store" in name or "Icon" in name]


def test_a_folder_that_is_sent_as_parts(sheafd: Service) -> None:
    """Names as a page sends a folder that was chosen, from its parent on; in whatever order."""
    for separator in "/", "\\":
        name = separator.join(("model", "a.gltf"))
        parts = [
            ("file", (separator.join(("model", "tex", "a.bin")), b"1")),
            ("scene", (name, gltf())),
            ("file", (separator.join(("model", "b.bin")), b"2")),
        ]
        reply = sheafd.http.post("/v1/jobs", files=parts)
        assert reply.status_code == 202, reply.text
        assert reply.json()["scene"]["name"] == "model/a.gltf"
        folder = sheafd.data / "jobs" / reply.json()["id"] / "scene" / "model"
        assert sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()) == [
            "a.gltf",
            "b.bin",
            "tex/a.bin",
        ]
    # Files that are named from the scene on stay beside it, whatever folder the scene came from.
    apart = [("scene", ("models/a.gltf", gltf())), ("file", ("a.bin", b"1")), ("file", ("models/b.bin", b"2"))]
    assert sheafd.http.post("/v1/jobs", files=apart).json()["scene"]["name"] == "a.gltf"
    twice = [("scene", ("model/a.gltf", gltf())), ("file", ("model/a.gltf", gltf()))]
    check_problem(sheafd.http.post("/v1/jobs", files=twice), 422, "bad-scene")


def test_a_link_in_an_archive(sheafd: Service) -> None:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as zipped:
        zipped.writestr("a.gltf", gltf())
        link = zipfile.ZipInfo("passwd")
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        zipped.writestr(link, "/etc/passwd")
    assert "link" in check_problem(sheafd.submit(out.getvalue(), name="s.zip"), 422, "bad-scene")["detail"]


def test_a_damaged_archive(sheafd: Service) -> None:
    data = bytearray(archive({"a.gltf": gltf() + b" " * 100}, zipfile.ZIP_STORED))
    data[60] ^= 1
    assert "checksum" in check_problem(sheafd.submit(bytes(data), name="s.zip"), 422, "bad-scene")["detail"]


def test_archive_bombs(start: Callable[..., Service]) -> None:
    service = start("--max-unpacked", "8", "--max-zip-entries", "20", "--max-zip-ratio", "100")
    ratio = check_problem(service.submit(archive({"a.gltf": b" " * 4_000_000}), name="s.zip"), 413, "too-large")
    assert ratio["limit"] == 100
    assert "ratio" in ratio["detail"]
    many = archive({f"{i}": b"" for i in range(21)})
    assert check_problem(service.submit(many, name="s.zip"), 413, "too-large")["limit"] == 20
    size = archive({"a.gltf": bytes(range(256)) * 40_000}, zipfile.ZIP_STORED)
    assert check_problem(service.submit(size, name="s.zip"), 413, "too-large")["limit"] == 8 << 20


@pytest.mark.parametrize(
    "name", ["../x.bin", "/etc/x", "a/../b", "a//b", "x\\..\\y", "C:\\x", "\\x", "", ".", "a/" * 20 + "x", "n" * 300]
)
def test_bad_file_names(sheafd: Service, name: str) -> None:
    body = (
        b'--b\r\nContent-Disposition: form-data; name="scene"; filename="s.gltf"\r\n\r\n{}\r\n'
        b'--b\r\nContent-Disposition: form-data; name="file"; filename="'
        + name.replace("\\", "\\\\").encode()
        + b'"\r\n\r\nx\r\n--b--\r\n'
    )
    reply = sheafd.http.post("/v1/jobs", content=body, headers={"Content-Type": "multipart/form-data; boundary=b"})
    check_problem(reply, 422, "bad-scene")
    assert not list((sheafd.data / "incoming").iterdir())


def test_bad_multipart(sheafd: Service) -> None:
    def post(body: bytes, kind: str = "multipart/form-data; boundary=b") -> httpx.Response:
        return sheafd.http.post("/v1/jobs", content=body, headers={"Content-Type": kind})

    part = b'--b\r\nContent-Disposition: form-data; name="scene"; filename="s.gltf"\r\n\r\n{}\r\n'
    check_problem(post(b"{}", "application/json"), 415, "unsupported-media-type")
    check_problem(post(b"", "multipart/form-data"), 400, "malformed-multipart")
    check_problem(post(b""), 400, "malformed-multipart")
    check_problem(post(part), 400, "malformed-multipart")
    check_problem(post(part + part + b"--b--"), 400, "malformed-multipart")
    check_problem(post(part + b"--bogus"), 400, "malformed-multipart")
    check_problem(post(b"--b\r\n\r\nx\r\n--b--"), 400, "malformed-multipart")
    check_problem(post(part.replace(b'"scene"', b'"stage"') + b"--b--"), 400, "malformed-multipart")
    check_problem(sheafd.submit(gltf(), parts=[("settings", (None, "{"))]), 400, "malformed-json")
    check_problem(sheafd.submit(gltf(), parts=[("settings", (None, "[]"))]), 422, "bad-settings")
    check_problem(sheafd.http.post("/v1/jobs", files=[("settings", (None, "{}"))]), 422, "bad-scene")
    twice = [("file", ("a", b"1")), ("file", ("a", b"2"))]
    check_problem(sheafd.submit(gltf(), parts=twice), 422, "bad-scene")
    assert not list((sheafd.data / "incoming").iterdir())
    assert not list((sheafd.data / "jobs").iterdir())


def test_uploads_are_bounded(start: Callable[..., Service]) -> None:
    service = start("--max-upload", "1", "--max-parts", "4")
    problem = check_problem(service.submit(gltf() + b" " * (2 << 20)), 413, "too-large")
    assert problem["limit"] == 1 << 20 < problem["value"]
    parts = [("file", (str(i), b"")) for i in range(4)]
    assert check_problem(service.submit(gltf(), parts=parts), 413, "too-large")["limit"] == 4

    def chunks():  # no Content-Length: counted as it comes
        for _ in range(64):
            yield b" " * 65536

    reply = service.http.post("/v1/jobs", content=chunks(), headers={"Content-Type": "multipart/form-data; boundary=b"})
    check_problem(reply, 413, "too-large")
    assert not list((service.data / "incoming").iterdir())


PART = b'--b\r\nContent-Disposition: form-data; name="scene"; filename="s.gltf"\r\n\r\n%s\r\n'


def sha256(body: bytes) -> str:
    return f"sha-256=:{base64.b64encode(hashlib.sha256(body).digest()).decode()}:"


@pytest.mark.parametrize("more", ["", ", sha-512=:YWJj:", ",unknown=1"])
def test_an_upload_that_is_what_its_digest_says(sheafd: Service, more: str) -> None:
    body = PART % gltf() + b"--b--\r\nepilogue"
    headers = {"Content-Type": "multipart/form-data; boundary=b", "Content-Digest": sha256(body) + more}
    reply = sheafd.http.post("/v1/jobs", content=body, headers=headers)
    assert reply.status_code == 202, reply.text


@pytest.mark.parametrize("at", [0, 3, 30, 110, -3, -1])
def test_an_upload_that_changed_on_its_way_is_refused_whole(sheafd: Service, at: int) -> None:
    body = bytearray(PART % (gltf() + b" " * 70_000) + b"--b--\r\nepilogue")
    headers = {"Content-Type": "multipart/form-data; boundary=b", "Content-Digest": sha256(bytes(body))}
    body[at] ^= 1
    for content in (bytes(body), iter([bytes(body[:100]), bytes(body[100:])])):  # by length, and in chunks
        problem = check_problem(sheafd.http.post("/v1/jobs", content=content, headers=headers), 422, "digest-mismatch")
        assert hashlib.sha256(body).hexdigest() in problem["detail"]
    assert not list((sheafd.data / "incoming").iterdir())
    assert not list((sheafd.data / "jobs").iterdir())


@pytest.mark.parametrize(
    "digest", ["sha-256", "sha-256=", "sha-256=::", "sha-256=:" + "A" * 44 + ":", "sha-256=:" + "A" * 42 + "B=:", "x"]
)
def test_malformed_digests(sheafd: Service, digest: str) -> None:
    headers = {"Content-Type": "multipart/form-data; boundary=b", "Content-Digest": digest}
    check_problem(sheafd.http.post("/v1/jobs", content=b"", headers=headers), 400, "malformed-request")
