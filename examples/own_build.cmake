# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# What limber's own tests add: the examples as a project of its own, and the C++ example of the README.
if(LIMBER_INSTALL)
  add_test(NAME package.examples
    COMMAND ${CMAKE_CTEST_COMMAND}
      --build-and-test ${CMAKE_CURRENT_SOURCE_DIR} ${CMAKE_CURRENT_BINARY_DIR}/alone
      --build-generator ${CMAKE_GENERATOR} --build-options
        -DCMAKE_BUILD_TYPE= -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}
        -DCMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER} -DCMAKE_CXX_FLAGS=${CMAKE_CXX_FLAGS}
        -DCMAKE_PREFIX_PATH=${limber_BINARY_DIR}/tests/package/installed
      --test-command ${CMAKE_CTEST_COMMAND} --output-on-failure)
  set_tests_properties(package.examples PROPERTIES LABELS package TIMEOUT 600 FIXTURES_REQUIRED limber_installed)
endif()

# The README's program as it stands there.
set(readme_file ${limber_SOURCE_DIR}/README.md)
file(READ ${readme_file} readme)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${readme_file})
string(REGEX MATCH "```cpp\n(.*)\n```\n\nThat program" found "${readme}")
if(NOT found)
  message(FATAL_ERROR "README.md has no C++ example followed by 'That program'")
endif()
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/readme.cpp CONTENT "${CMAKE_MATCH_1}\n" @ONLY)
add_executable(example_readme ${CMAKE_CURRENT_BINARY_DIR}/readme.cpp)
target_link_libraries(example_readme PRIVATE limber::limber limber::io)
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/cloth.obj CONTENT "v 0 0 2\nv 1 0 2\nv 0 1 2\nf 1 2 3\n")
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/body.obj CONTENT "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
add_test(NAME example.readme COMMAND example_readme WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR})
set_tests_properties(example.readme PROPERTIES
  PASS_REGULAR_EXPRESSION "to 1.5 apart.*to 0.5 apart\n.*closer than 0.75\nframe 3: 0 to 0 apart\n.*touching\n$")
