# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# The libraries that limber and its program are made with. What is installed is taken; what is not is fetched in the
# version named here, checked, and built along with limber. What only the tests need is never fetched.
option(LIMBER_FETCH "Fetch what is not installed: Highway, oneTBB, Boost.Multiprecision, nlohmann_json, CLI11, fmt" ON)
include(FetchContent)
# CMake's own module finds Boost's headers without its package file, too; newer versions want to be told to take it.
if(POLICY CMP0167)
  cmake_policy(SET CMP0167 OLD)
endif()

# limber_dependency(NAME TARGET FIND URL HASH WITHOUT): makes TARGET known. FIND are arguments of find_package(), WITHOUT
# says how limber does without it. What follows goes to FetchContent_Declare(). limber_fetched_NAME says where sources are.
function(limber_dependency name target find url hash without)
  find_package(${name} ${find} QUIET GLOBAL)
  if(TARGET ${target})
    return()
  endif()
  if(NOT LIMBER_FETCH)
    message(FATAL_ERROR "limber needs ${name}, which is not installed. Install it, or let it be fetched: LIMBER_FETCH=ON. ${without}")
  endif()
  string(TOUPPER ${name} upper)
  set(folder FETCHCONTENT_SOURCE_DIR_${upper})
  if(${folder})
    message(STATUS "limber: ${name} is not installed; taking that in ${${folder}}")
  else()
    message(STATUS "limber: ${name} is not installed; fetching ${url}, as -D${folder} names no folder")
  endif()
  # How it is built: without its tests.
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
  set(CMAKE_UNITY_BUILD OFF)
  # Versions from before CMake 4 name an older CMake than it takes.
  set(CMAKE_POLICY_VERSION_MINIMUM 3.5)
  foreach(option HWY_ENABLE_TESTS HWY_ENABLE_EXAMPLES HWY_ENABLE_CONTRIB TBB_TEST TBB_STRICT TBBMALLOC_BUILD JSON_BuildTests
      JSON_Install CLI11_BUILD_TESTS CLI11_BUILD_EXAMPLES CLI11_BUILD_DOCS CLI11_INSTALL FMT_INSTALL)
    set(${option} OFF CACHE INTERNAL "")
  endforeach()
  # CMake 3.25.1 takes SYSTEM for a second hash where it stands behind that.
  FetchContent_Declare(${name} SYSTEM URL ${url} URL_HASH SHA256=${hash} DOWNLOAD_EXTRACT_TIMESTAMP OFF ${ARGN})
  FetchContent_MakeAvailable(${name})
  string(TOLOWER ${name} lower)
  set(limber_fetched_${name} ${${lower}_SOURCE_DIR} PARENT_SCOPE)
endfunction()

# Headers alone: big integers behind the exact predicates. Two parts of Boost are enough for them.
set(boost https://github.com/boostorg)
limber_dependency(Boost Boost::headers "1.74" ${boost}/multiprecision/archive/refs/tags/boost-1.90.0.tar.gz
  b28a20f95712e596b3eb8aa4ae2264363016a609a63ebc3d84ee8cb49831de67 "" SOURCE_SUBDIR none)
if(limber_fetched_Boost)
  limber_dependency(BoostConfig Boost::headers "" ${boost}/config/archive/refs/tags/boost-1.90.0.tar.gz
    1390bd79fbf270e40cfe5ac6b899f4a9c4e47139b6e17b4c1f7f78822adaa9fc "" SOURCE_SUBDIR none)
  add_library(Boost::headers INTERFACE IMPORTED)
  target_include_directories(Boost::headers SYSTEM INTERFACE
    ${limber_fetched_Boost}/include ${limber_fetched_BoostConfig}/include)
  target_compile_definitions(Boost::headers INTERFACE BOOST_MP_STANDALONE)
endif()

# Debian keeps the same file. For WebAssembly, which has one instruction set, the headers are enough.
set(no_part)
if(EMSCRIPTEN)
  set(no_part SOURCE_SUBDIR none)
endif()
limber_dependency(HWY hwy::hwy CONFIG
  "http://deb.debian.org/debian/pool/main/h/highway/highway_1.2.0.orig.tar.gz;https://github.com/google/highway/archive/refs/tags/1.2.0.tar.gz"
  7e0be78b8318e8bdbf6fa545d2ecb4c90f947df03f7aadc42c1967f019e63343 "" ${no_part})
if(limber_fetched_HWY AND EMSCRIPTEN)
  add_library(hwy::hwy INTERFACE IMPORTED)
  target_include_directories(hwy::hwy SYSTEM INTERFACE ${limber_fetched_HWY})
elseif(limber_fetched_HWY)
  add_library(hwy::hwy ALIAS hwy)
endif()
if(LIMBER_THREADS OR LIMBER_BUILD_PROGRAM OR LIMBER_BUILD_TESTS OR LIMBER_BUILD_BENCHMARKS OR LIMBER_BUILD_PYTHON)
  limber_dependency(TBB TBB::tbb ""
    https://github.com/oneapi-src/oneTBB/archive/refs/tags/v2021.12.0.tar.gz
    c7bb7aa69c254d91b8f0041a71c5bcc3936acb64408a1719aec0b2b7639dd84f
    "LIMBER_THREADS=OFF goes without it, if the program is not built either.")
  # oneTBB asks for protections of the stack. GCC for Windows fails to compile one (its bug 90458), others are in libssp.
  if(limber_fetched_TBB AND MINGW AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(tbb PRIVATE -fno-stack-clash-protection)
    target_link_libraries(tbb INTERFACE ssp)
  endif()
endif()
if(LIMBER_NEEDS_IO)
  limber_dependency(nlohmann_json nlohmann_json::nlohmann_json ""
    https://github.com/nlohmann/json/archive/refs/tags/v3.11.3.tar.gz
    0d8ef5af7f9794e3263480193c491549b2ba6cc74bb018906202ada498a79406
    "It reads glTF files; LIMBER_BUILD_IO=OFF goes without mesh files.")
endif()
if(LIMBER_BUILD_PROGRAM OR LIMBER_BUILD_BENCHMARKS OR LIMBER_BUILD_FUZZERS OR LIMBER_BUILD_TESTS)
  limber_dependency(fmt fmt::fmt ""
    https://github.com/fmtlib/fmt/archive/refs/tags/11.0.2.tar.gz
    6cb1e6d37bdcb756dbbe59be438790db409cdb4868c66e888d5df9f13f7c027f "LIMBER_BUILD_PROGRAM=OFF goes without it.")
endif()
if(LIMBER_BUILD_PROGRAM OR LIMBER_BUILD_BENCHMARKS)
  limber_dependency(CLI11 CLI11::CLI11 ""
    https://github.com/CLIUtils/CLI11/archive/refs/tags/v2.4.1.tar.gz
    73b7ec52261ce8fe980a29df6b4ceb66243bb0b779451dbd3d014cfec9fdbb58 "LIMBER_BUILD_PROGRAM=OFF goes without it.")
endif()
