#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: test_clang [args]  build all that is installed with Debian's Clang and with its newest, and run the tests of units and
#:                  of the program with the newest; arguments go to ctest
#: test_clang --quick  kernels for two instruction sets, and no optimisation with Debian's
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

newest=clang-22 options=() unoptimised=()
if [[ ${1:-} == --quick ]]; then
  shift
  options=(-DLIMBER_FEWER_KERNELS=ON) unoptimised=('-DCMAKE_CXX_FLAGS_RELEASE=-O0 -DNDEBUG')
fi
need_for_tests clang
# The security archive has it; the main one ends with 19.
apt-cache show "$newest" >/dev/null 2>&1 || newest=clang-19
need "$newest"
configure clang "${options[@]}" "${unoptimised[@]}"
configure clang-22 "-DCMAKE_CXX_COMPILER=${newest/clang/clang++}" "${options[@]}"
build clang --target limber limber_io limber_program limber_compile_tests
build clang-22 --target limber_program limber_compile_tests limber_unit_tests limber_program_tests
run_tests clang-22 -R '^(unit|program)\.' "$@"
