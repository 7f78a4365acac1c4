# SPDX-License-Identifier: MIT
# Writes what of table.def makes fields, without the texts beside it. An edit of a help text then leaves this file as it is,
# and rebuilds nothing of what includes render_settings.hpp.
#   cmake -DTABLE=table.def -DOUTPUT=settings_fields.def -P fields.cmake
cmake_minimum_required(VERSION 3.25)
file(STRINGS ${TABLE} lines REGEX "^(PICTURE|RUN)\\(")
set(fields "// Made by the build from table.def: macro(type, member, default).\n")
foreach(line IN LISTS lines)
  if(NOT line MATCHES "^([A-Z]+\\(.+),$")
    message(FATAL_ERROR "${TABLE}: the first line of an entry must hold type, member and default alone: ${line}")
  endif()
  string(APPEND fields "${CMAKE_MATCH_1})\n")
endforeach()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "${fields}" @ONLY)  # written only if it differs
