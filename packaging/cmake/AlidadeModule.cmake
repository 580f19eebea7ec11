# SPDX-FileCopyrightText: 2026 the Alidade authors
# SPDX-License-Identifier: BSD-3-Clause

# alidade_module(<name> [PUBLIC libs…] [PRIVATE libs…])
#
# One static library `alidade_<name>` of every .cpp in the current folder. Headers are included
# from `src/` as "module/header.h". PUBLIC names the modules and libraries that its headers show.
function(alidade_module name)
  cmake_parse_arguments(ARG "" "" "PUBLIC;PRIVATE" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/*.cpp" "${CMAKE_CURRENT_SOURCE_DIR}/*.h")
  if(NOT sources MATCHES "\\.cpp")
    add_library(alidade_${name} INTERFACE)
    target_include_directories(alidade_${name} INTERFACE "${CMAKE_SOURCE_DIR}/src")
    target_link_libraries(alidade_${name} INTERFACE ${ARG_PUBLIC} ${ARG_PRIVATE})
    return()
  endif()
  add_library(alidade_${name} STATIC ${sources})
  target_include_directories(alidade_${name} PUBLIC "${CMAKE_SOURCE_DIR}/src")
  target_link_libraries(alidade_${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
endfunction()

# alidade_plugin(<name> LINKS libs…)
#
# A reader plugin: a Qt plugin library of every .cpp in the current folder, loaded at run time by
# io/ from `lib/alidade/plugins`. Also built as the static library `alidade_<name>_reader`, which
# its tests and fuzz target link.
function(alidade_plugin name)
  cmake_parse_arguments(ARG "" "" "LINKS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/*.cpp" "${CMAKE_CURRENT_SOURCE_DIR}/*.h")
  list(FILTER sources EXCLUDE REGEX "/(plugin|child)\\.cpp$")
  add_library(alidade_${name}_reader STATIC ${sources})
  target_include_directories(alidade_${name}_reader PUBLIC "${CMAKE_CURRENT_SOURCE_DIR}/..")
  target_link_libraries(alidade_${name}_reader PUBLIC alidade_plugin_api PRIVATE ${ARG_LINKS})

  add_library(alidade_${name}_plugin MODULE plugin.cpp)
  set_target_properties(alidade_${name}_plugin PROPERTIES
    AUTOMOC ON PREFIX "" OUTPUT_NAME "${name}" LIBRARY_OUTPUT_DIRECTORY "${ALIDADE_PLUGIN_DIR}")
  target_link_libraries(alidade_${name}_plugin PRIVATE alidade_${name}_reader Qt6::Core)
  set_property(GLOBAL APPEND PROPERTY ALIDADE_PLUGINS alidade_${name}_plugin)
endfunction()

# alidade_test(<name> SOURCES files… LINKS libs… [LABELS labels…] [DISPLAY] [MAIN])
#
# One test binary a module. GoogleTest cases are discovered by ctest one by one after the build.
# DISPLAY says that the binary needs an X display; MAIN that it brings its own main().
function(alidade_test name)
  cmake_parse_arguments(ARG "DISPLAY;MAIN" "" "SOURCES;LINKS;LABELS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/tests")
  if("${ARG_LINKS}" MATCHES "Qt6::Test")
    set_target_properties(${name} PROPERTIES AUTOMOC ON)
  endif()
  target_include_directories(${name} PRIVATE "${CMAKE_SOURCE_DIR}/tests")
  target_link_libraries(${name} PRIVATE ${ARG_LINKS} GTest::gmock)
  if(NOT ARG_MAIN)
    target_link_libraries(${name} PRIVATE GTest::gtest_main)
  endif()
  if(ALIDADE_SANITIZE)
    target_sources(${name} PRIVATE "${CMAKE_SOURCE_DIR}/tests/keep_loaded.cpp")
  endif()
  target_compile_definitions(${name} PRIVATE
    ALIDADE_SOURCE_DIR="${CMAKE_SOURCE_DIR}"
    ALIDADE_BINARY_DIR="${CMAKE_BINARY_DIR}"
    ALIDADE_TEST_DATA_DIR="${CMAKE_SOURCE_DIR}/tests/data"
    ALIDADE_SHARED_DATA_DIR="${CMAKE_SOURCE_DIR}/../shared/data")
  set(labels ${ARG_LABELS})
  if(ARG_DISPLAY)
    list(APPEND labels display)
  endif()
  add_test(NAME ${name} COMMAND ${name})
  set_tests_properties(${name} PROPERTIES LABELS "${labels}" TIMEOUT 900)
endfunction()
