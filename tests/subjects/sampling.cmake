# SPDX-License-Identifier: MIT
sheaf_test(sampling_test sheaf_sampling)
