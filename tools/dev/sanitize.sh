#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: sanitize [args]  the tests under the address and undefined-behaviour sanitizers, then those with threads under the
#:                  thread sanitizer; arguments go to the first ctest
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

need_for_tests
# The stub of the Python package is written by Python, which cannot load a module with sanitizers by itself.
configure asan -DLIMBER_BUILD_PYTHON=OFF
build asan
export UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1}
# The longest tests draw fewer cases; installing and building a consumer have nothing to sanitize.
export LIMBER_UPDATE_SEQUENCES=20000 LIMBER_ORACLE_PAIRS=1000000
run_tests asan -LE package "$@"
configure tsan -DLIMBER_BUILD_PROGRAM=OFF
# Queries from eight threads, updates with margins and workers beside them. Not builds: Debian's oneTBB is not
# instrumented, so its synchronisation cannot be seen. With one that is, every test of threads can run: build Debian's
# source package onetbb with CMAKE_CXX_FLAGS=-fsanitize=thread, and configure tsan with its TBB_DIR.
build tsan --target limber_unit_tests
run_tests tsan -R SharesModels
