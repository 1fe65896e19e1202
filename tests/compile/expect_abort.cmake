# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# PROGRAM aborts when it makes the MISTAKE, and says these WORDS. Run by cmake -D... -P.
cmake_minimum_required(VERSION 3.25)
execute_process(COMMAND ${PROGRAM} ${MISTAKE} RESULT_VARIABLE result ERROR_VARIABLE text)
string(FIND "${text}" "${WORDS}" place)
if(NOT result MATCHES "abort" OR place EQUAL -1)
  message(FATAL_ERROR "with the mistake '${MISTAKE}' the program ended with '${result}' and said: ${text}")
endif()
