#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# Wheels that run wherever glibc is 2.28 or newer, with all libraries inside, and the archive of sources. Zig's Clang
# compiles for that glibc and links its C++ library statically. One wheel is for CPython 3.12 and all later ones, and
# comes with one for 64-bit ARM; the others are for one version each. Versions may be named; all are made if none is.
source "$(dirname -- "${BASH_SOURCE[0]}")/roots.sh"

folder=$artefacts/wheels
tools=$root/build/wheel_tools/bin
sources=$root/build/sources

# interpreter VERSION: the folder of that CPython: Debian's or pyenv's.
interpreter() {
  local found
  for found in "${PYENV_ROOT:-$HOME/.pyenv}/versions/$1."*/bin/python3 "$(command -v "python$1" || true)"; do
    if [[ -x $found ]] && "$found" -c "import sys; sys.exit('%d.%d' % sys.version_info[:2] != '$1')"; then
      dirname -- "$found"
      return
    fi
  done
  die "no CPython $1, neither Debian's nor pyenv's"
}

prepare() {
  need build io python arm
  python_environment wheel_tools requirements_wheel.txt
  debian_sources highway onetbb nlohmann-json3
  mkdir -p -- "$sources/boost/include"
  ln -sfn -- /usr/include/boost "$sources/boost/include/boost"
  local target
  for target in x86_64-linux-gnu.2.28 aarch64-linux-gnu.2.28; do
    printf '#!/bin/sh\nexec "%s/zig" c++ -target %s "$@"\n' \
      "$("$tools/python" -c 'import ziglang; print(ziglang.__path__[0])')" "$target" >"$tools/c++-${target%.2.28}"
    chmod +x -- "$tools/c++-${target%.2.28}"
  done
}

