# SPDX-FileCopyrightText: 2026 the Alidade authors
# SPDX-License-Identifier: BSD-3-Clause

# Writes every core Vulkan function as a call into libvulkan.so.1, which is opened when the first one is called: so
# the program starts and draws on the processor where no Vulkan loader is installed.

find_file(VULKAN_CORE_HEADER vulkan/vulkan_core.h HINTS ${Vulkan_INCLUDE_DIRS} REQUIRED)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${VULKAN_CORE_HEADER}")
file(READ "${VULKAN_CORE_HEADER}" header)
# Brackets and semicolons mean something else in CMake's lists.
string(REPLACE "[" "<" header "${header}")
string(REPLACE "]" ">" header "${header}")
string(REPLACE ";" "@" header "${header}")
string(REGEX MATCHALL "VKAPI_ATTR [A-Za-z0-9_]+ VKAPI_CALL vk[A-Za-z0-9]*[a-z0-9]\\([^@]*\\)@" prototypes "${header}")
set(functions "")
foreach(prototype IN LISTS prototypes)
  string(REGEX REPLACE "^VKAPI_ATTR ([A-Za-z0-9_]+) VKAPI_CALL (vk[A-Za-z0-9]+)\\((.*)\\)@$" "\\1;\\2;\\3" parts
    "${prototype}")
  list(GET parts 0 result)
  list(GET parts 1 name)
  list(GET parts 2 parameters)
  set(arguments "")
  string(REPLACE "," ";" each "${parameters}")
  foreach(parameter IN LISTS each)
    string(REGEX MATCH "([A-Za-z0-9_]+)(<[0-9]+>)?[ \n]*$" unused "${parameter}")
    list(APPEND arguments "${CMAKE_MATCH_1}")
  endforeach()
  list(JOIN arguments ", " arguments)
  if(arguments STREQUAL "void")
    set(arguments "")
  endif()
  string(REPLACE "<" "[" parameters "${parameters}")
  string(REPLACE ">" "]" parameters "${parameters}")
  string(APPEND functions "ALIDADE_FORWARD(${result}, ${name}, (${parameters}), (${arguments}))\n")
endforeach()
file(CONFIGURE OUTPUT "${CMAKE_CURRENT_BINARY_DIR}/vulkan_functions.inc" CONTENT "${functions}" @ONLY)
