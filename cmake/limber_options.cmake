# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# What every target of this project is compiled with.
add_library(limber_options INTERFACE)
target_compile_features(limber_options INTERFACE cxx_std_20)
if(MSVC AND NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  message(FATAL_ERROR "limber: cl cannot compile it; take clang-cl (cmake -T ClangCL) or MinGW.")
endif()
# Exactness claims need the operations as written: no contraction into fused multiply-adds. docs/guide/install.md says
# how each compiler is told. Nobody reads errno after a square root; setting it would cost a branch each.
if(MSVC)
  # What clang-cl has no option for is handed to Clang; it turns on contraction unless told otherwise.
  target_compile_options(limber_options INTERFACE
    /clang:-ffp-contract=off /clang:-fno-math-errno /EHsc /utf-8 /W4 -Wno-sign-conversion
    $<$<BOOL:${LIMBER_WARNINGS_AS_ERRORS}>:/WX>)
  target_compile_definitions(limber_options INTERFACE NOMINMAX _CRT_SECURE_NO_WARNINGS)
else()
  target_compile_options(limber_options INTERFACE
    -ffp-contract=off -fno-math-errno -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wnon-virtual-dtor
    $<$<BOOL:${LIMBER_WARNINGS_AS_ERRORS}>:-Werror>)
  # Clang's -Wconversion for C++ includes changes of sign; GCC's does not.
  target_compile_options(limber_options INTERFACE -Wno-sign-conversion)
endif()
# GCC does not align the stack of Windows as vectors of 32 bytes need it (its bug 54412). The assembler replaces the
# moves that would fault.
if(MINGW AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  target_compile_options(limber_options INTERFACE -Wa,-muse-unaligned-vector-move)
endif()
if(WIN32 AND BUILD_SHARED_LIBS)
  message(FATAL_ERROR "limber: for Windows there are static libraries alone. Leave BUILD_SHARED_LIBS off.")
endif()
# What the sanitizers add between a write and a read hides the write from GCC: it warns inside std::regex.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_FLAGS MATCHES "-fsanitize")
  target_compile_options(limber_options INTERFACE -Wno-maybe-uninitialized)
endif()
target_compile_definitions(limber_options INTERFACE $<$<BOOL:${LIMBER_CHECKS}>:LIMBER_CHECKS>)
# Libraries are position-independent, so that a static one can become part of somebody's shared one. The option lets the
# compiler inline across functions all the same, as it does in programs, where names can be replaced: in ELF. WebAssembly
# has no shared libraries here.
if(NOT EMSCRIPTEN)
  if(UNIX AND NOT APPLE)
    target_compile_options(limber_options INTERFACE -fno-semantic-interposition)
  endif()
  set(LIMBER_LIBRARY_PROPERTIES POSITION_INDEPENDENT_CODE ON)
endif()
list(APPEND LIMBER_LIBRARY_PROPERTIES
  VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
  CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
# A shared library shows what LIMBER_API marks. The linker hides what headers of others leave in it: their marks say
# otherwise.
if(BUILD_SHARED_LIBS AND UNIX AND NOT APPLE)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/limber.map.in ${PROJECT_BINARY_DIR}/limber.map @ONLY)
  list(APPEND LIMBER_LIBRARY_PROPERTIES
    LINK_OPTIONS -Wl,--version-script=${PROJECT_BINARY_DIR}/limber.map
    LINK_DEPENDS ${PROJECT_BINARY_DIR}/limber.map)
endif()

# For sources whose own speed does not matter: tests, and the program around the library.
add_library(limber_quick_options INTERFACE)
if(NOT MSVC)
  target_compile_options(limber_quick_options INTERFACE $<$<NOT:$<CONFIG:Debug>>:-Og>)
endif()

# limber_precompile(TARGET HEADER...): parses headers once for all sources of the target. With the option, what ccache
# sees of a source names the precompiled header.
function(limber_precompile target)
  target_precompile_headers(${target} PRIVATE ${ARGN})
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endfunction()

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
