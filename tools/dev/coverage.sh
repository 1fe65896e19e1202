#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: coverage         the lines of src and include that the tests run; fails below 95 %
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

# Of each executable of tests, what covers lines; long random sequences only repeat them.
coverage_runs=(unit 'property:-RandomQueries.*:UpdateSequences.Leave*' allocation io scenes program 'oracle:ExactScenes.*')

# coverage_run EXECUTABLE[:FILTER]
coverage_run() {
  local name=${1%%:*} filter='*' log
  if [[ $1 == *:* ]]; then filter=${1#*:}; fi
  log=$root/build/coverage/$name.log
  if (cd -- "$root" && RC_PARAMS='max_success=200' "$root/build/coverage/tests/limber_${name}_tests" \
    --gtest_filter="$filter") >"$log" 2>&1 </dev/null; then
    say "coverage: $name ok"
  else
    say "coverage: $name FAILED; the log is $log"
    return 1
  fi
}

targets=() status=0
need_for_tests coverage
configure coverage
for run in "${coverage_runs[@]}"; do targets+=("limber_${run%%:*}_tests"); done
build coverage --target "${targets[@]}"
find "$root/build/coverage" -name '*.gcda' -delete
for run in "${coverage_runs[@]}"; do
  while (($(jobs -rp | wc -l) >= jobs)); do wait -n || status=1; done
  coverage_run "$run" &
done
while (($(jobs -rp | wc -l))); do wait -n || status=1; done
((status == 0)) || die "the tests failed"
# Kernels are compiled once per instruction set; a line counts where any of them runs it.
gcovr --root "$root" --object-directory "$root/build/coverage" --filter "$root/src/" --filter "$root/include/" \
  --exclude-throw-branches --fail-under-line 95 -j "$jobs" "$@"
