#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: coverage         the lines of src and include that the tests run; fails below 95 %
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

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
