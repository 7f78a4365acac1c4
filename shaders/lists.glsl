// SPDX-License-Identifier: MIT
BUFFER(ROLE_COUNTERS, coherent, uint, counters);
