# SPDX-License-Identifier: MIT
sheaf_test(plan_test sheaf_core)
