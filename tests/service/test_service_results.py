# SPDX-License-Identifier: MIT
"""Fetching what a job made."""

import csv
import hashlib
import io
import zipfile

import pytest

from conftest import Gate
from service import Service, check_problem, gltf


@pytest.fixture
def done(sheafd: Service) -> str:
    job = sheafd.accepted(gltf(padding=300_000), {"frames": "0-2"})
    assert sheafd.wait(job)["state"] == "done"
    return f"/v1/jobs/{job}"


def test_a_frame_and_its_etag(sheafd: Service, done: str) -> None:
    reply = sheafd.http.get(f"{done}/frames/1.exr")
    assert reply.status_code == 200
    assert reply.headers["Content-Type"] == "image/x-exr"
    frame = sheafd.http.get(done).json()["frames"][1]
    assert frame["sha256"] == hashlib.sha256(reply.content).hexdigest()
    assert frame["bytes"] == len(reply.content)
    etag = reply.headers["ETag"]
    assert etag.startswith('"')
    assert etag != sheafd.http.get(f"{done}/frames/2.exr").headers["ETag"]
    for value, status in ((etag, 304), (f'"x", W/{etag}', 304), ("*", 304), ('"x"', 200)):
        again = sheafd.http.get(f"{done}/frames/1.exr", headers={"If-None-Match": value})
        assert again.status_code == status
        assert again.headers["ETag"] == etag
        assert again.content == (reply.content if status == 200 else b"")
    head = sheafd.http.head(f"{done}/frames/1.exr")
    assert head.status_code == 200
    assert head.content == b""
    assert head.headers["Content-Length"] == str(len(reply.content))
    assert head.headers["ETag"] == etag


def test_ranges(sheafd: Service, done: str) -> None:
    url = f"{done}/frames/0.exr"
    whole = sheafd.http.get(url).content
    size = len(whole)
    for text, part in (
        ("0-3", whole[:4]),
        ("100000-", whole[100000:]),
        ("-10", whole[-10:]),
        (f"5-{size * 2}", whole[5:]),
        (f"-{size * 2}", whole),
        (f"{size - 1}-", whole[-1:]),
    ):
        reply = sheafd.http.get(url, headers={"Range": f"bytes={text}"})
        assert reply.status_code == 206, text
        assert reply.content == part
        first, last = (int(n) for n in reply.headers["Content-Range"].removeprefix("bytes ").split("/")[0].split("-"))
        assert last - first + 1 == len(part) == int(reply.headers["Content-Length"])
        assert reply.headers["Content-Range"].endswith(f"/{size}")
    for text in (f"{size}-", "-0", f"{size + 5}-{size + 9}"):
        reply = sheafd.http.get(url, headers={"Range": f"bytes={text}"})
        check_problem(reply, 416, "range-not-satisfiable")
        assert reply.headers["Content-Range"] == f"bytes */{size}"
    for text in ("bytes=0-1,4-5", "lines=0-1", "bytes=5-2", "bytes=a-b", "bytes=", "bytes=-", "bytes=" + "9" * 4000):
        reply = sheafd.http.get(url, headers={"Range": text})
        assert (reply.status_code, len(reply.content)) == (200, size), text
    etag = sheafd.http.get(url).headers["ETag"]
    assert sheafd.http.get(url, headers={"Range": "bytes=0-0", "If-Range": etag}).status_code == 206
    assert sheafd.http.get(url, headers={"Range": "bytes=0-0", "If-Range": '"old"'}).status_code == 200


def test_previews(sheafd: Service, done: str) -> None:
    reply = sheafd.http.get(f"{done}/frames/0.png")
    assert reply.status_code == 200
    assert reply.headers["Content-Type"] == "image/png"
    assert reply.content.startswith(b"\x89PNG")


def test_frames_that_are_not_there(sheafd: Service, done: str, gate: Gate) -> None:
    for name in ("3.exr", "9999999999999999999999.exr", "x.exr", "1.5.exr", "+1.exr", " 1.exr"):
        check_problem(sheafd.http.get(f"{done}/frames/{name}"), 404, "unknown-frame")
    for name in ("1.tif", ".exr", "1"):
        check_problem(sheafd.http.get(f"{done}/frames/{name}"), 404, "unknown-route")

    named = "/v1/jobs/" + sheafd.accepted(gltf(gates={"1": gate.path}), {"frames": "0-1"})
    sheafd.wait_for_frame(named.removeprefix("/v1/jobs/"), 0)
    assert sheafd.http.get(f"{named}/frames/0.exr").status_code == 200
    early = sheafd.http.get(f"{named}/frames/1.exr")
    check_problem(early, 409, "not-rendered")
    assert early.headers["Retry-After"]
    check_problem(sheafd.http.get(f"{named}/frames/2.exr"), 404, "unknown-frame")
    for route in ("stats", "stats.json", "stats.csv", "frames.zip"):
        check_problem(sheafd.http.get(f"{named}/{route}"), 409, "not-finished")
    gate.open()


