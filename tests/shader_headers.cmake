# SPDX-License-Identifier: MIT
cmake_minimum_required(VERSION 3.25)
# Every header of the shaders is self-contained: a kernel that includes it alone, twice, compiles.
#   cmake -DGLSLANG=glslangValidator -DSHADERS=shaders -DSCRATCH=folder -P shader_headers.cmake
file(GLOB_RECURSE headers RELATIVE ${SHADERS} ${SHADERS}/*.glsl ${SHADERS}/*.h)
list(REMOVE_ITEM headers interface/shared.h)  # for C++
file(MAKE_DIRECTORY ${SCRATCH})
set(broken "")
foreach(header IN LISTS headers)
  set(includes "#include \"${header}\"\n#include \"${header}\"\n")
  file(WRITE ${SCRATCH}/alone.comp "#version 460\n#extension GL_GOOGLE_include_directive : require\n#define COMPUTE\n"
    "${includes}void main() {}\n")
  # Which elements a scan has is defined by the table of variants.
  set(defines "")
  if(header MATCHES "scan_elements")
    set(defines -DSCAN_COMPACT)
  elseif(header MATCHES "cell_elements")
    set(defines -DSCAN_CELLS -DSCAN_OPEN)
  endif()
  execute_process(COMMAND ${GLSLANG} -V --quiet --target-env vulkan1.2 -I${SHADERS} ${defines} -o ${SCRATCH}/alone.spv
    ${SCRATCH}/alone.comp RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    string(APPEND broken "${header}:\n${output}\n")
  endif()
endforeach()
if(broken)
  message(FATAL_ERROR "shader headers that do not compile alone:\n${broken}")
endif()
