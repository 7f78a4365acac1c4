# SPDX-License-Identifier: MIT
"""Names that users rely on: adding is free, taking away is not."""

from __future__ import annotations

import inspect

import sheaf

NAMES = [
    "ApiError",
    "AsyncClient",
    "AsyncJob",
    "CameraKey",
    "CameraPath",
    "Client",
    "Conflict",
    "DamagedUpload",
    "DeviceStats",
    "Event",
    "Frame",
    "FrameError",
    "FrameState",
    "FrameStats",
    "InvalidRequest",
    "Job",
    "JobCancelled",
    "JobError",
    "JobFailed",
    "JobInfo",
    "JobState",
    "Layer",
    "LeftOut",
    "NotFound",
    "Progress",
    "ProgressBar",
    "ProtocolError",
    "RenderError",
    "RenderSettings",
    "RetryPolicy",
    "SceneError",
    "SceneStats",
    "SheafError",
    "Stats",
    "TestStats",
    "Timeout",
    "TooLarge",
    "TotalStats",
    "TransportError",
    "Unauthorized",
    "Unavailable",
    "__version__",
    "read_exr",
]

JOB = "cancel delete download events frame frames id info log preview progress refresh state stats wait"

MEMBERS = {
    sheaf.Client: "close health job jobs submit",
    sheaf.AsyncClient: "close health job jobs submit",
    sheaf.Job: JOB,
    sheaf.AsyncJob: JOB,
    sheaf.Frame: "attributes layers number rgba size",
    sheaf.CameraPath: "fov_axis fps from_dict interpolation keys load look_at_keys loop save to_dict turntable",
    sheaf.JobInfo: "cancel_requested created error expires frames id is_over progress rendered settings state warnings",
    sheaf.Progress: "done eta_s fraction state total",
    sheaf.Event: "data ends_job id type",
}

SETTINGS = """animation aov camera_node compression cutoff count depth device environment filter fps frames instances
memory name opaque preview primary quality scene_name size sort spp strategy"""


def test_exported_names() -> None:
    assert sorted(sheaf.__all__) == sorted(NAMES)
    assert all(hasattr(sheaf, name) for name in NAMES)


def test_members() -> None:
    for owner, names in MEMBERS.items():
        fields = set(getattr(owner, "__dataclass_fields__", ())) | {name for name in dir(owner) if name[0] != "_"}
        fields |= {"info"} if owner in (sheaf.Job, sheaf.AsyncJob) else set()
        missing = set(names.split()) - fields
        assert not missing, f"{owner.__name__}: {missing}"


def test_settings() -> None:
    """None of these may go: programs use them. Which there are is the engine's table's to say."""
    assert set(SETTINGS.split()) <= set(sheaf.RenderSettings.__annotations__)


def test_parameters() -> None:
    def parameters(function: object) -> list[str]:
        return [name for name in inspect.signature(function).parameters if name != "self"]  # type: ignore[arg-type]

    assert parameters(sheaf.Client) == ["url", "token", "timeout", "transport", "retry"]
    assert parameters(sheaf.Client.submit) == ["scene", "camera", "idempotency_key", "settings"]
    assert parameters(sheaf.Client.jobs) == ["state", "page_size"]
    assert parameters(sheaf.Job.wait) == ["progress", "timeout"]
    assert parameters(sheaf.Job.frames) == ["numbers"]
    assert parameters(sheaf.Job.download)[:3] == ["folder", "previews", "overwrite"]
    for name in JOB.replace("info", "").split():
        blocking, other = getattr(sheaf.Job, name), getattr(sheaf.AsyncJob, name)
        if inspect.isfunction(blocking):
            assert parameters(blocking) == parameters(other), name
    for name in ("__init__", "submit", "jobs", "job", "health", "close"):
        assert parameters(getattr(sheaf.Client, name)) == parameters(getattr(sheaf.AsyncClient, name)), name
    assert parameters(sheaf.CameraPath.turntable)[:6] == ["center", "radius", "height", "seconds", "fps", "fov_degrees"]


def test_the_tree_of_exceptions() -> None:
    tree = {
        sheaf.SheafError: (
            sheaf.SceneError,
            sheaf.FrameError,
            sheaf.TransportError,
            sheaf.ProtocolError,
            sheaf.Timeout,
            sheaf.ApiError,
            sheaf.JobError,
        ),
        sheaf.ApiError: (
            sheaf.InvalidRequest,
            sheaf.Unauthorized,
            sheaf.NotFound,
            sheaf.Conflict,
            sheaf.DamagedUpload,
            sheaf.TooLarge,
            sheaf.Unavailable,
        ),
        sheaf.JobError: (sheaf.JobFailed, sheaf.JobCancelled),
        ValueError: (sheaf.SceneError, sheaf.FrameError),
        TimeoutError: (sheaf.Timeout,),
    }
    for parent, children in tree.items():
        assert all(issubclass(child, parent) for child in children)


def test_every_public_thing_is_described() -> None:
    for name in NAMES:
        thing = getattr(sheaf, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            assert thing.__doc__, name
