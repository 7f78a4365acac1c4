# SPDX-License-Identifier: MIT
# The independent checker of dumps (tests/oracle). It links nothing of ours, only Embree; without Embree there is none, and
# its tests are skipped.
find_package(embree 4 CONFIG QUIET)
if(NOT embree_FOUND)
  find_package(embree 3 CONFIG QUIET)
endif()
if(embree_FOUND)
  add_executable(sheaf_oracle oracle/main.cpp oracle/dump.cpp oracle/truth.cpp oracle/embree_tracer.cpp oracle/checker.cpp)
  target_link_libraries(sheaf_oracle PRIVATE sheaf_options embree glm::glm nlohmann_json::nlohmann_json)
  target_compile_definitions(sheaf_oracle PRIVATE ORACLE_EMBREE_MAJOR=${EMBREE_VERSION_MAJOR})
  add_dependencies(unit_tests sheaf_oracle)
else()
  message(STATUS "Embree not found: no sheaf_oracle")
endif()
