# SPDX-License-Identifier: MIT
"""Client for sheafd, the Sheaf render service: glTF animations in, EXR frames as NumPy arrays out."""

from ._async_client import AsyncClient
from ._async_job import AsyncJob
from ._camera import CameraKey, CameraPath
from ._client import Client
from ._errors import (
    ApiError,
    Conflict,
    DamagedUpload,
    FrameError,
    InvalidRequest,
    JobCancelled,
    JobError,
    JobFailed,
    NotFound,
    ProtocolError,
    RenderError,
    SceneError,
    SheafError,
    Timeout,
    TooLarge,
    TransportError,
    Unauthorized,
    Unavailable,
)
from ._exr import Frame, Layer, read_exr
from ._http import RetryPolicy
from ._job import Job
from ._models import Event, FrameState, JobInfo, JobState, Progress
from ._progress import ProgressBar
from ._settings import RenderSettings
from ._stats import DeviceStats, FrameStats, LeftOut, SceneStats, Stats, TestStats, TotalStats
from ._version import __version__

__all__ = [
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
