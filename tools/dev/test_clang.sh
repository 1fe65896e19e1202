#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: test_clang [args]  build all that is installed with Debian's Clang and with its newest, and run the tests of units and
#:                  of the program with the newest; arguments go to ctest
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

need_for_tests clang
newest=$(newest_clang)
need "$newest"
configure clang
configure clang-22 "-DCMAKE_CXX_COMPILER=${newest/clang/clang++}"
build clang --target limber limber_io limber_program limber_compile_tests
build clang-22 --target limber_program limber_compile_tests limber_unit_tests limber_program_tests
run_tests clang-22 -R '^(unit|program)\.' "$@"
