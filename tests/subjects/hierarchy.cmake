# SPDX-License-Identifier: MIT
sheaf_test(object_hierarchy_test sheaf_hierarchy)
