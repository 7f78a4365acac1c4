# SPDX-License-Identifier: MIT
"""What `/metrics` tells: well-formed, documented, and no series that says nothing."""

import pathlib
import re

from service import Service, gltf

README = pathlib.Path(__file__).resolve().parents[2] / "server" / "README.md"


def samples(service: Service) -> dict[str, str]:
    lines = [line for line in service.http.get("/metrics").text.splitlines() if not line.startswith("#")]
    return dict(line.rsplit(" ", 1) for line in lines)


def test_metrics_are_well_formed(sheafd: Service) -> None:
    sheafd.wait(sheafd.accepted(gltf(), {"frames": "0-3"}))
    reply = sheafd.http.get("/metrics")
    assert reply.headers["Content-Type"].startswith("text/plain; version=0.0.4")
    sample = re.compile(r'^[a-z_]+(\{[a-z_]+="[^"]*"(,[a-z_]+="[^"]*")*\})? -?[0-9.e+-]+$')
    lines = [line for line in reply.text.splitlines() if not line.startswith("#")]
    assert lines
    assert all(sample.match(line) for line in lines)
    assert 'sheaf_jobs{state="done"} 1' in lines
    assert "sheaf_frames_rendered_total 4" in lines
    assert 'sheaf_http_requests_total{method="POST",status="202"} 1' in lines


def test_every_metric_is_documented_and_every_documented_one_is_there(sheafd: Service) -> None:
    sheafd.wait_until_ready()
    sheafd.wait(sheafd.accepted(gltf(), {"frames": 0}))
    told = set(re.findall(r"^# TYPE (sheaf_\w+) ", sheafd.http.get("/metrics").text, re.M))
    section = README.read_text().split("## Metrics and logs", 1)[1].split("\n## ", 1)[0]
    assert told == set(re.findall(r"`(sheaf_[a-z_]+)", section))


def test_what_the_frames_measured_is_summed(sheafd: Service) -> None:
    before = samples(sheafd)
    assert not [name for name in before if name.startswith(("sheaf_stage_seconds", "sheaf_tests_total"))]
    sheafd.wait(sheafd.accepted(gltf(wall_ms=61728394.5), {"frames": "0-1"}))
    told = samples(sheafd)
    assert told['sheaf_stage_seconds_sum{stage="frame"}'] == "123456.789"  # to the millisecond, after a day too
    assert told['sheaf_stage_seconds_count{stage="raster"}'] == "2"
    assert told['sheaf_rays_total{kind="primary"}'] == "8"
    # Counts by level are lists, which are no series: one without a number would say that there were no tests.
    assert {name: value for name, value in told.items() if name.startswith("sheaf_tests_total")} == {
        'sheaf_tests_total{test="ray_triangle",kind="primary"}': "4"
    }
