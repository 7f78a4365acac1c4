# SPDX-License-Identifier: MIT
"""What tests of failures look at: processes, files and what the service says of them."""

import pathlib

from service import Service


def workers_of(data: pathlib.Path) -> list[int]:
    """Living processes that render for the service whose data this is."""
    found = []
    for place in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            words = place.read_bytes().split(b"\0")
            ours = b"render" in words and any(w.startswith(str(data).encode()) for w in words)
            if ours and ") Z" not in place.with_name("stat").read_text():
                found.append(int(place.parent.name))
        except OSError:
            continue
    return found


def begun(service: Service, job: str) -> list[int]:
    """Frames that workers began, in order, as the fake one notes them down."""
    return [int(line) for line in (service.data / "jobs" / job / "ledger").read_text().split()]


def check_frames(service: Service, job: dict) -> None:
    """Every frame that the job says it has can be fetched, is whole, and is there once."""
    for frame in job["frames"]:
        if frame["state"] != "done":
            continue
        data = service.http.get(frame["exr"]).content
        assert data.startswith(b"v/1\x01")
        assert len(data) == frame["bytes"]
    numbers = [frame["frame"] for frame in job["frames"]]
    assert numbers == sorted(set(numbers))
    assert job["progress"]["done"] == sum(frame["state"] == "done" for frame in job["frames"])
