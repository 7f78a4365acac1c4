# SPDX-License-Identifier: MIT
sheaf_test(strategy_trial_test sheaf_frame)
