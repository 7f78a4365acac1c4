# SPDX-License-Identifier: MIT
"""Watching, frames and downloads over real HTTP."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from conftest import colour
from fake_service import FakeJob, FakeService, Handler, cut_short, hang_up, problem, sha256

import sheaf

FRAME_EVENTS: list[tuple[str, dict[str, Any]]] = [
    ("state", {"state": "running"}),
    ("start", {"frames": 2}),
    ("frame", {"frame": 3, "done": 1, "total": 2, "eta_s": 4.0, "wall_ms": 5.0}),
    ("frame", {"frame": 4, "done": 2, "total": 2, "eta_s": 0, "wall_ms": 5.0}),
]
FAILURE = {"code": "bad-scene", "message": "box.glb: meshes[0]: no", "exit_code": 3, "signal": None}
DONE = ("state", {"state": "done"})


@pytest.fixture
def running(service: FakeService, exr: bytes) -> FakeJob:
    return service.add(
        FakeJob("abc", "running", {3: exr}, pending=[4], events=[*FRAME_EVENTS, DONE], after_events="done")
    )


def break_off(after: int) -> Any:
    """A fault: an event stream that tells some events and half of another, and is lost."""

    def fault(handler: Handler) -> None:
        handler.begin_stream()
        for number, (kind, data) in enumerate(FRAME_EVENTS[:after], start=1):
            handler.tell(number, kind, data)
        handler.wfile.write(f'id: {after + 1}\nevent: frame\ndata: {{"frame": '.encode())

    return fault


def test_wait_follows_the_stream(client: sheaf.Client, service: FakeService, running: FakeJob) -> None:
    seen: list[sheaf.Progress] = []
    job = client.job("abc")
    assert job.wait(progress=seen.append) is job
    assert job.state == "done"
    assert seen[0].state == "running"
    assert sheaf.Progress("running", 1, 2, 0.5, 4.0) in seen
    assert seen[-1].state == "done"
    assert len(service.asked("GET .*/events")) == 1


def test_a_lost_stream_goes_on_after_the_last_event(
    client: sheaf.Client, service: FakeService, running: FakeJob, pauses: list[float]
) -> None:
    service.fault("GET .*/events", break_off(2))
    service.fault("GET .*/events", hang_up)
    told = list(client.job("abc").events())
    assert [event.id for event in told] == ["1", "2", "3", "4", "5"]
    streams = service.asked("GET .*/events")
    assert [headers.get("last-event-id") for _, _, headers in streams] == [None, "2", "2"]


def test_polls_where_streams_do_not_get_through(client: sheaf.Client, service: FakeService, running: FakeJob) -> None:
    service.fault("GET .*/events$", hang_up, times=100)
    assert [event.id for event in client.job("abc").events(after="2")] == ["3", "4", "5"]
    *streams, poll = service.asked("GET .*/events")
    assert len(streams) == 2
    assert poll[1].endswith("/events?wait=20&after=2")


def test_polls_where_the_answer_is_no_stream(client: sheaf.Client, service: FakeService, running: FakeJob) -> None:
    service.fault("GET .*/events$", lambda h: h.json(200, {"events": [], "last": "0"}), times=100)
    assert [event.id for event in client.job("abc").events()] == ["1", "2", "3", "4", "5"]
    assert len(service.asked("GET .*/events$")) == 1


def test_gives_up_when_the_service_stays_away(client: sheaf.Client, service: FakeService, running: FakeJob) -> None:
    service.fault("GET .*/events", hang_up, times=1000)
    with pytest.raises(sheaf.TransportError):
        client.job("abc").wait()
    assert len(service.asked("GET .*/events")) == 8


def test_a_service_that_ends_streams_at_once_is_not_hammered(
    client: sheaf.Client, service: FakeService, running: FakeJob, pauses: list[float]
) -> None:
    running.events, running.after_events = [], None

    def poll(handler: Handler) -> None:
        if len(service.asked("events.wait")) == 5:
            running.state = "done"
        handler.json(200, {"events": [], "last": "0"})

    service.fault("events.wait", poll, times=5)
    client.job("abc").wait()
    assert len(service.asked("GET .*/events")) == 7
    assert all(0.5 < pause <= 1.0 for pause in pauses[:6])


def test_wait_ends_where_the_stream_does_not_tell_the_end(
    client: sheaf.Client, service: FakeService, running: FakeJob
) -> None:
    running.events = running.events[:-1]
    assert client.job("abc").wait().state == "done"


def test_timeout_is_the_callers(client: sheaf.Client, service: FakeService, running: FakeJob) -> None:
    running.events, running.after_events = [], None
    ticking = iter(range(1000))
    client._session.now = lambda: float(next(ticking))  # type: ignore[method-assign]
    with pytest.raises(sheaf.Timeout, match="goes on") as caught:
        client.job("abc").wait(timeout=10)
    assert isinstance(caught.value, TimeoutError)
    assert service.asked("events$") == []  # a stream could not end in time
    waits = [float(target.partition("wait=")[2].partition("&")[0]) for _, target, _ in service.asked("events.wait")]
    assert waits
    assert all(wait <= 10 for wait in waits)


def test_progress_never_goes_back(client: sheaf.Client, service: FakeService, running: FakeJob, exr: bytes) -> None:
    """The first events told are older than the answer that came before them."""
    running.frames, running.pending = {3: exr, 4: exr}, [5]
    seen: list[sheaf.Progress] = []
    client.job("abc").wait(progress=seen.append)
    assert [progress.done for progress in seen] == [2] * len(seen)


def test_failure_and_cancellation(client: sheaf.Client, service: FakeService) -> None:
    service.add(FakeJob("bad", "failed", error=FAILURE))
    with pytest.raises(sheaf.JobFailed, match=r"bad failed \(bad-scene\): box.glb") as caught:
        client.job("bad").wait()
    error = caught.value
    assert (error.code, error.message, error.exit_code) == ("bad-scene", "box.glb: meshes[0]: no", 3)
    service.add(FakeJob("worse", "failed", error={"code": "worker-crashed", "exit_code": None, "signal": 11}))
    with pytest.raises(sheaf.JobFailed, match=r"worse failed \(worker-crashed\): unknown"):
        client.job("worse").wait()
    service.add(FakeJob("off", "cancelled"))
    with pytest.raises(sheaf.JobCancelled) as cancelled:
        client.job("off").wait()
    assert cancelled.value.job_id == "off"


def test_a_job_that_goes_away_while_watched(client: sheaf.Client, service: FakeService, running: FakeJob) -> None:
    job = client.job("abc")
    del service.jobs["abc"]
    with pytest.raises(sheaf.NotFound):
        job.wait()


def test_progress_true_draws(client: sheaf.Client, running: FakeJob, capsys: pytest.CaptureFixture[str]) -> None:
    client.job("abc").wait(progress=True)
    captured = capsys.readouterr()
    assert captured.out == ""
    assert " 50%  1/2 frames" in captured.err
    assert "100%  2/2 frames" in captured.err


def test_frames_as_arrays(client: sheaf.Client, service: FakeService, running: FakeJob) -> None:
    job = client.job("abc")
    (frame,) = job.frames()
    assert frame.number == 3
    np.testing.assert_array_equal(frame.rgba[..., 0], colour(4, 6)["R"].astype(np.float32))
    assert [frame.number for frame in job.frames([3, 3])] == [3, 3]
    with pytest.raises(sheaf.Conflict):
        job.frame(4)
    with pytest.raises(sheaf.NotFound):
        job.frame(5)
    assert job.preview(3) == b"\x89PNG of 3"


def test_stats_log_cancel_delete(client: sheaf.Client, service: FakeService, running: FakeJob) -> None:
    job = client.job("abc")
    assert job.stats()["totals"]["rays_per_second"] == 5.0
    assert job.log() == "rendered two frames\n"
    assert job.cancel().state == "cancelled"
    assert job.cancel().state == "cancelled"
    assert len(service.asked("DELETE")) == 1
    job.delete()
    job.delete()
    with pytest.raises(sheaf.NotFound):
        job.refresh()
    service.stats = {"schema": 2}
    service.add(FakeJob("abc"))
    with pytest.raises(sheaf.ProtocolError, match="schema 2"):
        job.stats()


@pytest.mark.parametrize("slow", [False, True])
def test_delete_stops_what_runs(client: sheaf.Client, service: FakeService, running: FakeJob, slow: bool) -> None:
    running.slow_to_stop = slow
    client.job("abc").delete()
    assert service.jobs == {}


def test_cancelling_twice_or_with_a_lost_answer_never_removes(
    client: sheaf.Client, service: FakeService, running: FakeJob
) -> None:
    def cancel_and_hang_up(handler: Handler) -> None:
        running.cancel_requested = True
        hang_up(handler)

    running.slow_to_stop = True
    service.fault("DELETE", hang_up)
    service.fault("DELETE", cancel_and_hang_up)
    job = client.job("abc")
    assert job.cancel().info.cancel_requested
    assert job.cancel().state == "running"
    assert len(service.asked("DELETE")) == 2
    assert list(service.jobs) == ["abc"]


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


def test_previews_are_compared_by_their_etag(
    client: sheaf.Client, service: FakeService, done_job: FakeJob, tmp_path: Path
) -> None:
    service.etag = lambda data: f'"{sha256(data)}"'
    _, preview = client.job("abc").download(tmp_path, numbers=[3], previews=True)
    preview.write_bytes(b"\0" * preview.stat().st_size)
    client.job("abc").download(tmp_path, numbers=[3], previews=True)
    assert preview.read_bytes() == b"\x89PNG of 3"
    assert len(service.asked("GET .*png")) == 2
    client.job("abc").download(tmp_path, numbers=[3], previews=True)
    assert len(service.asked("GET .*png")) == 2
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
    assert [names.frame(number) for number in (7, 123, -5)] == ["a.07.b.exr", "a.123.b.exr", "a.-05.b.exr"]
    assert default_pattern("dir/box.glb") == "box.####.exr"
    assert default_pattern("a#b\n.glb") == "a_b_.####.exr"
