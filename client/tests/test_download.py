# SPDX-License-Identifier: MIT
"""Downloads over real HTTP: whole files or none."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import httpx
import pytest

import sheaf
from fake_service import FakeJob, FakeService, Handler, sha256
from faults import cut_short, problem


def test_download(client: sheaf.Client, done_job: FakeJob, tmp_path: Path, exr: bytes) -> None:
    told: list[tuple[int, Path]] = []
    out = tmp_path / "a" / "b"
    paths = client.job("abc").download(
        out, previews=True, name="box.####.exr", on_file=lambda number, path: told.append((number, path))
    )
    assert [path.name for path in paths] == ["box.0003.exr", "box.0003.png", "box.0004.exr", "box.0004.png"]
    assert [path for _, path in told] == paths
    assert paths[0].read_bytes() == exr
    assert paths[3].read_bytes() == b"\x89PNG of 4"
    assert sorted(out.iterdir()) == paths  # and nothing else


def test_download_leaves_whole_files_alone(
    client: sheaf.Client, service: FakeService, done_job: FakeJob, tmp_path: Path, exr: bytes
) -> None:
    job = client.job("abc")
    first, second = job.download(tmp_path)
    second.write_bytes(exr[:-1])
    service.requests.clear()
    assert job.download(tmp_path) == [first, second]
    assert [request[1] for request in service.asked("GET .*exr")] == ["/v1/jobs/abc/frames/4.exr"]
    assert second.read_bytes() == exr
    service.requests.clear()
    job.download(tmp_path, overwrite=True, numbers=[3])
    assert len(service.asked("GET .*exr")) == 1


def test_download_believes_checksums_only(
    client: sheaf.Client, service: FakeService, done_job: FakeJob, tmp_path: Path, exr: bytes
) -> None:
    (path,) = client.job("abc").download(tmp_path, numbers=[3])
    path.write_bytes(b"\0" * len(exr))  # as long, but another
    client.job("abc").download(tmp_path, numbers=[3])
    assert path.read_bytes() == exr
    path.unlink()
    service.fault("GET .*3.exr", lambda h: h.send(200, b"\0" * len(exr), {}), times=10)
    with pytest.raises(sheaf.TransportError, match="checksum"):
        client.job("abc").download(tmp_path, numbers=[3])
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("length", [32, 64])
def test_previews_are_compared_by_their_etag(
    client: sheaf.Client, service: FakeService, done_job: FakeJob, tmp_path: Path, length: int
) -> None:
    service.etag = lambda data: f'"{sha256(data)[:length]}"'
    _, preview = client.job("abc").download(tmp_path, numbers=[3], previews=True)
    preview.write_bytes(b"\0" * preview.stat().st_size)
    client.job("abc").download(tmp_path, numbers=[3], previews=True)
    assert preview.read_bytes() == b"\x89PNG of 3"
    before = preview.stat().st_mtime_ns, preview.stat().st_ino
    client.job("abc").download(tmp_path, numbers=[3], previews=True)
    assert (preview.stat().st_mtime_ns, preview.stat().st_ino) == before


def test_an_etag_that_is_a_checksum_is_checked(
    client: sheaf.Client, service: FakeService, done_job: FakeJob, tmp_path: Path
) -> None:
    service.etag = lambda data: f'"{sha256(b"other")}"'
    with pytest.raises(sheaf.TransportError, match="checksum"):
        client.job("abc").download(tmp_path, numbers=[3], previews=True, overwrite=True)


@pytest.mark.parametrize("name", ["../%d.exr", "/tmp/%d.exr", "a\\%d.exr", ".%d.exr", "%d.sh", "C:%d.exr", "\n%d.exr"])
def test_the_services_names_cannot_leave_the_folder(
    client: sheaf.Client, done_job: FakeJob, tmp_path: Path, name: str
) -> None:
    done_job.name = name
    out = tmp_path / "out"
    assert client.job("abc").download(out, numbers=[3]) == [out / "frame.0003.exr"]
    assert list(tmp_path.iterdir()) == [out]


def test_a_truncated_download_is_fetched_again(
    client: sheaf.Client, service: FakeService, done_job: FakeJob, tmp_path: Path, exr: bytes
) -> None:
    service.fault("GET .*3.exr", cut_short(exr), times=2)
    (path,) = client.job("abc").download(tmp_path, numbers=[3])
    assert path.read_bytes() == exr
    assert list(tmp_path.iterdir()) == [path]
    service.fault("GET .*3.exr", cut_short(exr))
    assert client.job("abc").frame(3).size == (6, 4)


def test_a_download_that_never_gets_whole_leaves_no_file(
    client: sheaf.Client, service: FakeService, done_job: FakeJob, tmp_path: Path, exr: bytes
) -> None:
    service.fault("GET .*4.exr", cut_short(exr), times=10)
    with pytest.raises(sheaf.TransportError):
        client.job("abc").download(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["box.0003.exr"]


def test_a_transport_that_does_not_count_bytes_is_counted(tmp_path: Path, exr: bytes, pauses: list[float]) -> None:
    def answer(request: httpx.Request) -> httpx.Response:
        if not request.url.path.endswith(".exr"):
            return httpx.Response(200, json={"id": "abc", "state": "done"})
        return httpx.Response(200, stream=httpx.ByteStream(exr[:100]), headers={"Content-Length": str(len(exr))})

    with sheaf.Client("http://x", transport=httpx.MockTransport(answer)) as client:
        job = client.job("abc")
        with pytest.raises(sheaf.TransportError, match=f"100 of {len(exr)} bytes"):
            job.download(tmp_path, numbers=[1])
        with pytest.raises(sheaf.TransportError, match="100 of"):
            job.frame(1)
    assert list(tmp_path.iterdir()) == []


def test_download_errors_are_clear(
    client: sheaf.Client, service: FakeService, done_job: FakeJob, tmp_path: Path
) -> None:
    job = client.job("abc")
    for name in ("frame.exr", "a/####.exr", "##.##.exr", "####.png", "\n#.exr"):
        with pytest.raises(ValueError, match="name"):
            job.download(tmp_path, name=name)
    with pytest.raises(sheaf.NotFound):
        job.download(tmp_path, numbers=[9])
    service.fault("GET .*3.exr", problem(410, "The job was removed"))
    with pytest.raises(sheaf.NotFound, match="410 The job was removed"):
        job.download(tmp_path, numbers=[3])
    (tmp_path / "file").touch()
    with pytest.raises(OSError, match="file"):
        job.download(tmp_path / "file")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_downloaded_files_have_the_users_permissions(client: sheaf.Client, done_job: FakeJob, tmp_path: Path) -> None:
    mask = os.umask(0o027)
    try:
        (path,) = client.job("abc").download(tmp_path, numbers=[3])
    finally:
        os.umask(mask)
    assert path.stat().st_mode & 0o777 == 0o640


def test_numbers_in_names() -> None:
    from sheaf._names import FrameNames, default_pattern

    names = FrameNames("a.##.b.exr")
    assert [names.frame(number) for number in (7, 123, -5)] == ["a.07.b.exr", "a.123.b.exr", "a.-5.b.exr"]
    for number in (-12345, -123, -2, 0, 12):
        assert FrameNames("####.exr").frame(number) == "%04d.exr" % number  # noqa: UP031 - the very format
    assert default_pattern("dir/box.glb") == "box.####.exr"
    assert default_pattern("a#b\n.glb") == "a_b_.####.exr"


def test_files_are_fetched_side_by_side_and_told_in_order(
    client: sheaf.Client, service: FakeService, tmp_path: Path, exr: bytes
) -> None:
    """Two answers that each wait for the other's request: one after the other they would never come."""
    service.add(FakeJob("many", frames=dict.fromkeys(range(6), exr)))
    meeting = threading.Barrier(2, timeout=60)

    def meet(handler: Handler) -> None:
        meeting.wait()
        handler.send(200, exr, {})

    service.fault(r"GET .*/[01]\.exr", meet, times=2)
    told: list[int] = []
    paths = client.job("many").download(tmp_path, connections=2, on_file=lambda number, _: told.append(number))
    assert told == list(range(6))
    assert all(path.read_bytes() == exr for path in paths)
    assert len(paths) == 6


