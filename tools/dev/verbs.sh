#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# The verbs that have no script of their own: verbs.sh VERB [arguments].
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
  say "from nothing this takes about $(((10 + jobs) / jobs)) minutes on $jobs processors of today; after that, what has changed"
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

#: sanitize [args]  the tests under the address and undefined-behaviour sanitizers, then those with threads under the
#:                  thread sanitizer; arguments go to the first ctest
#: sanitize --quick  of the library, of files and of the program alone, with few random cases, and kernels for two
#:                  instruction sets; the first with the newest Clang, whose warnings count
verb_sanitize() {
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
}

# Queries from eight threads, updates with margins and workers beside them. Not builds: Debian's oneTBB is not
# instrumented, so its synchronisation cannot be seen. With one that is, every test of threads can run: build Debian's
# source package onetbb with CMAKE_CXX_FLAGS=-fsanitize=thread, and configure tsan with its TBB_DIR.
sanitize_threads() {
  configure tsan -DLIMBER_BUILD_PROGRAM=OFF
  build tsan --target limber_threads_tests
  run_programs tsan 'threads:*SharesModels*'
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
  python3 "$root/tools/mutants.py" "$@"
}

#: coverage         the lines of src and include that the tests run; fails below 95 %
verb_coverage() {
  # Of each executable of tests, what covers lines; long random sequences only repeat them. A program that may write no
  # files cannot note what it ran, either, and says so.
  coverage_runs=(unit 'property:-RandomQueries.*:UpdateSequences.Leave*' allocation io scenes
    'program:-ProgramOutputFiles.StayWhereNothingTakesTheirPlace' 'oracle:ExactScenes.*')

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

run_guide() {
  local line
  say "running the program of docs/guide/javascript.md"
  block docs/guide/javascript.md js '^# ' >guide.mjs
  node guide.mjs | tee guide.txt
  for line in 'frame 1: 1 apart, 0 contacts' 'frame 3: 0 apart, 12 contacts'; do
    grep -qx "$line" guide.txt || die "the program did not answer '$line'"
  done
}

#: web [args]       build the JavaScript package, in WebAssembly, and test it next to the native library; arguments go to
#:                  node --test
#: web build        build the package alone
#: web --quick      compile it quickly and run the program of its guide
verb_web() {
  if [[ ${1:-} == --quick ]]; then
    build_package web-quick
    run_guide
    return
  fi
  build_package web
  if [[ ${1:-} == build ]]; then return; fi
  need io
  configure release -DLIMBER_BUILD_TESTS=OFF -DLIMBER_BUILD_WEB=ON
  build release --target limber_web_answers
  "$root/build/release/clients/javascript/limber_web_answers" answers.json
  node_modules/.bin/tsc -p tests/tsconfig.json
  run_guide
  LIMBER_ANSWERS=answers.json node --test "$@" tests/*.test.js </dev/null
}

# npm, and what clients/pages/package-lock.json names. What is there already is not asked for again.
pages_environment() {
  local folder=$root/clients/pages
  command -v npm >/dev/null || need pages
  if cmp -s -- "$folder/package-lock.json" "$folder/node_modules/installed"; then return 0; fi
  say "installing from npm into clients/pages/node_modules"
  (cd -- "$folder" && npm ci --no-audit --no-fund --loglevel=error) </dev/null ||
    die "npm could not install what clients/pages/package-lock.json names"
  cp -- "$folder/package-lock.json" "$folder/node_modules/installed"
}

# run_script NAME: a script of clients/pages/package.json.
run_script() {
  pages_environment
  (cd -- "$root/clients/pages" && npm run --silent "$1" </dev/null)
}

#: pages            build the viewer, the page of `limber distance --report`, `limber track --report` and `limber demo`,
#:                  from clients/pages into build/pages, with npm
#: pages test       check the sources, and test that page with data that the program writes, in a headless browser
#: pages --commit   build it, and replace the committed page that the program is compiled with; for a release, or when
#:                  the format of the data has changed
#: pages pictures   make the pictures of these pages in the README and in docs/guide
verb_pages() {
  local script=${*:-build} preset=checked
  case $script in
    build | --commit) run_script "${script#--}" ;;
    test | pictures)
      need_for_tests pages_tests
      # Pages of pictures show times; those of tests come from the program that the tests have built.
      if [[ $script == pictures ]]; then
        preset=release
        need pictures
      fi
      configure "$preset"
      build "$preset" --target limber_program
      export LIMBER_PROGRAM=$root/build/$preset/clients/program/limber
      run_script "$script"
      ;;
    *) die "pages has no '$script'; see ./dev help" ;;
  esac
}

check_format() { cpp_files | xargs -0 clang-format --dry-run -Werror; }

check_scripts() {
  shellcheck dev .ci/run tools/dev/*.sh clients/program/completions/limber.bash tests/package/check_installed.sh
}

# Every file has a license. What git ignores is none of ours; without git that cannot be told.
check_licenses() {
  git rev-parse --git-dir >/dev/null 2>&1 || { say "licenses are checked in clones alone"; return 0; }
  build/lint_tools/bin/reuse lint --quiet || build/lint_tools/bin/reuse lint --lines
}

# clang-tidy over what the compile database of a preset knows of the folders below. Tests are left out: their frameworks
# would take most of the time. Most of the rest goes to headers, which sources that are joined, those of build/checked,
# read once. The analyzer looks only at functions of a source that is compiled by itself, as in build/dev.
check_tidy() {
  local preset=checked checks='-clang-analyzer-*,-bugprone-suspicious-include' patterns=() file
  if [[ -n $deep ]]; then preset=dev checks=''; fi
  while IFS= read -r -d '' file; do
    case $file in
      clients/program/tests/*) ;;
      src/* | scenes/* | clients/program/* | examples/* | python/src/*) patterns+=("/${file//./\\.}\$") ;;
    esac
  done < <(cpp_files)
  patterns+=('/build/checked/((src|scenes|examples|python)/.*|clients/program/CMakeFiles)/(limber|limber_.*|example_[0-9].*)\.dir/Unity/')
  configure "$preset" -DLIMBER_BUILD_PYTHON=ON "-DPython_EXECUTABLE=$root/build/python/bin/python" >/dev/null || return 1
  build "$preset" --target limber_python_docstrings >/dev/null || return 1
  run-clang-tidy -quiet -j "$jobs" -p "build/$preset" "-checks=$checks" "${patterns[@]}" 2>&1 |
    sed -E '/^clang-tidy|^[0-9]+ warnings? generated|^Suppressed|^Use -header-filter|^$/d'
}

# lint_step NAME COMMAND...
lint_step() {
  local step=$1 start=$SECONDS
  shift
  if "$@" </dev/null; then say "lint: $step ok ($((SECONDS - start)) s)"; else
    say "lint: $step FAILED ($((SECONDS - start)) s)"
    failed+=("$step")
  fi
}

#: lint             formatting, clang-tidy, layers, texts and references, licenses, shell scripts
#: lint --deep      with Clang's static analyzer, and every source by itself; long
verb_lint() {
  deep=''
  if [[ ${1:-} == --deep ]]; then deep=1; fi
  need_for_tests lint python
  tests_environment
  python_environment lint_tools ../tools/requirements_lint.txt
  cd -- "$root"
  failed=()
  export PYTHONDONTWRITEBYTECODE=1
  lint_step tools python3 tools/test_tools.py
  lint_step layers python3 tools/check_layers.py
  lint_step text python3 tools/check_text.py
  lint_step licenses check_licenses
  lint_step scripts check_scripts
  lint_step format check_format
  lint_step tidy check_tidy
  ((${#failed[@]} == 0)) || die "lint failed: ${failed[*]}"
  say "lint passed"
}

"verb_$1" "${@:2}"
