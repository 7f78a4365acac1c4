# SPDX-License-Identifier: MIT
"""`python -m sheaf` is `sheaf-client`."""

import sys

from .cli import main

sys.exit(main())
