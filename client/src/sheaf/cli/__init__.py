# SPDX-License-Identifier: MIT
"""The command `sheaf-client`."""

from ._main import main

__all__ = ["main"]
