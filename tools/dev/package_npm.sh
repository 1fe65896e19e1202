#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# The JavaScript package as npm packs it.
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"
source "$root/tools/dev/roots.sh"

folder=$artefacts/npm

make_archive() {
  local file listed
  rm -rf -- "$folder"
  build_package web
  mkdir -p -- "$folder"
  listed=$(npm pack --dry-run ./limber3d 2>&1 </dev/null)
  for file in limber.wasm index.js index.d.ts package.json README.md LICENSE NOTICES.txt; do
    [[ $listed == *" $file"* ]] || die "npm would not pack $file: $listed"
  done
  npm pack --silent --pack-destination "$folder" ./limber3d </dev/null >/dev/null
}

try() {
  local name=npm-$1
  bare_root "$1" "$name" nodejs npm
  cp -- "$folder"/*.tgz "$root/build/roots/$name/packages/"
  block docs/guide/javascript.md js '^# ' >"$root/build/roots/$name/root/first.mjs"
  expect_answer "$name" "$(block docs/guide/install.md sh '^### npm')" 'frame 0: 2 apart'
  say "the JavaScript package answers on Debian $1"
}

make_archive
if [[ ${1:-} != --build ]]; then try bookworm; fi
say "the package is in ${folder#"$root/"}: $(cd -- "$folder" && echo *.tgz)"
