# SPDX-License-Identifier: MIT
add_subdirectory(${PROJECT_SOURCE_DIR}/tests/fuzz fuzz)