def test_after_a_failure_nothing_more_is_begun(
    client: sheaf.Client, service: FakeService, tmp_path: Path, exr: bytes
) -> None:
    service.add(FakeJob("many", frames=dict.fromkeys(range(50), exr)))
    service.fault("GET .*/0.exr", problem(410, "The job was removed"))
    with pytest.raises(sheaf.NotFound):
        client.job("many").download(tmp_path, connections=1)
    assert len(service.asked("GET .*exr")) < 50


def test_links_stay_and_fifos_are_written_through(client: sheaf.Client, done_job: FakeJob, tmp_path: Path) -> None:
    far, fifo = tmp_path / "far", tmp_path / "out" / "box.0003.exr"
    fifo.parent.mkdir()
    far.mkdir()
    (tmp_path / "link").symlink_to("far")
    os.mkfifo(fifo)
    got: list[bytes] = []
    reader = threading.Thread(target=lambda: got.append(fifo.read_bytes()), daemon=True)
    reader.start()
    client.job("abc").download(fifo.parent, numbers=[3])
    reader.join(60)
    assert got == [done_job.frames[3]]
    assert fifo.is_fifo()
    named = tmp_path / "box.0003.exr"
    named.symlink_to("link/frame")
    client.job("abc").download(tmp_path, numbers=[3])
    assert named.is_symlink()
    assert (far / "frame").read_bytes() == done_job.frames[3]
    assert [path.name for path in far.iterdir()] == ["frame"]


def test_texts_are_written_through_links_and_descriptors(tmp_path: Path) -> None:
    from sheaf._files import write_whole

    (tmp_path / "link").symlink_to("file")
    write_whole(tmp_path / "link", "text")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "file").read_text() == "text"
    with (tmp_path / "log").open("wb") as log:
        log.write(b"before ")
        log.flush()
        write_whole(Path(f"/dev/fd/{log.fileno()}"), "text ")
        log.write(b"after")
    assert (tmp_path / "log").read_bytes() == b"before text after"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "link", "log"]
