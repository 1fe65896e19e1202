#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# The verbs of a few lines each: verbs.sh VERB [arguments].
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

#: demo [args]      build the program and run `limber demo`; its page is build/limber-demo.html; arguments go to the demo
verb_demo() {
  need build io program
  configure release -DLIMBER_BUILD_TESTS=OFF
  build release --target limber_program
  "$root/build/release/clients/program/limber" demo --report "$root/build/limber-demo.html" "$@"
}

#: test [args]      build with checks and run every test; arguments go to ctest (e.g. -R distance)
verb_test() {
  expect_minutes 11
  configure_checked
  build checked
  run_tests checked "$@"
}

#: python [args]    build, type-check and test the Python package alone; arguments go to pytest
verb_python() {
  configure_checked
  build checked --target limber_python limber_python_stub limber_program
  run_tests checked -R '^python\.' -E '^python\.pytest$'
  (cd -- "$root" && PYTHONPATH=build/checked/python PYTHONDONTWRITEBYTECODE=1 \
    LIMBER_PROGRAM=$root/build/checked/clients/program/limber build/python/bin/python -m pytest "$@") </dev/null
}

#: docs             the site in build/docs/site: pages, the interfaces of C++ and Python; fails where a link leads nowhere
verb_docs() {
  configure_checked
  need docs
  build checked --target limber_python_stub
  python_environment docs_tools ../docs/site/requirements.txt
  PYTHONPATH=$root/build/checked/python PYTHONDONTWRITEBYTECODE=1 "$root/build/docs_tools/bin/python" \
    "$root/tools/build_docs.py" "$root/build/docs" </dev/null
}

#: test_release [args]  the unit and allocation tests in the build that users install, without checks
verb_test_release() {
  need_for_tests
  configure release -DLIMBER_BUILD_TESTS=ON
  build release --target limber_unit_tests limber_allocation_tests
  (cd -- "$root" && ctest --test-dir build/release --output-on-failure --parallel "$jobs" \
    -R '^(unit|allocation)\.' "$@") </dev/null
}

#: test_clang [args]  build all that is installed with Debian's Clang and with its newest, and run the tests of units and
#:                  of the program with the newest; arguments go to ctest
verb_test_clang() {
  need_for_tests clang
  newest=$(newest_clang)
  need "$newest"
  configure clang
  configure clang-22 "-DCMAKE_CXX_COMPILER=${newest/clang/clang++}"
  build clang --target limber limber_io limber_program limber_compile_tests
  build clang-22 --target limber_program limber_compile_tests limber_unit_tests limber_program_tests
  run_tests clang-22 -R '^(unit|program)\.' "$@"
}

#: verify           the oracles at length: 20 million pairs of triangles, 40 000 scenes of all scales and 1 000
#:                  deformation sequences against exact arithmetic; a million queries that are interrupted and go on;
#:                  200 000 queries in scenes of motion planners; 5 million moving pairs and 20 000 moving scenes;
#:                  60 000 pairs of closed surfaces against cells and axes, 380 against CGAL, 100 000 penetrations
verb_verify() {
  need_for_tests
  configure release -DLIMBER_BUILD_TESTS=ON
  build release --target limber_oracle_tests limber_property_tests limber_unit_tests
  export LIMBER_ORACLE_PAIRS=20000000 LIMBER_EXACT_PAIRS=1000000 LIMBER_EXACT_SCENES=40000 LIMBER_EXACT_SEQUENCES=1000
  export LIMBER_INTERRUPTED_QUERIES=1000000 LIMBER_NEIGHBOR_PAIRS=300000 LIMBER_PLANNING_QUERIES=200000
  export LIMBER_IMPACT_PAIRS=5000000 LIMBER_IMPACT_SCENES=10000
  export LIMBER_SOLID_PAIRS=20000 LIMBER_ORACLE_SOLIDS=380 LIMBER_PENETRATION_PAIRS=100000 LIMBER_NORMAL_PAIRS=200000
  oracles='^oracle\..*(Cgal|Exact|Impact|Solid)'
  properties='^property\.(Impact|Interrupted|Scenes/PlanningQueries|Solid|Penetration|ContactNormals)'
  (cd -- "$root" && ctest --test-dir build/release --output-on-failure --parallel "$jobs" --verbose \
    -R "$oracles|$properties|^unit\.EveryKind/NeighborsOfKind" "$@") </dev/null
}

#: format           apply clang-format to every source
verb_format() {
  need format
  cd -- "$root"
  cpp_files | xargs -0 clang-format -i
}

#: sanitize_python  the tests of the Python package under the address and undefined-behaviour sanitizers
#
# Python is built without them, so their library has to be loaded first; its own memory is left out of the search for
# leaks. Tests of batches on many processes, of programs and next to other packages run no other code of the module.
verb_sanitize_python() {
  need_for_tests python
  tests_environment
  preload=''
  for name in libasan libstdc++; do preload+=" $(g++ -print-file-name=$name.so)"; done
  configure asan -DLIMBER_BUILD_PYTHON=ON "-DPython_EXECUTABLE=$root/build/python/bin/python"
  build asan --target limber_python limber_program
  (cd -- "$root" && LD_PRELOAD=${preload# } ASAN_OPTIONS=detect_leaks=0 PYTHONMALLOC=malloc PYTHONDONTWRITEBYTECODE=1 \
    UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1} PYTHONPATH=build/asan/python \
    LIMBER_PROGRAM=$root/build/asan/clients/program/limber \
    build/python/bin/python -m pytest --capture=sys --ignore-glob='*/test_'{batch,documents,examples}'.py') </dev/null
}

#: mutants [name...]  break the code in many places, one at a time: the tests must notice each; a name may be a pattern
#: mutants --random N [file...] [--seed S]  break N places drawn at random, in all sources or in those that fit a pattern;
#:                  list those that no test notices, which a person has to judge; long
verb_mutants() {
  need_for_tests mutants
  python3 "$root/tools/mutants.py" --jobs "$jobs" "$@"
}

#: coverage         the lines of src and include that the tests run; fails below 95 %
verb_coverage() {
  # Of each executable of tests, what covers lines; long random sequences only repeat them.
  coverage_runs=(unit 'property:-RandomQueries.*:UpdateSequences.Leave*' allocation io scenes program 'oracle:ExactScenes.*')

  targets=()
  need_for_tests coverage
  configure coverage
  for run in "${coverage_runs[@]}"; do targets+=("limber_${run%%:*}_tests"); done
  build coverage --target "${targets[@]}"
  find "$root/build/coverage" -name '*.gcda' -delete
  RC_PARAMS=max_success=200 run_programs coverage "${coverage_runs[@]}" || die "the tests failed"
  # Kernels are compiled once per instruction set; a line counts where any of them runs it.
  gcovr --root "$root" --object-directory "$root/build/coverage" --filter "$root/src/" --filter "$root/include/" \
    --exclude-throw-branches --fail-under-line 95 -j "$jobs" "$@"
}

"verb_$1" "${@:2}"
