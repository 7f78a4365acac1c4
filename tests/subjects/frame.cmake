# SPDX-License-Identifier: MIT
sheaf_test(remap_workgroup_test sheaf_core)
sheaf_test(plan_test sheaf_core)
sheaf_test(scene_parts_test sheaf_core)
sheaf_test(strategy_trial_test sheaf_core)
