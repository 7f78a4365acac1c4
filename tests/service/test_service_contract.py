# SPDX-License-Identifier: MIT
"""The contract against the live service: its routes, then all it describes, and more, as schemathesis asks for it."""

import json
import os
import pathlib
import re
import subprocess
import sys

import pytest

from service import Service, gltf

SCHEMATHESIS = pathlib.Path(sys.executable).with_name("schemathesis")
EXAMPLES = os.environ.get("SHEAF_CONTRACT_EXAMPLES", "10")  # of each operation; 200 for a long run


def test_the_contract_names_every_route_and_setting(sheafd: Service) -> None:
    contract = sheafd.http.get("/openapi.json").json()
    assert contract["openapi"].startswith("3.1")
    refs = set(re.findall(r'"#/components/([^"]+)"', json.dumps(contract)))
    for ref in refs:
        kind, name = ref.split("/")
        assert name in contract["components"][kind], ref
    for path, item in contract["paths"].items():
        real = path.replace("{id}", "a" * 26).replace("{frame}", "0")
        allowed = sheafd.http.options(real).headers["Allow"].split(", ")
        described = {m.upper() for m in item if m in ("get", "post", "delete", "put", "patch")}
        assert described == set(allowed) - {"HEAD", "OPTIONS"}, path


@pytest.mark.parametrize(
    "choice",
    [
        ("--exclude-operation-id", "submitJob"),
        # What is a scene no schema can say: a well-formed submission may still be refused.
        ("--include-operation-id", "submitJob", "--exclude-checks", "positive_data_acceptance"),
    ],
)
def test_the_contract_is_true(sheafd: Service, tmp_path: pathlib.Path, choice: tuple[str, ...]) -> None:
    sheafd.wait_until_ready()
    sheafd.wait(sheafd.accepted(gltf(), {"frames": 0}))
    options = ["--checks", "all", "--max-examples", EXAMPLES, "--phases", "examples,coverage,fuzzing", "--no-color"]
    ended = subprocess.run(
        [SCHEMATHESIS, "run", sheafd.url + "/openapi.json", *options, *choice],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=900,
        check=False,
    )
    assert ended.returncode == 0, ended.stdout[-8000:]
    assert not [entry for entry in sheafd.log if entry.get("level") == "error"]
