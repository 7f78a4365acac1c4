# SPDX-License-Identifier: MIT
# What the benchmark (tests/bench) sets the engine against: Embree, on the rays of a dump. Without Embree there is none, and
# the benchmark leaves that column out.
find_package(embree 4 CONFIG QUIET)
if(NOT embree_FOUND)
  find_package(embree 3 CONFIG QUIET)
endif()
if(embree_FOUND)
  add_executable(sheaf_bench_embree bench/embree/main.cpp bench/embree/scene.cpp bench/embree/rays.cpp
    bench/embree/agreement.cpp oracle/dump.cpp oracle/truth.cpp)
  target_include_directories(sheaf_bench_embree PRIVATE oracle)
  target_link_libraries(sheaf_bench_embree PRIVATE sheaf_options embree glm::glm nlohmann_json::nlohmann_json Threads::Threads)
  target_compile_definitions(sheaf_bench_embree PRIVATE BENCH_EMBREE_MAJOR=${EMBREE_VERSION_MAJOR})
  add_dependencies(unit_tests sheaf_bench_embree)
else()
  message(STATUS "Embree not found: no sheaf_bench_embree")
endif()
