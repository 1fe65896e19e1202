# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# Writes the manual page of the program from its own --help and that of every verb:
#   cmake -DPROGRAM=path -DVERSION=x.y.z -DOUTPUT=limber.1 -P limber_man_page.cmake
cmake_minimum_required(VERSION 3.25)

# What stands for characters that would end or join the entries of a list, until the page is written.
string(ASCII 1 semicolon)
string(ASCII 2 opening)
string(ASCII 3 closing)

# help_of(LINES [VERB]): the lines of that help, as text that the formatter of manual pages takes literally.
function(help_of lines)
  execute_process(COMMAND ${PROGRAM} ${ARGN} --help OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
  string(REPLACE ";" "${semicolon}" text "${text}")
  string(REPLACE "[" "${opening}" text "${text}")
  string(REPLACE "]" "${closing}" text "${text}")
  string(REPLACE "\\" "\\(rs" text "${text}")
  string(REPLACE "-" "\\-" text "${text}")
  string(REPLACE "\n" ";" text "${text}")
  set(${lines} "${text}" PARENT_SCOPE)
endfunction()

# add_help(LINES): a title, then entries indented by two columns with their meaning behind or below, then paragraphs.
function(add_help lines)
  foreach(line IN LISTS lines)
    if(line MATCHES "^ *$")
      string(APPEND page ".PP\n")
    elseif(line MATCHES "^  ([^ ]+( [^ ]+)*)(  +(.*))?$")
      string(APPEND page ".TP\n\\fB${CMAKE_MATCH_1}\\fR\n")
      if(NOT "${CMAKE_MATCH_4}" STREQUAL "")
        string(APPEND page "\\&${CMAKE_MATCH_4}\n")
      endif()
    elseif(line MATCHES "^Usage: (.*)$")
      string(APPEND page ".PP\n\\fB${CMAKE_MATCH_1}\\fR\n")
    elseif(line MATCHES "^([A-Z][A-Za-z ]*):$")
      string(APPEND page "\\fI${CMAKE_MATCH_1}\\fR\n")
    else()
      string(STRIP "${line}" line)
      string(APPEND page "\\&${line}\n")
    endif()
  endforeach()
  set(page "${page}" PARENT_SCOPE)
endfunction()

help_of(overview)
list(POP_FRONT overview title)
string(REGEX REPLACE "[.]$" "" title "${title}")
set(page ".TH LIMBER 1 \"\" \"limber ${VERSION}\" \"User Commands\"\n.SH NAME\nlimber \\- ${title}\n.SH DESCRIPTION\n")
add_help("${overview}")

# A verb is a lower-case word at the start of an entry.
list(FILTER overview INCLUDE REGEX "^  [a-z]")
foreach(line IN LISTS overview)
  string(REGEX MATCH "[a-z\\-]+" verb "${line}")
  string(REPLACE "\\" "" verb "${verb}")
  help_of(lines ${verb})
  string(APPEND page ".SH LIMBER ${verb}\n")
  add_help("${lines}")
endforeach()
if(NOT verb)
  message(FATAL_ERROR "'${PROGRAM} --help' lists no verb")
endif()

string(REPLACE "${semicolon}" ";" page "${page}")
string(REPLACE "${opening}" "[" page "${page}")
string(REPLACE "${closing}" "]" page "${page}")
string(REGEX REPLACE "(\n.PP)+\n(.TP|.SH|.PP)" "\n\\2" page "${page}")
file(WRITE ${OUTPUT} "${page}")
