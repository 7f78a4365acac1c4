# SPDX-License-Identifier: MIT
sheaf_test(remap_workgroup_test sheaf_interface)
sheaf_test(mip_levels_test sheaf_device_data)
sheaf_test(plan_test sheaf_device_data)
sheaf_test(scene_parts_test sheaf_device_data)
