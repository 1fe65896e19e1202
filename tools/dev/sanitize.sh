#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: sanitize [args]  the tests under the address and undefined-behaviour sanitizers, then those with threads under the
#:                  thread sanitizer; arguments go to the first ctest
#: sanitize --quick  of the library, of files and of the program alone, with few random cases, and kernels for two
#:                  instruction sets; the first with the newest Clang, whose warnings count
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

# Queries from eight threads, updates with margins and workers beside them. Not builds: Debian's oneTBB is not
# instrumented, so its synchronisation cannot be seen. With one that is, every test of threads can run: build Debian's
# source package onetbb with CMAKE_CXX_FLAGS=-fsanitize=thread, and configure tsan with its TBB_DIR.
sanitize_threads() {
  configure tsan -DLIMBER_BUILD_PROGRAM=OFF
  build tsan --target limber_threads_tests
  run_programs tsan 'threads:*SharesModels*'
}

need_for_tests
export UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1}
# The stub of the Python package is written by Python, which cannot load a module with sanitizers by itself.
options=(-DLIMBER_BUILD_PYTHON=OFF)
if [[ ${1:-} == --quick ]]; then
  suites=(unit property program io allocation)
  # Tests where brute force or a long loop takes most of the time, and other tests run the same code. All run by hand.
  declare -A left_out=(
    [unit]='Query/reference.*:Queries.FindTheClosestOfManyNearlyClosestPairs:RealTime.NoMove*'
    [property]='Fans.*:Displacements.*:SolidRelationProperty.*:LatticeProperty.OfTwoModels:ImpactProperty.OfOneModel*'
    [program]='ProgramDemo.WritesAPage*:ProgramDemo.ThePageOfTheUsualRun*:ProgramDemo.*Frames*'
  )
  left_out[unit]+=':FloatEnvironment.OfTheCallerChangesNoAnswer:Model.KeepsUpWithTriangles*'
  left_out[property]+=':RandomQueries.*:*PlanningQueries.*:SelfContactsProperty.AreThoseOfBruteForceOnARealMesh'
  # Not in the full run: Debian's CGAL does not compile with it.
  newest=$(newest_clang)
  need "$newest"
  configure asan-22 "${options[@]}" -DLIMBER_FEWER_KERNELS=ON "-DCMAKE_CXX_COMPILER=${newest/clang/clang++}"
  targets=("${suites[@]/#/limber_}")
  build asan-22 --target "${targets[@]/%/_tests}" limber_compile_tests
  export RC_PARAMS=max_success=50 LIMBER_UPDATE_SEQUENCES=1000 LIMBER_INTERRUPTED_QUERIES=2000
  export LIMBER_NEIGHBOR_PAIRS=3000 LIMBER_NORMAL_PAIRS=1000
  runs=()
  for suite in "${suites[@]}"; do runs+=("$suite:-${left_out[$suite]:-}"); done
  run_programs asan-22 "${runs[@]}"
else
  configure asan "${options[@]}"
  build asan
  # The longest tests draw fewer cases; installing and building a consumer have nothing to sanitize.
  LIMBER_UPDATE_SEQUENCES=20000 LIMBER_ORACLE_PAIRS=1000000 run_tests asan -LE package "$@"
fi
sanitize_threads
