#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: lint             formatting, clang-tidy, layers, texts and references, licenses, shell scripts
#: lint --deep      with Clang's static analyzer, and every source by itself; long
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

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
