# SPDX-License-Identifier: MIT
"""Everything this package raises on purpose.

::

    SheafError
    ├── SceneError            a scene, or a file it refers to, cannot be sent (also a ValueError)
    ├── FrameError            an EXR file cannot be read as a frame (also a ValueError)
    ├── TransportError        the service was not reached, fell silent, or the connection broke
    ├── ProtocolError         the answer is not what a sheafd sends
    ├── RenderError           the program `sheaf` did not render, on this machine or on one of a farm
    ├── Timeout               the caller's own limit passed while waiting (also a TimeoutError)
    ├── ApiError              the service refused, as problem+json (RFC 9457)
    │   ├── InvalidRequest    400, 422: settings, scene or camera are bad
    │   ├── DamagedUpload     422 of type digest-mismatch: what arrived is not what was sent
    │   ├── Unauthorized      401, 403: no token, a wrong one, or one without the needed scope
    │   ├── NotFound          404; 410 once it was there and is no more
    │   ├── Conflict          409: not in this state, for example a frame not rendered yet
    │   ├── TooLarge          413, and 422 of type limit-exceeded: a stated limit was exceeded
    │   └── Unavailable       429, 503: full or not ready; `retry_after` says when to ask again
    └── JobError              the job ended without all its frames
        ├── JobFailed
        └── JobCancelled

Wrong use of the API itself (an unknown setting, a camera that looks nowhere) is a TypeError or ValueError.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


class SheafError(Exception):
    """Root of all failures."""


class SceneError(SheafError, ValueError):
    """The scene, or a file it refers to, cannot be sent; the text names the file, the place and the reason."""


class FrameError(SheafError, ValueError):
    """A file is not a whole EXR frame."""


class TransportError(SheafError):
    """No whole answer came: refused, lost, silent for too long, or cut short. Worth trying again."""


class ProtocolError(SheafError):
    """An answer came that does not follow the contract, for example from a server that is not sheafd."""


class Timeout(SheafError, TimeoutError):  # noqa: N818 - reads as what happened
    """The time that the caller allowed for waiting is over; the job goes on."""


class RenderError(SheafError):
    """The program `sheaf` did not do what it was asked to.

    Attributes:
        exit_code: the program's, as `sheaf --help` lists them; None where a signal or a time limit ended it.
    """

    def __init__(self, text: str, exit_code: int | None = None) -> None:
        super().__init__(text)
        self.exit_code = exit_code

    def __reduce__(self) -> tuple[type[RenderError], tuple[str, int | None]]:
        return type(self), (str(self), self.exit_code)  # it travels between machines


class ApiError(SheafError):
    """The service answered with a problem.

    Attributes:
        status: HTTP status.
        type: URI reference that names the kind of problem; "about:blank" where there is none.
        title: the kind in words.
        detail: what is wrong this time; may be empty.
        extra: further members of the problem, for example `limit` and `value`.
    """

    def __init__(
        self,
        status: int,
        title: str,
        detail: str = "",
        *,
        type: str = "about:blank",  # noqa: A002 - the name RFC 9457 gives it
        extra: Mapping[str, Any] | None = None,
    ) -> None:
        super().__init__(f"{status} {title}: {detail}" if detail else f"{status} {title}")
        self.status = status
        self.type = type
        self.title = title
        self.detail = detail
        self.extra: dict[str, Any] = dict(extra or {})


class InvalidRequest(ApiError):  # noqa: N818
    """400 or 422: the settings, the scene or the camera path are bad."""


class DamagedUpload(ApiError):  # noqa: N818
    """422 of type digest-mismatch: the upload changed on its way. Worth trying again."""


class Unauthorized(ApiError):  # noqa: N818
    """401 or 403: the token is missing, wrong, or lacks the needed scope."""


class NotFound(ApiError):  # noqa: N818
    """404: no such job or frame. 410: it has been removed."""


class Conflict(ApiError):  # noqa: N818
    """409: the job is not in a state that allows this."""


class TooLarge(ApiError):  # noqa: N818
    """413, or 422 of type limit-exceeded: a limit was exceeded; `extra` may hold the limit and the value."""


class Unavailable(ApiError):  # noqa: N818
    """429 or 503: the queue is full, the disk is low, or the service is not ready.

    Attributes:
        retry_after: seconds to wait before the next try, where the service says so.
    """

    def __init__(
        self,
        status: int,
        title: str,
        detail: str = "",
        *,
        type: str = "about:blank",  # noqa: A002
        extra: Mapping[str, Any] | None = None,
        retry_after: float | None = None,
    ) -> None:
        super().__init__(status, title, detail, type=type, extra=extra)
        self.retry_after = retry_after


class JobError(SheafError):
    """A job ended without all its frames; those that are whole can still be fetched.

    Attributes:
        job_id: the job.
    """

    def __init__(self, job_id: str, text: str) -> None:
        super().__init__(text)
        self.job_id = job_id


class JobFailed(JobError):  # noqa: N818
    """The job failed.

    Attributes:
        code: the service's word for the kind of failure, for example "bad-scene".
        message: one line that names the place and the reason.
        exit_code: that of the renderer; None where it had none, for example because it was killed.
    """

    def __init__(self, job_id: str, code: str, message: str, exit_code: int | None = None) -> None:
        super().__init__(job_id, f"job {job_id} failed ({code}): {message}")
        self.code = code
        self.message = message
        self.exit_code = exit_code


class JobCancelled(JobError):  # noqa: N818
    """The job was cancelled."""

    def __init__(self, job_id: str) -> None:
        super().__init__(job_id, f"job {job_id} was cancelled")
