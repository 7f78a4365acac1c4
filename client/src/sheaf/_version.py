# SPDX-License-Identifier: MIT
"""The package's version, here so that no module needs the package itself to know it."""

__version__ = "0.1.0"
