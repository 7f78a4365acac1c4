# SPDX-License-Identifier: MIT
"""The farm's files against the tools that will read them: Open Job Description's runner, Kubernetes' schemas, Slurm."""

from __future__ import annotations

import importlib
import os
import pathlib
import shutil
import subprocess
import sys
from typing import Any, NoReturn

import pytest

import slurm_node

HERE = pathlib.Path(__file__).resolve().parent
FARM = HERE.parent.parent / "farm"
FAKE = HERE.parent.parent / "client" / "tests" / "fake_sheaf.py"
PATIENCE = 120


@pytest.fixture
def sheaf(tmp_path: pathlib.Path) -> pathlib.Path:
    """A program that renders by formula, under this Python."""
    program = tmp_path / "sheaf"
    program.write_text(f'#!/bin/sh\necho "$@" >> "{tmp_path}/calls"\nexec "{sys.executable}" "{FAKE}" "$@"\n')
    program.chmod(0o755)
    return program


@pytest.fixture
def scene(tmp_path: pathlib.Path) -> pathlib.Path:
    path = tmp_path / "box.glb"
    path.touch()
    return path


def frames(folder: pathlib.Path) -> list[str]:
    return sorted(path.name for path in folder.glob("*.exr"))


def lacks(what: str) -> NoReturn:
    """Leaves a test out; where the tools were said to be there (SHEAF_REQUIRE_TOOLS=1), that is a failure."""
    if os.environ.get("SHEAF_REQUIRE_TOOLS") == "1":
        pytest.fail(f"no {what}")
    pytest.skip(f"no {what}")


def module(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError:
        lacks(name)


def tool(name: str) -> str:
    beside = pathlib.Path(sys.executable).parent / name
    found = str(beside) if beside.is_file() else shutil.which(name)
    return found or lacks(name)


def test_open_job_description(sheaf: pathlib.Path, scene: pathlib.Path, tmp_path: pathlib.Path) -> None:
    openjd, template = tool("openjd"), FARM / "openjd" / "sheaf.yaml"
    subprocess.run([openjd, "check", template, "--extensions", "TASK_CHUNKING"], check=True, timeout=PATIENCE)
    out = tmp_path / "out"
    parameters = {
        "Scene": scene,
        "Out": out,
        "Frames": "0-6",
        "FramesAChunk": 3,
        "Sheaf": sheaf,
        "Options": "--size=8x4 --spp=2",
    }
    command: list[str | pathlib.Path] = [openjd, "run", template, "--extensions", "TASK_CHUNKING", "--step", "Render"]
    command += [f"-p{name}={value}" for name, value in parameters.items()]
    subprocess.run(command, check=True, timeout=PATIENCE, cwd=tmp_path)
    assert frames(out) == [f"box.{number:04d}.exr" for number in range(7)]
    calls = (tmp_path / "calls").read_text().splitlines()
    assert "--frames 0-2 " in calls[0]  # the runner makes later chunks larger, where they were quick
    assert 2 <= len(calls) <= 3
    assert all("--resume" in call and "--size=8x4 --spp=2" in call for call in calls)
    again = subprocess.run(
        [*command, f"-pScene={tmp_path / 'absent.glb'}"], timeout=PATIENCE, cwd=tmp_path, check=False
    )
    assert again.returncode != 0


def documents(name: str) -> list[dict[str, Any]]:
    yaml = module("yaml")
    return list(yaml.safe_load_all((FARM / "kubernetes" / name).read_text()))


@pytest.mark.parametrize("name", ["job.yaml", "deployment.yaml"])
def test_kubernetes_takes_the_manifests(name: str) -> None:
    validator = module("kubernetes_validate")
    for document in documents(name):
        validator.validate(document, validator.latest_version(), strict=True)
        broken = {**document, "spec": {**document["spec"], "completion": 3}}
        with pytest.raises(validator.ValidationError):
            validator.validate(broken, validator.latest_version(), strict=True)


def test_kubernetes_fails_bad_input_at_once_and_tries_the_rest_again() -> None:
    (job,) = documents("job.yaml")
    rules = job["spec"]["podFailurePolicy"]["rules"]
    (codes,) = [rule["onExitCodes"]["values"] for rule in rules if rule["action"] == "FailIndex"]
    assert codes == [2, 3, 5]
    assert job["spec"]["backoffLimitPerIndex"] > 0
    (container,) = job["spec"]["template"]["spec"]["containers"]
    assert {rule["onExitCodes"]["containerName"] for rule in rules if "onExitCodes" in rule} == {container["name"]}
    values = {each["name"]: each["value"] for each in container["env"]}
    wanted = int(values["LAST"]) - int(values["FIRST"]) + 1
    assert job["spec"]["completions"] * int(values["CHUNK"]) == wanted


def test_the_indices_cover_all_frames_once(sheaf: pathlib.Path, scene: pathlib.Path, tmp_path: pathlib.Path) -> None:
    (job,) = documents("job.yaml")
    (container,) = job["spec"]["template"]["spec"]["containers"]
    (script,) = container["args"]
    out = tmp_path / "out"
    for index in range(5):
        own = {
            "SCENE": scene,
            "OUT": out,
            "FIRST": 3,
            "LAST": 12,
            "CHUNK": 3,
            "OPTIONS": "",
            "JOB_COMPLETION_INDEX": index,
        }
        environment = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}", **{k: str(v) for k, v in own.items()}}
        subprocess.run([*container["command"], script], check=True, timeout=PATIENCE, env=environment)
    assert frames(out) == [f"box.{number:04d}.exr" for number in range(3, 13)]
    calls = (tmp_path / "calls").read_text()
    assert [f"--frames {span}" in calls for span in ("3-5", "6-8", "9-11", "12-12")] == [True] * 4
    assert len(calls.splitlines()) == 4  # the last index has nothing to do


