#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: package NAME     build what others install, below build/packages, and install it on bare Debian systems with a first
#:                  query: wheels [VERSION...], deb, npm; recipes checks those of packaging; reproducible builds twice and compares
#: release [KEY]    build and try every package, and put them with their SHA-256 sums in build/publish; signs the sums with
#:                  that key of gpg; runs the README's commands from the archive of sources on a bare Debian; long

# package.sh NAME [--build]: --build leaves out what installs and tries. wheels has a script of its own.
source "$(dirname -- "${BASH_SOURCE[0]}")/roots.sh"

# The source package: limber, nanobind beside it, and the folder debian; in the caller's $folder and $tree.
make_debian_sources() {
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

# Debian's packages, from the folder packaging/debian and with Debian's libraries. Only nanobind is from PyPI: its sources
# are a component of the source package.
package_deb() {
  local folder=$artefacts/deb tree=$artefacts/deb/limber-$version
  need build io program deb
  make_debian_sources
  say "building Debian's packages; the log is ${folder#"$root/"}/log"
  # Without packages of debug symbols: nobody but Debian has a place for them.
  (cd -- "$tree" && PATH=/usr/lib/ccache:/usr/sbin:/usr/bin:/sbin:/bin DEB_BUILD_OPTIONS="parallel=$jobs noautodbgsym" \
    dpkg-buildpackage -us -uc) </dev/null >"$folder/log" 2>&1 || die "$(tail -n 40 -- "$folder/log")"
  # Nobody has asked Debian for these packages, so there is no bug to close.
  lintian --fail-on error,warning --suppress-tags initial-upload-closes-no-bugs --info "$folder"/*.changes
  if [[ ${1:-} != --build ]]; then
    bare_root bookworm deb
    cp -- "$folder"/*.deb "$root/build/roots/deb/packages/"
    block README.md python '^## Python' >"$root/build/roots/deb/root/first.py"
    expect_answer deb "$(block docs/guide/install.md sh '^### Debian')" 'lower     2' '2 apart: (' '2.0 Witness'
  fi
}

# The JavaScript package as npm packs it.
package_npm() {
  local folder=$artefacts/npm file listed
  rm -rf -- "$folder"
  build_package web
  mkdir -p -- "$folder"
  listed=$(npm pack --dry-run ./limber3d 2>&1 </dev/null)
  for file in limber.wasm index.js index.d.ts package.json README.md LICENSE NOTICES.txt; do
    [[ $listed == *" $file"* ]] || die "npm would not pack $file: $listed"
  done
  npm pack --silent --pack-destination "$folder" ./limber3d </dev/null >/dev/null
  if [[ ${1:-} != --build ]]; then
    bare_root bookworm npm nodejs npm
    cp -- "$folder"/*.tgz "$root/build/roots/npm/packages/"
    block docs/guide/javascript.md js '^# ' >"$root/build/roots/npm/root/first.mjs"
    expect_answer npm "$(block docs/guide/install.md sh '^### npm')" 'frame 0: 2 apart'
  fi
}

# The recipes of packaging: Conan's makes a package of these sources and the libraries of the system, and tries it; the
# others are only read by what reads their language.
package_recipes() {
  local recipes=$root/packaging tools=$root/build/recipe_tools/bin
  check_versions
  need build io recipes
  python_environment recipe_tools requirements_recipes.txt
  "$tools/python" -c 'import json, sys, rattler_build as rattler
rattler.Stage0Recipe.from_file(sys.argv[1]).render(rattler.VariantConfig({"c_stdlib": ["sysroot"]}))
json.load(open(sys.argv[2]))' "$recipes/conda/recipe.yaml" "$recipes/vcpkg/vcpkg.json"
  ruby -c "$recipes/homebrew/limber.rb" >/dev/null
  nix-instantiate --parse "$recipes/nix/default.nix" >/dev/null
  say "recipes of conda, vcpkg, Homebrew and Nix can be read"
  if [[ ${1:-} != --build ]]; then
    export CONAN_HOME=$root/build/conan
    "$tools/conan" profile detect --exist-ok
    "$tools/conan" create "$recipes/conan" --no-remote --build=missing -o 'limber/*:system=True' -s compiler.cppstd=20 \
      -c tools.cmake.cmaketoolchain:generator=Ninja \
      -c "tools.cmake.cmake_layout:test_folder=$root/build/conan_test" </dev/null
    say "Conan makes the package, and a program with it answers"
  fi
}

sums() { (cd -- "$1/build/packages" && find . -maxdepth 2 -name '*.deb' -o -maxdepth 2 -name '*.whl' -o \
  -maxdepth 2 -name '*.tar.gz' -o -maxdepth 2 -name '*.tgz' | sort | xargs sha256sum); }

# Builds Debian's packages (library and program), wheels and the JavaScript package from two copies of the sources in
# folders of different names, without ccache, and compares the bits. Long: everything is compiled twice.
package_reproducible() {
  local names=("$@") copy name copies
  if (($# == 0)); then names=(deb wheels npm); fi
  copies=("$root/build/same/one" "$root/build/same/another/copy")
  rm -rf -- "$root/build/same"
  export CCACHE_DISABLE=1
  for copy in "${copies[@]}"; do
    copy_sources "$copy"
    for name in "${names[@]}"; do "$copy/dev" package "$name" --build; done
    sums "$copy" >"$root/build/same/$(basename -- "$copy").sums"
  done
  diff "$root/build/same/one.sums" "$root/build/same/copy.sums" || die "two builds differ, see above"
  cat -- "$root/build/same/one.sums"
  say "two builds gave the same $(wc -l <"$root/build/same/one.sums") files, to the bit"
}

# The README's way to install, its Python package and its first programs, from the archive.
try_readme() {
  bare_root bookworm release g++ make cmake ninja-build python3-venv python3-dev libhwy-dev libtbb-dev libboost-dev \
    nlohmann-json3-dev libcli11-dev libfmt-dev
  local place=$root/build/roots/release/root
  tar -xf "$folder/$name.tar.gz" -C "$place"
  block README.md '' '^## Install' >"$place/install.sh"
  block README.md python '^## Python' >"$place/first.py"
  block README.md cpp '^## C' >"$place/$name/main.cpp"
  expect_answer release "cd $name && . ../install.sh && ~/limber/bin/limber distance scene:square scene:ball --pose-b 0,0,3,1,0,0,0" \
    'lower     2'
  expect_answer release "python3 -m venv env && . env/bin/activate && cd $name && pip install . && python ../first.py" "2.0 Witness"
  block docs/guide/install.md cmake 'A project of yours' >"$place/CMakeLists.txt"
  mv -- "$place/$name/main.cpp" "$place/main.cpp"
  printf 'v %s\n' '0 0 0' '1 0 0' '0 1 0' '0 0 1' | tee -- "$place/cloth.obj" >"$place/body.obj"
  printf 'f %s\n' '1 3 2' '1 2 4' '2 3 4' '3 1 4' | tee -a -- "$place/cloth.obj" >>"$place/body.obj"
  expect_answer release "cmake -S . -B app -DCMAKE_PREFIX_PATH=/root/limber && cmake --build app && app/app" 'frame 3'
}

# It publishes nothing.
package_release() {
  local folder=$root/build/publish name=limber-$version package
  export CCACHE_DISABLE=1  # ccache may shorten names of files that are compiled in; then nobody else gets the same bits
  check_versions
  [[ -z $(git -C "$root" status --porcelain) ]] || die "a release is of what is committed"
  "$root/dev" pages
  cmp -s -- "$root"/build/pages/viewer.html "$root"/clients/program/pages/viewer.html ||
    die "a release has the page that clients/pages gives: run ./dev pages --commit"
  rm -rf -- "$folder"
  mkdir -p -- "$folder"
  copy_sources "$folder/$name"
  pack "$folder/$name.tar.gz" "$folder/$name"
  rm -rf -- "${folder:?}/$name"
  try_readme
  for package in wheels deb npm recipes; do "$root/dev" package "$package"; done
  cp -- "$artefacts"/wheels/{*.whl,*.tar.gz} "$artefacts"/npm/*.tgz "$artefacts"/deb/*.deb "$folder"
  (cd -- "$folder" && sha256sum -- *.* >SHA256SUMS)
  if (($#)); then gpg --batch --yes --local-user "$1" --armor --detach-sign -- "$folder/SHA256SUMS"; fi
  say "what to publish is in build/publish:"
  cat -- "$folder/SHA256SUMS"
}

case ${1:-} in
  wheels) exec "$root/tools/dev/package_wheels.sh" "${@:2}" ;;
  deb | npm | recipes | reproducible | release) "package_$1" "${@:2}" ;;
  *) die "usage: ./dev package NAME [--build]; names: wheels, deb, npm, recipes, reproducible" ;;
esac
say "package $1 is done"
