# SPDX-License-Identifier: MIT
sheaf_test(quote_test sheaf_core)
sheaf_test(sha256_test sheaf_core)
