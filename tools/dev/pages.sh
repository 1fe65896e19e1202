#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: pages            build the pages of `limber distance --report`, `limber track --report` and `limber demo`, and the live
#:                  page, from web/pages, with npm
#: pages live       compile the engine to WebAssembly and build the pages, the live one with it; otherwise that keeps its own
#: pages --check    type-check their sources, and compare the committed pages with what the sources give
#: pages test       test pages that the program writes, in a headless browser
#: pages test --quick  of the program as ./dev test builds it
#: pages pictures   make the pictures of these pages in the README and in docs/guide
#: pages measure    what a frame of the live page costs in a headless browser
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

# npm, and what web/pages/package-lock.json names. What is there already is not asked for again.
pages_environment() {
  local folder=$root/web/pages
  command -v npm >/dev/null || need pages
  if cmp -s -- "$folder/package-lock.json" "$folder/node_modules/installed"; then return 0; fi
  say "installing from npm into web/pages/node_modules"
  (cd -- "$folder" && npm ci --no-audit --no-fund --loglevel=error) </dev/null ||
    die "npm could not install what web/pages/package-lock.json names"
  cp -- "$folder/package-lock.json" "$folder/node_modules/installed"
}

case ${1:-build} in
  build | --check)
    pages_environment
    script=${1:-build}
    (cd -- "$root/web/pages" && npm run --silent "${script#--}" </dev/null)
    ;;
  live)
    compile_web
    pages_environment
    (cd -- "$root/web/pages" && npm run --silent build -- --engine "$root/build/web/limber3d/limber.wasm" </dev/null)
    ;;
  test | pictures | measure)
    need build io program pages_tests
    if [[ $1 == pictures ]]; then need pictures; fi
    pages_environment
    preset=release options=(-DLIMBER_BUILD_TESTS=OFF)
    if [[ ${2:-} == --quick ]]; then preset=checked options=(); fi
    configure "$preset" "${options[@]}"
    build "$preset" --target limber_program
    (cd -- "$root/web/pages" && LIMBER_PROGRAM=$root/build/$preset/apps/limber/limber npm run --silent "$1" </dev/null)
    ;;
  *) die "pages has no '$1'; see ./dev help" ;;
esac
