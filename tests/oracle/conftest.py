# SPDX-License-Identifier: MIT
import pathlib
import sys

import pytest

HERE = pathlib.Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "scenes")]
sys.dont_write_bytecode = True

from oracle import oracle_program, sheaf_program


@pytest.fixture(scope="session", autouse=True)
def built() -> None:
    if oracle_program() is None:
        pytest.skip("sheaf_oracle is not built: no Embree")
    assert sheaf_program().is_file(), "sheaf is not built (SHEAF_BUILD names the folder)"
