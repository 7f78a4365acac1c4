# SPDX-License-Identifier: MIT
import json
import pathlib
import sys

import pytest

HERE = pathlib.Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "render"), str(HERE.parent / "scenes")]
sys.dont_write_bytecode = True

from rendering import Sheaf, program


@pytest.fixture(scope="session", autouse=True)
def built() -> None:
    program()


@pytest.fixture
def sheaf(tmp_path: pathlib.Path) -> Sheaf:
    return Sheaf(tmp_path)


@pytest.fixture(scope="session")
def device_strategies(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Those that this device has."""
    run = Sheaf(tmp_path_factory.mktemp("devices"))("devices", "--json")
    has_ray_query = json.loads(run.stdout)[0]["ray_query"]
    return ["bvh", "hybrid", "crsh", "rsh", "frustum", "classify", "brute"] + (["rayquery"] if has_ray_query else [])
