# SPDX-License-Identifier: MIT
cmake_minimum_required(VERSION 3.25)
# Writes plain functions of a shader as C++ on top of GLM, so that tests on the CPU run the shader's own text.
#   cmake -DSHADER=in.glsl -DHEADER=out.inc [-DFROM=text] [-DUPTO=text] -P shader_as_cpp.cmake
file(READ ${SHADER} text)
foreach(cut FROM UPTO)
  if(DEFINED ${cut})
    string(FIND "${text}" "${${cut}}" at)
    if(at EQUAL -1)
      message(FATAL_ERROR "${SHADER}: nothing begins with '${${cut}}'; tests/subjects/bounds.cmake names what it takes")
    elseif("${cut}" STREQUAL "FROM")
      string(SUBSTRING "${text}" ${at} -1 text)
    else()
      string(SUBSTRING "${text}" 0 ${at} text)
    endif()
  endif()
endforeach()
string(REGEX REPLACE "#(version|extension|include|ifndef SHEAF_|define SHEAF_)[^\n]*" "" text "${text}")
string(REGEX REPLACE "#endif\n$" "" text "${text}")  # of the guard
string(REGEX REPLACE "precise " "" text "${text}")
string(REGEX REPLACE "([(, ])(inout|out) ([a-zA-Z0-9_]+) " "\\1\\3& " text "${text}")
string(REGEX REPLACE "([a-z]+)\\.yzx" "vec3(\\1.y, \\1.z, \\1.x)" text "${text}")
string(REGEX REPLACE "([a-z]+)\\.zxy" "vec3(\\1.z, \\1.x, \\1.y)" text "${text}")
file(WRITE ${HEADER} "${text}")
