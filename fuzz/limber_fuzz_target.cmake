# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# limber_add_fuzz_target(name SOURCES ... LIBRARIES ...): the program fuzz_<name>.
#
# With LIMBER_BUILD_FUZZERS the program is driven by libFuzzer. Otherwise it has a main() which runs the files and folders
# named as arguments, any compiler will do, and a test replays the committed inputs.
if(LIMBER_BUILD_FUZZERS AND NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  message(FATAL_ERROR "LIMBER_BUILD_FUZZERS needs Clang; use the preset fuzz")
endif()

function(limber_add_fuzz_target name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LIBRARIES")
  add_executable(fuzz_${name} ${arg_SOURCES})
  target_include_directories(fuzz_${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(fuzz_${name} PRIVATE limber_options limber::limber ${arg_LIBRARIES})
  if(LIMBER_BUILD_FUZZERS)
    target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
  else()
    target_sources(fuzz_${name} PRIVATE replay_main.cpp)
    target_link_libraries(fuzz_${name} PRIVATE limber_quick_options)
    set(inputs ${CMAKE_CURRENT_SOURCE_DIR}/corpus/${name})
    if(IS_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/regression/${name})
      list(APPEND inputs ${CMAKE_CURRENT_SOURCE_DIR}/regression/${name})
    endif()
    add_test(NAME fuzz.${name} COMMAND fuzz_${name} ${inputs})
    set_tests_properties(fuzz.${name} PROPERTIES LABELS fuzz)
  endif()
endfunction()
