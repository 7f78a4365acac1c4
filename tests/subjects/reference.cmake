# SPDX-License-Identifier: MIT
sheaf_test(reference_test sheaf_reference)
sheaf_test(reference_glass_test sheaf_reference)
sheaf_test(reference_tracer_test sheaf_reference sheaf_hierarchy)
