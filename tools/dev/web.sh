#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: web [args]       build the JavaScript package, in WebAssembly, and test it next to the native library; arguments go to
#:                  node --test
#: web build        build the package alone
#: web --quick      compile it quickly and run the program of its guide
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

run_guide() {
  local line
  say "running the program of docs/guide/javascript.md"
  block docs/guide/javascript.md js '^# ' >guide.mjs
  node guide.mjs | tee guide.txt
  for line in 'frame 1: 1 apart, 0 contacts' 'frame 3: 0 apart, 12 contacts'; do
    grep -qx "$line" guide.txt || die "the program did not answer '$line'"
  done
}

if [[ ${1:-} == --quick ]]; then
  build_package web-quick
  run_guide
  exit
fi
build_package web
if [[ ${1:-} == build ]]; then exit; fi
need io
configure release -DLIMBER_BUILD_TESTS=OFF -DLIMBER_BUILD_WEB=ON
build release --target limber_web_answers
"$root/build/release/clients/javascript/limber_web_answers" answers.json
node_modules/.bin/tsc -p tests/tsconfig.json
run_guide
LIMBER_ANSWERS=answers.json node --test "$@" tests/*.test.js </dev/null
