#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: pages            build the viewer, the page of `limber distance --report`, `limber track --report` and `limber demo`,
#:                  from clients/pages into build/pages, with npm
#: pages test       check the sources, and test that page with data that the program writes, in a headless browser
#: pages --commit   build it, and replace the committed page that the program is compiled with; for a release, or when
#:                  the format of the data has changed
#: pages pictures   make the pictures of these pages in the README and in docs/guide
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

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

script=${*:-build}
case $script in
  build | --commit) run_script "${script#--}" ;;
  test | pictures)
    need_for_tests pages_tests
    # Pages of pictures show times; those of tests come from the program that the tests have built.
    preset=checked
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
