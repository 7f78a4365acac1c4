# SPDX-License-Identifier: MIT
"""Renders animations on a Dask cluster: LocalCluster, dask-jobqueue on Slurm, dask-kubernetes, or any other.

Wants the extra: `pip install 'sheaf[farm]'`, here and where the workers run.
"""

from ._ledger import FarmOptions
from ._render import render
from ._result import FarmResult

__all__ = ["FarmOptions", "FarmResult", "render"]
