#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: portable [TARGET...]  cross-compile the program and tests for musl, windows, bigendian and arm64, and run them; the
#:                  program alone for macos, where it is not run; all without an argument; long. LIMBER_SOURCES can
#:                  name a folder of libraries' sources (HWY, TBB, BOOST, BOOSTCONFIG, ...); else Debian has them

# A target is compiled with all libraries inside: the program, and the tests of units and mesh files that need no
# library but GoogleTest. What can run here does: the tests, and the program, whose answers about mesh files must be to
# the byte those of the program of this machine.
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

# One line each: target, list of Debian packages, system, processor, compiler (zig:TRIPLE, or start:end of the names of
# GCC's programs), and what runs a program, if anything does.
targets='
musl      python     Linux   x86_64  zig:x86_64-linux-musl     env
windows   mingw      Windows x86_64  x86_64-w64-mingw32:-posix /usr/lib/wine/wine64
bigendian big_endian Linux   s390x   s390x-linux-gnu:          qemu-s390x
arm64     arm        Linux   aarch64 aarch64-linux-gnu:        qemu-aarch64
macos     python     Darwin  arm64   zig:aarch64-macos
'
folder=$root/build/portable

# slow_tests: what is left out in QEMU: tests that took more than a tenth of a second on musl, which runs here, 95 % of the
# time of all. Tests of kernels may take a second. Where musl has not run, nothing is left out.
slow_tests() {
  sed -nE 's/^\[       OK \] (.*) \(([0-9]{3,}) ms\)$/\1 \2/p' "$folder"/musl/unit_*.log 2>/dev/null |
    awk '$1 !~ /^Kernels\./ || $2 >= 1000 {print $1}' | paste -sd:
}

# The sources of the libraries: name for FetchContent, place in Debian's archive, SHA-256.
archives='
HWY h/highway/highway_1.2.0.orig.tar.gz 7e0be78b8318e8bdbf6fa545d2ecb4c90f947df03f7aadc42c1967f019e63343
TBB o/onetbb/onetbb_2022.1.0.orig.tar.xz c220a5e4fe452f3a24f562212377dc796d90e8d4e9bfb3392524f18c8f48cd7f
NLOHMANN_JSON n/nlohmann-json3/nlohmann-json3_3.11.3.orig.tar.gz 0d8ef5af7f9794e3263480193c491549b2ba6cc74bb018906202ada498a79406
FMT f/fmtlib/fmtlib_11.1.1%2bds1.orig.tar.xz 7d8550c9c5fdc4d03d50b55e0697176a19d3f34a3070580fb54e282da1aca555
BOOST b/boost1.90/boost1.90_1.90.0.orig.tar.xz 72e81363dece294942cf4f0ccb86158b390b723d7b332a59a0f869709f306da6
CLI11 c/cli11/cli11_2.4.1%2bds.orig.tar.xz 0b8fbf2398875f15f30a675c7f412123a2aaa38df2863e991de72004fd5f1292
'

# unpack ARCHIVE NAME DEPTH [FOLDER]: as sources/NAME, less the first folders.
unpack() {
  mkdir -p -- "$folder/sources/$2"
  tar -xf "$1" "--strip-components=$3" -C "$folder/sources/$2" "${@:4}"
}

