# SPDX-License-Identifier: MIT
sheaf_test(dealing_test sheaf_core)
sheaf_test(plan_test sheaf_core)
sheaf_test(scene_parts_test sheaf_core)
sheaf_test(strategy_trial_test sheaf_core)
