# SPDX-License-Identifier: MIT
"""`sheaf-client jobs | status | cancel | download`: what there is on the service."""

from __future__ import annotations

import argparse
import itertools
import json
from typing import Any, get_args

from .._job import Job
from .._models import JobState
from .._progress import words
from ._connect import add_output, add_server, checked_name, connect
from ._render import fetch
from ._report import Report


def add(commands: Any) -> None:
    """Adds the commands."""
    jobs = commands.add_parser("jobs", help="list jobs, newest first")
    jobs.add_argument("--state", choices=get_args(JobState))
    jobs.add_argument("--limit", type=int, default=50, help="how many (default 50)")
    jobs.add_argument("--json", action="store_true", help="one JSON object a line")
    jobs.set_defaults(run=run_jobs)

    status = commands.add_parser("status", help="how a job is")
    status.add_argument("--json", action="store_true", help="all that the service says")
    status.add_argument("--log", action="store_true", help="what the renderer printed, too")
    status.set_defaults(run=run_status)

    cancel = commands.add_parser("cancel", help="stop jobs")
    cancel.add_argument("--delete", action="store_true", help="and remove them with their frames")
    cancel.set_defaults(run=run_cancel)

    download = commands.add_parser("download", help="fetch a job's frames; what is there already is left alone")
    add_output(download)
    download.add_argument("--wait", action="store_true", help="first wait until the job is over")
    download.add_argument("--overwrite", action="store_true", help="fetch again what is there")
    download.set_defaults(run=run_download)

    for parser in (status, download):
        parser.add_argument("job", metavar="JOB")
    cancel.add_argument("job", metavar="JOB", nargs="+")
    for parser in (jobs, status, cancel, download):
        add_server(parser)


def run_jobs(arguments: argparse.Namespace, report: Report) -> None:
    """Lists jobs."""
    with connect(arguments) as client:
        page_size = max(1, min(arguments.limit, 100))
        for job in itertools.islice(client.jobs(arguments.state, page_size=page_size), max(0, arguments.limit)):
            print(json.dumps(job.info.raw) if arguments.json else _line(job))


def run_status(arguments: argparse.Namespace, report: Report) -> None:
    """Tells how a job is."""
    with connect(arguments) as client:
        job = client.job(arguments.job)
        print(json.dumps(job.info.raw, indent=1) if arguments.json else _line(job))
        if arguments.log:
            print(job.log(), end="")


def run_cancel(arguments: argparse.Namespace, report: Report) -> None:
    """Stops jobs."""
    with connect(arguments) as client:
        for job_id in arguments.job:
            job = client.job(job_id)
            if arguments.delete:
                job.delete()
                print(f"{job_id}  deleted")
            else:
                print(_line(job.cancel()))


def run_download(arguments: argparse.Namespace, report: Report) -> None:
    """Fetches frames."""
    if arguments.name:
        checked_name(arguments.name)
    with connect(arguments) as client:
        fetch(client.job(arguments.job), arguments, report, wait=arguments.wait, overwrite=arguments.overwrite)


def _line(job: Job) -> str:
    error = job.info.error
    reason = f"  {error.get('message', '')}" if error else ""
    state = "stopping" if job.info.cancel_requested and not job.info.is_over else job.state
    return f"{job.id}  {state:9}  {words(job.progress)}{reason}"
