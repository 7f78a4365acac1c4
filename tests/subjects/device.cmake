# SPDX-License-Identifier: MIT
# Kernels against CPU references, on the device itself. Any message of the validation layer fails a test.
set(device_tests device_scan_test device_sort_test device_hash_test device_rays_hierarchy_test device_traverse_test
  device_frustum_test device_packets_test device_intersect_test device_watertight_test device_objects_test)
foreach(name IN LISTS device_tests)
  add_executable(${name} unit/${name}.cpp)
  target_link_libraries(${name} PRIVATE sheaf_options sheaf_core sheaf_stages GTest::gtest GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE SHEAF_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  add_dependencies(unit_tests ${name})
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST PROPERTIES ENVIRONMENT SHEAF_VALIDATION=1 LABELS device)
  # Parsed once for all of them: vulkan_raii.hpp alone takes longer than most of these files.
  if(name STREQUAL device_scan_test)
    target_precompile_headers(${name} PRIVATE <vulkan/vulkan_raii.hpp> <gtest/gtest.h> <glm/glm.hpp> <vector>)
  else()
    target_precompile_headers(${name} REUSE_FROM device_scan_test)
  endif()
endforeach()
sheaf_test(vector_width_test sheaf_vulkan)
