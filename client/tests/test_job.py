# SPDX-License-Identifier: MIT
"""Watching, frames, cancelling over real HTTP."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import sheaf
from conftest import colour
from fake_service import FakeJob, FakeService, Handler
from faults import hang_up, problem

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


def test_gives_up_when_the_service_stays_away(
    client: sheaf.Client, service: FakeService, running: FakeJob, pauses: list[float]
) -> None:
    service.fault("GET .*/events", hang_up, times=1000)
    with pytest.raises(sheaf.TransportError):
        client.job("abc").wait()
    assert sum(pauses) == pytest.approx(sheaf.RetryPolicy().outage)
    assert max(pauses) == sheaf.RetryPolicy().longest_pause


def test_a_long_outage_is_waited_out_wherever_it_falls(
    client: sheaf.Client, service: FakeService, running: FakeJob, pauses: list[float]
) -> None:
    """Longer than a single call is patient for: before the events, within them, and after the last."""
    job = client.job("abc")
    service.fault("GET", hang_up, times=9)
    service.fault("GET .*/events", problem(503, "The service starts"), times=2)
    service.fault("GET .*abc$", hang_up, times=9)
    assert job.wait().state == "done"
    assert sum(pauses) > 20


def test_a_service_that_restarts_is_waited_for(
    client: sheaf.Client, service: FakeService, running: FakeJob, pauses: list[float]
) -> None:
    """Its streams end well but empty when it stops; then nobody is there for a while."""
    job = client.job("abc")
    service.fault("GET .*/events", lambda handler: handler.begin_stream())
    service.fault("GET", hang_up, times=6)
    told = list(job.events())
    assert [event.id for event in told] == ["1", "2", "3", "4", "5"]
    assert sum(pauses) > 10


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
    assert service.asked("DELETE") == []
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
    service.fault("POST", hang_up)
    service.fault("POST", cancel_and_hang_up)
    job = client.job("abc")
    assert job.cancel().info.cancel_requested
    assert job.cancel().state == "running"
    assert len(service.asked("POST")) == 4
    assert list(service.jobs) == ["abc"]


def test_a_job_that_ends_while_it_is_cancelled_keeps_its_frames(
    client: sheaf.Client, service: FakeService, running: FakeJob
) -> None:
    running.ends_unseen = True
    job = client.job("abc")
    assert job.state == "running"
    assert job.cancel().state == "done"
    assert [frame.number for frame in job.frames()] == [3]


def test_events_after_the_last_one_are_none(client: sheaf.Client, running: FakeJob) -> None:
    running.state = "done"
    assert list(client.job("abc").events(after="5")) == []
