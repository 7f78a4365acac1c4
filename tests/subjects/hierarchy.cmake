# SPDX-License-Identifier: MIT
sheaf_test(object_hierarchy_test sheaf_hierarchy)
sheaf_test(object_hierarchy_cost_test sheaf_hierarchy)
sheaf_test(hierarchy_fold_test sheaf_hierarchy)
sheaf_test(slot_order_test sheaf_hierarchy)