# wheel VERSION TARGET [PLATFORM]: PLATFORM is a tag for auditwheel, which takes only tags of the machine that it runs on;
# without one it finds the tag itself. A module that does not run here takes its stub from the one that does, which is
# built before.
wheel() {
  local settings=("wheel.py-api=cp312" "build-dir=build/wheel-$1-$2") name processor=${2%%-*} log=$folder/log-$1-$2
  if [[ $2 != x86_64-linux-gnu ]]; then
    for name in SYSTEM_NAME=Linux SYSTEM_PROCESSOR="$processor"; do settings+=("cmake.define.CMAKE_$name"); done
    settings+=("cmake.define.LIMBER_PYTHON_STUB=$root/build/wheel-$1-x86_64-linux-gnu/python/limber3d/_core.pyi")
  fi
  for name in HWY TBB Boost nlohmann_json; do settings+=("cmake.define.CMAKE_DISABLE_FIND_PACKAGE_$name=ON"); done
  for name in HWY=highway TBB=onetbb NLOHMANN_JSON=nlohmann-json3 BOOST=boost BOOSTCONFIG=boost; do
    settings+=("cmake.define.FETCHCONTENT_SOURCE_DIR_${name%=*}=$sources/${name#*=}")
  done
  # The system's library unwinds stacks, not Zig's own: pthread_exit(), by which CPython before 3.14 ends
  # daemon threads, gives the module the system's record of a stack, and the two libraries do not read each other's.
  settings+=("cmake.define.CMAKE_MODULE_LINKER_FLAGS=$("$2-gcc" -print-file-name=libgcc_s.so.1)")
  PATH=$(interpreter "$1"):$PATH python_environment "wheel_python-$1" requirements_build.txt
  say "building the wheel of CPython $1 for $2; its log is ${log#"$root/"}"
  # Boost 1.74 derives from a class that this C++ library has no longer; nanobind counts on a header that it does not bring.
  # -O3 also for what CMake tries, so that Zig builds its C++ library once.
  PATH=$tools:$PATH _PYTHON_HOST_PLATFORM=linux-$processor CXX=$tools/c++-$2 CCACHE_COMPILERTYPE=clang \
    CMAKE_CXX_COMPILER_LAUNCHER=$(command -v ccache || true) CMAKE_BUILD_PARALLEL_LEVEL=$jobs \
    CXXFLAGS="-O3 $same_paths -DBOOST_NO_CXX98_FUNCTION_BASE -include stdio.h" \
    "$root/build/wheel_python-$1/bin/python" -m pip wheel -v --no-build-isolation --no-deps \
    "${settings[@]/#/--config-settings=}" \
    -w "$folder/plain-$1-$2" "$root" </dev/null >"$log" 2>&1 || die "$(tail -n 40 -- "$log")"
  PATH=$tools:$PATH auditwheel repair --plat "${3:-auto}" --only-plat -w "$folder" "$folder/plain-$1-$2"/*.whl </dev/null
}

# What PyPI and its users ask of them: tags that are true, the licenses of what is inside, and no symbol beside the module.
check() {
  local file found license
  "$tools/twine" check --strict "$folder"/*.whl "$folder"/*.tar.gz
  for file in "$folder"/*-abi3-*.whl; do
    [[ ! -e $file ]] || "$tools/abi3audit" --strict "$file"
  done
  for file in "$folder"/*.whl; do
    [[ $("$tools/auditwheel" show "$file") =~ \"manylinux_2_(17|2[0-8])_ ]] ||
      die "auditwheel does not find $file to be what its name says"
    found=$(python3 -m zipfile -l "$file")
    [[ $found != *.libs/* ]] || die "$file has libraries beside the module"
    for license in LICENSE {Apache-2.0,libhwy-dev,libtbb-dev,nanobind,nlohmann-json3-dev,robin_map}.txt; do
      [[ $found == *"licenses/$license "* ]] || die "$file has not licenses/$license"
    done
  done
}

# The package's own tests, where the wheel alone is installed, in a folder that has nothing of the sources but the tests.
run_tests_of() {
  local place=$root/build/wheel_test/bin/python
  rm -rf -- "$root/build/wheel_test"
  "$(interpreter "$1")/python3" -m venv "$root/build/wheel_test"
  "$place" -m pip install -q --find-links "$folder" limber3d \
    -r "$root/python/requirements_test.txt" -r "$root/python/requirements_peers.txt" </dev/null
  mkdir -p -- "$folder/tests"
  cp -- "$root"/python/tests/*.py "$folder/tests"
  (cd -- "$folder" && PYTHONDONTWRITEBYTECODE=1 "$place" -m pytest -q -p no:cacheprovider tests) </dev/null
}

# try SUITE VERSION: installs and asks on a bare system whose own CPython that is, or that has a copy of pyenv's.
try() {
  local name=wheel-$2 place python=python3
  bare_root "$1" "$name" python3-venv
  if [[ $(in_root "$name" 'python3 -c "import sys; print(\"%d.%d\" % sys.version_info[:2])"') != "$2" ]]; then
    place=$(dirname -- "$(interpreter "$2")")
    in_root "$name" 'apt-get -qq install -y libssl3 libffi8 libsqlite3-0 libreadline8 libbz2-1.0 liblzma5 zlib1g >/dev/null'
    mkdir -p -- "$root/build/roots/$name${place%/*}"
    cp -a -- "$place" "$root/build/roots/$name$place"
    python=$place/bin/python3
    ln -s -- "$python" "$root/build/roots/$name/usr/local/bin/python3"
  fi
  cp -- "$folder"/*manylinux*x86_64.whl "$root/build/roots/$name/packages/"
  block README.md python '^## Python' >"$root/build/roots/$name/root/first.py"
  expect_answer "$name" "$(block docs/guide/install.md sh '^### Wheel')" "2.0 Witness"
  say "the wheel answers on Debian $1 with CPython $2"
}

# The wheel for 64-bit ARM asks on the CPython that Debian has for it, by an emulator.
try_arm() {
  local place=$root/build/roots/arm file found
  need roots
  say "making a Debian for 64-bit ARM"
  rm -rf -- "$place"
  debootstrap --arch arm64 --foreign --variant=minbase --include=python3 trixie "$place" >"$place.log" 2>&1 ||
    die "see build/roots/arm.log"
  for file in "$place"/var/cache/apt/archives/*.deb; do dpkg-deb -x "$file" "$place"; done
  "$tools/python" -m pip install -q --find-links "$folder" --target "$place/root" --only-binary=:all: \
    --platform manylinux_2_28_aarch64 --platform manylinux_2_17_aarch64 --python-version 3.13 limber3d </dev/null
  block README.md python '^## Python' >"$place/root/first.py"
  found=$(PYTHONPATH=$place/root qemu-aarch64 -L "$place" "$place/usr/bin/python3" "$place/root/first.py" 2>&1)
  [[ $found == "2.0 Witness"* ]] || die "the wheel for 64-bit ARM answers $found"
  say "the wheel answers on 64-bit ARM, on QEMU, with Debian's CPython 3.13: $found"
}

# The archive of sources, with Debian's libraries.
try_sources() {
  bare_root bookworm sdist python3-venv python3-dev g++ cmake ninja-build libhwy-dev libtbb-dev libboost-dev nlohmann-json3-dev
  cp -- "$folder"/*.tar.gz "$root/build/roots/sdist/packages/"
  block README.md python '^## Python' >"$root/build/roots/sdist/root/first.py"
  expect_answer sdist "$(block docs/guide/install.md sh '^### Sources for pip')" "2.0 Witness"
  say "the archive of sources builds and answers on Debian bookworm"
}

is_tried=1
if [[ ${1:-} == --build ]]; then is_tried=0 && shift; fi
pythons=(3.12 3.11 3.10)
if (($#)); then pythons=("$@"); fi
prepare
rm -rf -- "$folder"
mkdir -p -- "$folder"
for python in "${pythons[@]}"; do
  wheel "$python" x86_64-linux-gnu manylinux_2_28_x86_64
  if [[ $python == 3.12 ]]; then wheel 3.12 aarch64-linux-gnu; fi
done
(cd -- "$root" && "$tools/python" -m build --sdist --outdir "$folder") </dev/null >"$folder/log-sdist" 2>&1 ||
  die "$(tail -n 40 -- "$folder/log-sdist")"
check
if ((is_tried)); then
  for python in "${pythons[@]}"; do
    if [[ $python == 3.12 ]]; then
      run_tests_of 3.12
      try trixie 3.13
      try sid 3.14
      try_arm
    fi
    try bookworm "$python"
  done
  try_sources
fi
say "wheels are in ${folder#"$root/"}: $(cd -- "$folder" && echo *.whl *.tar.gz)"