def test_frames_the_client_did_not_name(sheafd: Service, gate: Gate) -> None:
    job = sheafd.accepted(gltf(frames=2, gates={"1": gate.path}))
    sheafd.wait_for_frame(job, 0)
    assert [f["frame"] for f in sheafd.job(job)["frames"]] == [0]
    assert sheafd.job(job)["progress"]["total"] == 2
    check_problem(sheafd.http.get(f"/v1/jobs/{job}/frames/7.exr"), 409, "not-rendered")
    gate.open()
    sheafd.wait(job)
    check_problem(sheafd.http.get(f"/v1/jobs/{job}/frames/7.exr"), 404, "unknown-frame")


def test_the_archive(sheafd: Service, done: str) -> None:
    reply = sheafd.http.get(f"{done}/frames.zip")
    assert reply.status_code == 200
    assert int(reply.headers["Content-Length"]) == len(reply.content)
    with zipfile.ZipFile(io.BytesIO(reply.content)) as zipped:
        assert zipped.testzip() is None
        assert zipped.namelist() == ["scene.0000.exr", "scene.0001.exr", "scene.0002.exr"]
        for i in range(3):
            assert zipped.read(f"scene.000{i}.exr") == sheafd.http.get(f"{done}/frames/{i}.exr").content
        assert {i.date_time for i in zipped.infolist()} == {(1980, 1, 1, 0, 0, 0)}
    again = sheafd.http.get(f"{done}/frames.zip", headers={"Range": "bytes=0-1"})
    assert again.status_code == 200
    assert again.content == reply.content
    assert sheafd.http.get(f"{done}/frames.zip", headers={"If-None-Match": reply.headers["ETag"]}).status_code == 304
    head = sheafd.http.head(f"{done}/frames.zip")
    assert head.headers["Content-Length"] == reply.headers["Content-Length"]


def test_the_archive_of_a_failed_job_has_its_whole_frames(sheafd: Service) -> None:
    job = sheafd.accepted(gltf(exit={"code": 6, "message": "disk full"}, at=2), {"frames": "0-5"})
    assert sheafd.wait(job)["state"] == "failed"
    with zipfile.ZipFile(io.BytesIO(sheafd.http.get(f"/v1/jobs/{job}/frames.zip").content)) as zipped:
        assert zipped.namelist() == ["scene.0000.exr", "scene.0001.exr"]
    for route in ("stats", "stats.csv"):
        check_problem(sheafd.http.get(f"/v1/jobs/{job}/{route}"), 404, "not-produced")
    none = sheafd.accepted(gltf(exit={"code": 6, "message": "disk full"}, at=0), {"frames": "0"})
    sheafd.wait(none)
    check_problem(sheafd.http.get(f"/v1/jobs/{none}/frames.zip"), 404, "not-produced")


def test_stats(sheafd: Service, done: str) -> None:
    stats = sheafd.http.get(f"{done}/stats.json")
    assert stats.headers["Content-Type"] == "application/json"
    assert stats.json()["schema"] == 1
    assert sheafd.http.get(f"{done}/stats").json() == stats.json()
    table = sheafd.http.get(f"{done}/stats.csv")
    assert table.headers["Content-Type"].startswith("text/csv")
    rows = list(csv.DictReader(io.StringIO(table.text)))
    assert [row["frame"] for row in rows] == ["0", "1", "2"]
    assert rows[0]["raster_ms"] == "0.5"
    assert rows[0]["sort_ms"] == ""
    assert rows[0]["rays_primary"] == "4"
    assert rows[0]["ray_triangle_primary"] == "2"
    assert rows[0]["brute_force"] == "8"


def test_a_frame_that_was_changed_on_disk_is_not_passed_off(sheafd: Service, done: str) -> None:
    path = sheafd.data / "jobs" / done.rsplit("/", 1)[1] / "frames" / "scene.0000.exr"
    path.write_bytes(b"short")
    check_problem(sheafd.http.get(f"{done}/frames/0.exr"), 500, "internal")
    path.unlink()
    path.symlink_to("/etc/passwd")
    check_problem(sheafd.http.get(f"{done}/frames/0.exr"), 500, "internal")
