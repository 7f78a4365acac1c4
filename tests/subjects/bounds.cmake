# SPDX-License-Identifier: MIT
# Paddings, offsets and whole numbers of the shaders, run on the CPU in single precision, against long double. The shaders' own text is
# compiled: constants are floats there, and nothing is contracted.
set(bounds_folder ${CMAKE_CURRENT_BINARY_DIR}/bounds)
function(shader_as_cpp name shader)
  set(output ${bounds_folder}/${name}.inc)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DSHADER=${PROJECT_SOURCE_DIR}/shaders/${shader} -DHEADER=${output} ${ARGN}
      -P ${CMAKE_CURRENT_SOURCE_DIR}/shader_as_cpp.cmake
    DEPENDS ${PROJECT_SOURCE_DIR}/shaders/${shader} ${CMAKE_CURRENT_SOURCE_DIR}/shader_as_cpp.cmake VERBATIM)
  set(bounds_sources ${bounds_sources} ${output} PARENT_SCOPE)
endfunction()
shader_as_cpp(ray_node trace/common/ray_node.glsl)
shader_as_cpp(convert lib/convert.glsl)
shader_as_cpp(bundle_bound trace/bundles/bundle_bound.glsl)
shader_as_cpp(triangle scene/triangle.glsl)
shader_as_cpp(offset shade/surface.glsl "-DFROM=float next_up")
shader_as_cpp(spheres objects/objects_spheres.comp "-DFROM=vec4 triangle_sphere" "-DUPTO=void main")

add_library(sheaf_bounds_shaders OBJECT unit/bounds_shaders.cpp ${bounds_sources})
target_include_directories(sheaf_bounds_shaders PRIVATE ${bounds_folder})
target_link_libraries(sheaf_bounds_shaders PUBLIC glm::glm)
foreach(subject ray_bounds triangle_bounds convert)
  sheaf_test(${subject}_test sheaf_bounds_shaders)
endforeach()
set_source_files_properties(unit/bounds_shaders.cpp PROPERTIES
  COMPILE_OPTIONS "-fsingle-precision-constant;-ffp-contract=off;-Wno-unused-function" SKIP_LINTING ON)
