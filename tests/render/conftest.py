# SPDX-License-Identifier: MIT
import pathlib
import sys

import pytest

HERE = pathlib.Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "scenes"), str(HERE.parent)]
sys.dont_write_bytecode = True

from default_signals import default_signals  # noqa: F401 - a fixture of every test
from rendering import Sheaf, program


@pytest.fixture(scope="session", autouse=True)
def built() -> None:
    """Without the program nothing here means anything."""
    program()


@pytest.fixture
def sheaf(tmp_path: pathlib.Path) -> Sheaf:
    return Sheaf(tmp_path)


@pytest.fixture(scope="module")
def sheaf_once(tmp_path_factory: pytest.TempPathFactory) -> Sheaf:
    """For pictures that several tests of a module look at."""
    return Sheaf(tmp_path_factory.mktemp("once"))
