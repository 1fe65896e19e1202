#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: release [KEY]    build and try every package, and put them with their SHA-256 sums in build/publish; signs the sums with
#:                  that key of gpg; runs the README's commands from the archive of sources on a bare Debian; long

# It publishes nothing.
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"
source "$root/tools/dev/roots.sh"

folder=$root/build/publish
export CCACHE_DISABLE=1  # ccache may shorten names of files that are compiled in; then nobody else gets the same bits
name=limber-$version

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
