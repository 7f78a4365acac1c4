# SPDX-License-Identifier: MIT
sheaf_test(settings_test sheaf_settings)