@pytest.fixture
def slurm_tools(tmp_path: pathlib.Path) -> dict[str, str]:
    """The commands that the script calls in a job, which note what they are asked."""
    for name, body in (("srun", 'shift; exec "$@"'), ("scontrol", f'echo "$@" >> "{tmp_path}/requeued"')):
        (tmp_path / name).write_text(f"#!/bin/sh\n{body}\n")
        (tmp_path / name).chmod(0o755)
    return {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}", "SLURM_ARRAY_JOB_ID": "7"}


def run_slurm(environment: dict[str, str], task: int, scene: pathlib.Path, out: pathlib.Path, **more: str) -> int:
    own = {"SCENE": str(scene), "OUT": str(out), "LAST": "6", "CHUNK": "3", "SLURM_ARRAY_TASK_ID": str(task), **more}
    script = FARM / "slurm" / "sheaf.sbatch"
    return subprocess.run(["bash", script], timeout=PATIENCE, env={**environment, **own}, check=False).returncode


def test_slurm_tasks_cover_all_frames_and_tell_failures_apart(
    sheaf: pathlib.Path, scene: pathlib.Path, tmp_path: pathlib.Path, slurm_tools: dict[str, str]
) -> None:
    out, requeued = tmp_path / "out", tmp_path / "requeued"
    assert [run_slurm(slurm_tools, task, scene, out) for task in range(4)] == [0, 0, 0, 0]
    assert frames(out) == [f"box.{number:04d}.exr" for number in range(7)]
    faults = {**slurm_tools, "FAKE_SHEAF_FAULTS": str(tmp_path)}
    (tmp_path / "always-fail-1-4").touch()
    assert run_slurm(faults, 0, scene, tmp_path / "other") == 0  # queued again instead
    assert requeued.read_text() == "requeue 7_0\n"
    assert run_slurm(faults, 0, scene, tmp_path / "other", SLURM_RESTART_COUNT="3") == 4
    assert run_slurm(faults, 0, tmp_path / "absent.glb", out) == 3
    assert requeued.read_text() == "requeue 7_0\n"
    assert frames(tmp_path / "other") == ["box.0000.exr"]


def test_a_real_slurm_runs_the_array(sheaf: pathlib.Path, scene: pathlib.Path, tmp_path: pathlib.Path) -> None:
    if not slurm_node.is_possible():
        lacks("Slurm, or not root")
    out = tmp_path / "out"
    with slurm_node.node(tmp_path_of_slurm(tmp_path)) as environment:
        given = {"SCENE": scene, "OUT": out, "LAST": 6, "CHUNK": 3, "SHEAF": sheaf}
        exported = ",".join(["ALL", *(f"{name}={value}" for name, value in given.items())])
        command = ["sbatch", "--wait", "--array=0-2", f"--export={exported}", f"--output={tmp_path}/slurm-%a.log"]
        script = str(FARM / "slurm" / "sheaf.sbatch")
        done = subprocess.run([*command, script], env=environment, cwd=tmp_path, timeout=PATIENCE, check=False)
        logs = "".join(path.read_text() for path in sorted(tmp_path.glob("slurm-*.log")))
        assert done.returncode == 0, logs
        exported += f",SCENE={tmp_path}/absent.glb"
        bad = subprocess.run(
            [*command[:2], "--array=0", f"--export={exported}", script], env=environment, cwd=tmp_path, check=False
        )
        assert bad.returncode == 3
    assert frames(out) == [f"box.{number:04d}.exr" for number in range(7)]


def tmp_path_of_slurm(tmp_path: pathlib.Path) -> pathlib.Path:
    folder = tmp_path / "slurm"
    folder.mkdir()
    return folder
