# SPDX-License-Identifier: MIT
sheaf_test(sampling_test sheaf_sampling)
sheaf_test(mip_levels_test sheaf_core)
