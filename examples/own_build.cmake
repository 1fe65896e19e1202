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

# The first C++ program of a page runs as it stands there, on two small meshes.
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/cloth.obj CONTENT "v 0 0 2\nv 1 0 2\nv 0 1 2\nf 1 2 3\n")
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/body.obj CONTENT "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")

# For the page on motion, a cloth of four squares above a floor with a pyramid.
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/falling/cloth.obj CONTENT "v 2 2 5\nv 6 2 5\nv 11 2 5\nv 2 6 5\nv 6 7 5
v 11 6 5\nv 2 11 5\nv 6 11 5\nv 11 11 5\nf 1 2 5 4\nf 2 3 6 5\nf 4 5 8 7\nf 5 6 9 8\n")
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/falling/body.obj CONTENT "v -9 -9 0\nv 21 -9 0\nv 21 21 0\nv -9 21 0
v 2 2 0\nv 10 2 0\nv 10 10 0\nv 2 10 0\nv 6 6 2\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
f 5 6 9\nf 6 7 9\nf 7 8 9\nf 8 5 9\n")

# add_page(PAGE NAME OUTPUT [FOLDER folder] [BELOW heading]): the first program of a page, or below a heading, and a
# regular expression that its output matches; with the meshes of another folder.
function(add_page page name output)
  cmake_parse_arguments(PARSE_ARGV 3 arg "" "FOLDER;BELOW" "")
  set(file ${limber_SOURCE_DIR}/${page})
  file(READ ${file} text)
  if(arg_BELOW)
    string(FIND "${text}" "\n## ${arg_BELOW}\n" begin)
    if(begin EQUAL -1)
      message(FATAL_ERROR "${page} has no heading ${arg_BELOW}")
    endif()
    string(SUBSTRING "${text}" ${begin} -1 text)
  endif()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  set(fence "```cpp\n")
  string(FIND "${text}" "${fence}" begin)
  string(LENGTH "${fence}" fence_length)
  if(begin EQUAL -1)
    message(FATAL_ERROR "${page} has no C++ program")
  endif()
  math(EXPR begin "${begin} + ${fence_length}")
  string(SUBSTRING "${text}" ${begin} -1 text)
  string(FIND "${text}" "```" end)
  string(SUBSTRING "${text}" 0 ${end} program)
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp CONTENT "${program}" @ONLY)
  add_executable(example_${name} ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  target_link_libraries(example_${name} PRIVATE limber::limber limber::io)
  add_test(NAME example.${name} COMMAND example_${name} WORKING_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/${arg_FOLDER})
  set_tests_properties(example.${name} PROPERTIES PASS_REGULAR_EXPRESSION "${output}")
endfunction()

add_page(README.md readme "to 1.5 apart.*to 0.5 apart\n.*closer than 0.75\nframe 3: 0 to 0 apart\n.*touching\n$")
add_page(docs/guide/contacts.md contacts_page "^frame 2: .*gap 0.5\nframe 3: triangles 0 and 0, gap 0\n$")
add_page(docs/guide/motion.md motion_page "^(0\\.01[0-9]+ apart\n)+$" FOLDER falling)
add_page(docs/guide/deadlines.md deadlines_page "tick 0: .* apart.*tick 3: .* to 0.4 apart")
add_page(docs/guide/scenes.md scenes_page "frame 3: 0 and 1, 0.4 apart\n$")
add_page(docs/guide/solids.md solids_page "^pipe at -3: clear\npipe at -2: touches\npipe at -1: clash\n$")
add_page(docs/guide/shapes.md shapes_page "1.375 over.*\nhand at 1: 0.375 .*, in the crate\nhand at 0.6: 0 .*, in the crate\n$")
add_page(docs/guide/mesh_files.md mesh_files_page "^1 triangles of 1 faces\n$")
add_page(docs/guide/from_other_libraries_cpp.md other_libraries_page "^meet: 0\n2 apart, triangles 0 and 0\n0.5 apart\n$")
add_page(docs/guide/from_other_libraries_cpp.md physics_page "at rest at height 0.51\nat rest at height 1.52\nat rest at height 2.53\n$"
  BELOW "Physics engines")