# Unpacks them in folders of these names; of Boost, two of its libraries.
get_sources() {
  local name place hash archive
  if [[ -n ${LIMBER_SOURCES:-} || -e $folder/sources/complete ]]; then return 0; fi
  say "getting the sources of libraries from Debian's archive"
  mkdir -p -- "$folder"
  while read -r name place hash; do
    if [[ -z $name ]]; then continue; fi
    archive=$folder/${place##*/}
    curl -fsSL --retry 3 -o "$archive" "http://deb.debian.org/debian/pool/main/$place" ||
      die "cannot get ${place##*/}; LIMBER_SOURCES can name a folder with folders of sources: HWY, TBB, ..."
    printf '%s  %s\n' "$hash" "$archive" | sha256sum --check --quiet || die "${place##*/} is not what it was"
    if [[ $name == BOOST ]]; then
      unpack "$archive" BOOST 3 boost_1.90/libs/multiprecision
      unpack "$archive" BOOSTCONFIG 3 boost_1.90/libs/config
    else
      unpack "$archive" "$name" 1
    fi
  done <<<"$archives"
  sed -i '1i #include <stdlib.h>' "$folder/sources/FMT/include/fmt/format.h"  # which this version forgets
  touch -- "$folder/sources/complete"
}

# zig_programs TRIPLE: the parts of Zig's compiler as programs for CMake: folder/bin/TRIPLE-cc and so on.
zig_programs() {
  local zig part
  python_environment wheel_tools requirements_wheel.txt
  zig=$("$root/build/wheel_tools/bin/python" -c 'import ziglang; print(ziglang.__path__[0])')/zig
  mkdir -p -- "$folder/bin"
  # Zig takes -Og for a wish to have undefined behaviour checked.
  for part in "cc -target $1 -fno-sanitize=undefined" "c++ -target $1 -fno-sanitize=undefined" ar ranlib; do
    printf '#!/bin/sh\nexec "%s" %s "$@"\n' "$zig" "$part" >"$folder/bin/$1-${part%% *}"
    chmod +x -- "$folder/bin/$1-${part%% *}"
  done
}

# compile TARGET SYSTEM PROCESSOR COMPILER BUILT...
compile() {
  local target=$1 system=$2 processor=$3 compiler=$4 source name program part options=()
  if [[ $compiler == zig:* ]]; then
    zig_programs "${compiler#zig:}"
    for part in C_COMPILER=cc CXX_COMPILER=c++ AR=ar RANLIB=ranlib; do
      options+=("-DCMAKE_${part%=*}=$folder/bin/${compiler#zig:}-${part#*=}")
    done
    export CCACHE_COMPILERTYPE=clang CCACHE_COMPILERCHECK='%compiler% --version'
  else
    for part in C_COMPILER=gcc CXX_COMPILER=g++; do
      options+=("-DCMAKE_${part%=*}=${compiler%:*}-${part#*=}${compiler#*:}")
    done
  fi
  # CMake wants Apple's tool to be there, which only installs.
  if [[ $system == Darwin ]]; then options+=(-DCMAKE_INSTALL_NAME_TOOL=/bin/false); else
    options+=(-DCMAKE_EXE_LINKER_FLAGS=-static)
  fi
  for source in "${LIMBER_SOURCES:-$folder/sources}"/[A-Z]*/; do
    name=$(basename -- "$source")
    options+=("-DFETCHCONTENT_SOURCE_DIR_$name=$(readlink -f -- "$source")")
  done
  say "configuring build/portable/$target"
  cmake -S "$root" -B "$folder/$target" -G Ninja --log-level=WARNING "${options[@]}" \
    -DCMAKE_SYSTEM_NAME="$system" -DCMAKE_SYSTEM_PROCESSOR="$processor" \
    -DCMAKE_FIND_ROOT_PATH="$folder/none" -DCMAKE_FIND_ROOT_PATH_MODE_PACKAGE=ONLY \
    -DCMAKE_FIND_ROOT_PATH_MODE_INCLUDE=ONLY -DCMAKE_FIND_ROOT_PATH_MODE_LIBRARY=ONLY \
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS=-O2 -DCMAKE_CXX_FLAGS_RELEASE=-DNDEBUG -DCMAKE_UNITY_BUILD=ON \
    -DCMAKE_UNITY_BUILD_BATCH_SIZE=16 -DLIMBER_CHECKS=ON -DLIMBER_FEWER_KERNELS=ON -DLIMBER_INSTALL=OFF \
    -DLIMBER_BUILD_TESTS=ON -DLIMBER_GTEST_SOURCES=/usr/src/googletest \
    -DCMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE=PRE_TEST \
    "-DCMAKE_CXX_COMPILER_LAUNCHER=$(command -v ccache || true)" </dev/null
  build "portable/$target" --target "${@:5}"
  for program in clients/program/limber tests/limber_{unit,io}_tests; do  # without .exe, which Windows adds
    if [[ -e $folder/$target/$program.exe ]]; then ln -sf -- "${program##*/}.exe" "$folder/$target/$program"; fi
  done
}

# Questions whose answers do not depend on the functions of a C library that round in their own ways.
spot=tests/data/spot.ply
questions="
info $spot
self $spot --margin 0.004
distance $spot $spot --pose-b 0.3,0.2,2.1,0.9,0.1,0.3,0.2
collide $spot $spot --pose-b 0.1,0.2,0.3,1,0,0.2,0
contacts $spot $spot --pose-b 0.1,0.2,0.3,1,0,0.2,0 --margin 0.01
"

# answers_of PROGRAM...: to all questions, less the times.
answers_of() {
  local question words
  while read -r question; do
    read -ra words <<<"$question"
    if ((${#words[@]})); then (cd -- "$root" && "$@" "${words[@]}" --json </dev/null); fi
  done <<<"$questions" | sed -E 's/"[a-z_]+_us": [-+0-9.e]+/"us": 0/g'
}

# run TARGET EMULATOR: the tests, and the answers.
run() {
  local target=$1 filter='*' count
  emulator=("$2")
  export WINEDEBUG=-all WINEPREFIX=$folder/wine LC_ALL=C.UTF-8 LIMBER_UPDATE_SEQUENCES=100
  if [[ $2 == qemu-* ]]; then filter=-$(slow_tests); fi
  "$2" "$folder/$target/clients/program/limber" --version </dev/null
  run_programs "portable/$target" "unit:$filter" io || die "$target: tests failed"
  count=$(awk '/^\[  PASSED  \]/ {n += $4} END {print n}' "$folder/$target"/{unit,io}_*.log)
  answers_of "$2" "$folder/$target/clients/program/limber" >"$folder/$target/answers"
  cmp -- "$folder/answers" "$folder/$target/answers" || die "$target: the program's answers are others than here"
  say "$target: $count tests passed; the program's $(wc -c <"$folder/answers") bytes of answers are those it gives here"
}

wanted=("$@")
known=$(awk '{print $1}' <<<"$targets" | xargs)
if ((${#wanted[@]} == 0)); then read -ra wanted <<<"$known"; fi
for target in "${wanted[@]}"; do
  [[ " $known " == *" $target "* ]] || die "portable takes some of: $known"
done
need build io program portable
get_sources
configure release -DLIMBER_BUILD_TESTS=OFF
build release --target limber_program
answers_of "$root/build/release/clients/program/limber" >"$folder/answers"
for target in "${wanted[@]}"; do
  read -r _ packages system processor compiler runner < <(awk -v target="$target" '$1 == target' <<<"$targets")
  need "$packages"
  if [[ -n $runner ]]; then
    (compile "$target" "$system" "$processor" "$compiler" limber_program limber_unit_tests limber_io_tests)
    (run "$target" "$runner")
  else
    (compile "$target" "$system" "$processor" "$compiler" limber_program)
    say "$target: the program is compiled and linked, not run"
  fi
done
