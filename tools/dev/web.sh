#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: web [args]       build the JavaScript package, in WebAssembly, and test it next to the native library; arguments go to
#:                  node --test
#: web build        build the package alone
#: web --quick      compile it quickly and run its examples
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

run_examples() {
  local example
  for example in examples/*.js; do
    say "running $example"
    node "$example"
  done
}

if [[ ${1:-} == --quick ]]; then
  build_package web-quick
  run_examples
  exit
fi
build_package web
if [[ ${1:-} == build ]]; then exit; fi
configure release -DLIMBER_BUILD_TESTS=OFF -DLIMBER_BUILD_WEB=ON
build release --target limber_web_answers
"$root/build/release/clients/javascript/limber_web_answers" answers.json
node_modules/.bin/tsc -p tests/tsconfig.json
run_examples
LIMBER_ANSWERS=answers.json node --test "$@" tests/*.test.js </dev/null
