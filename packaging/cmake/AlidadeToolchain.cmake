# SPDX-FileCopyrightText: 2026 the Alidade authors
# SPDX-License-Identifier: BSD-3-Clause
# Language level, warnings, sanitizers, compiler cache and where programs land.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_INTERPROCEDURAL_OPTIMIZATION OFF)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/lib")
set(ALIDADE_PLUGIN_DIR "${CMAKE_BINARY_DIR}/lib/alidade/plugins")

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Paths relative to the checkout: a second clone finds what the first one compiled.
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CMAKE_COMMAND}" -E env "CCACHE_BASEDIR=${CMAKE_SOURCE_DIR}" CCACHE_NOHASHDIR=1
    "${CCACHE_PROGRAM}")
endif()

add_compile_options(-Wall -Wextra -Wshadow=local -Wnon-virtual-dtor -Woverloaded-virtual)
# GCC 12 warns about moved-from optionals and vectors it cannot follow once optimised.
add_compile_options(-Wno-maybe-uninitialized)
# AVX-512 types in templates: the vector ABI is not exported from any library here.
add_compile_options(-Wno-psabi)
if(ALIDADE_WARNINGS_AS_ERRORS)
  add_compile_options(-Werror)
endif()
if(ALIDADE_SANITIZE)
  # "undefined" leaves out the numbers that fit no integer, which damaged files are full of.
  set(sanitizers -fsanitize=address,undefined,float-cast-overflow)
  add_compile_options(${sanitizers} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(${sanitizers})
  # Indices into vectors and spans are checked, too; this changes no layout.
  add_compile_definitions(_GLIBCXX_ASSERTIONS)
endif()
