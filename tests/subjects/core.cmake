# SPDX-License-Identifier: MIT
sheaf_test(quote_test sheaf_core)
