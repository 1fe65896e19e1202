#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# Debian's packages, from the folder packaging/debian and with Debian's libraries. Only nanobind is from PyPI: its sources
# are a component of the source package.
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"
source "$root/tools/dev/roots.sh"

folder=$artefacts/deb
tree=$folder/limber-$version

# The source package: limber, nanobind beside it, and the folder debian.
make_sources() {
  local wheel
  rm -rf -- "$folder"
  copy_sources "$tree"
  pack "$folder/limber_$version.orig.tar.gz" "$tree"
  python3 -m pip download -q --no-deps -d "$folder/pypi" "$(grep '^nanobind==' "$root/python/requirements_build.txt")" </dev/null
  wheel=$(echo "$folder"/pypi/nanobind-*.whl)
  mkdir -- "$folder/nanobind"
  (cd -- "$folder/nanobind" && python3 -m zipfile -e "$wheel" . && cp -- nanobind-*.dist-info/licenses/LICENSE . &&
    rm -rf -- nanobind-*.dist-info)
  pack "$folder/limber_$version.orig-nanobind.tar.gz" "$folder/nanobind"
  mv -- "$folder/nanobind" "$tree/nanobind"
  cp -r -- "$root/packaging/debian" "$tree/debian"
  [[ $(dpkg-parsechangelog -l "$tree/debian/changelog" -S Version) == "$version"-* ]] ||
    die "packaging/debian/changelog is not of version $version"
}

build_debian() {
  say "building Debian's packages; the log is ${folder#"$root/"}/log"
  # Without packages of debug symbols: nobody but Debian has a place for them.
  (cd -- "$tree" && PATH=/usr/lib/ccache:/usr/sbin:/usr/bin:/sbin:/bin DEB_BUILD_OPTIONS="parallel=$jobs noautodbgsym" \
    dpkg-buildpackage -us -uc) </dev/null >"$folder/log" 2>&1 || die "$(tail -n 40 -- "$folder/log")"
  # Nobody has asked Debian for these packages, so there is no bug to close.
  lintian --fail-on error,warning --suppress-tags initial-upload-closes-no-bugs --info "$folder"/*.changes
}

try() {
  local name=deb-$1
  bare_root "$1" "$name"
  cp -- "$folder"/*.deb "$root/build/roots/$name/packages/"
  block README.md python '^## Python' >"$root/build/roots/$name/root/first.py"
  expect_answer "$name" "$(block docs/guide/install.md sh '^### Debian')" 'lower     2' '2 apart: (' '2.0 Witness'
  say "Debian's packages answer on Debian $1"
}

need build io program deb
make_sources
build_debian
if [[ ${1:-} != --build ]]; then try bookworm; fi
say "packages are in ${folder#"$root/"}: $(cd -- "$folder" && echo *.deb)"
