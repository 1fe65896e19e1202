#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: portable [TARGET...]  build for other systems from this one, and run there what can be run: musl windows arm64
#:                  bigendian macos; all of them without an argument. LIMBER_SOURCES: a folder of libraries' sources

# A target is compiled with all libraries inside: the program, and the tests of units and mesh files that need no library
# but GoogleTest. What can run here does: the tests, and the program, whose answers about mesh files must be to the byte
# those of the program of this machine.
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

# One line each: target, Debian packages, system, processor, compiler (zig:TRIPLE, or the start of the names of GCC's
# programs and their end), how a program is run (no: it cannot be).
targets='
musl      -          Linux   x86_64  zig:x86_64-linux-musl      env
windows   mingw      Windows x86_64  x86_64-w64-mingw32:-posix  /usr/lib/wine/wine64
arm64     arm        Linux   aarch64 aarch64-linux-gnu:         qemu-aarch64
bigendian big_endian Linux   s390x   s390x-linux-gnu:           qemu-s390x
macos     -          Darwin  arm64   zig:aarch64-macos          no
'
folder=$root/build/portable

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
  sed -i '1i #include <stdlib.h>' "$folder/sources/FMT/src/os.cc"  # which this version forgets
  touch -- "$folder/sources/complete"
}

# The programs of Zig's compiler for one triple: files that name it, for CMake.
zig_programs() {
  local triple=$1 zig part bin=$folder/bin
  python_environment zig requirements_zig.txt
  zig=$(echo "$root"/build/zig/lib/python*/site-packages/ziglang/zig)
  mkdir -p -- "$bin"
  for part in cc c++; do printf '#!/bin/sh\nexec %q %s -target %s "$@"\n' "$zig" "$part" "$triple" >"$bin/$triple-$part"; done
  for part in ar ranlib; do printf '#!/bin/sh\nexec %q %s "$@"\n' "$zig" "$part" >"$bin/$triple-$part"; done
  chmod +x -- "$bin/$triple"-*
  options+=("-DCMAKE_C_COMPILER=$bin/$triple-cc" "-DCMAKE_CXX_COMPILER=$bin/$triple-c++"
    "-DCMAKE_AR=$bin/$triple-ar" "-DCMAKE_RANLIB=$bin/$triple-ranlib" -DCMAKE_CXX_FLAGS=-fno-sanitize=undefined)
  export CCACHE_COMPILERTYPE=clang
}

# compile TARGET SYSTEM PROCESSOR COMPILER RUN
compile() {
  local target=$1 system=$2 processor=$3 compiler=$4 source name
  local sources=${LIMBER_SOURCES:-$folder/sources} options=()
  if [[ $compiler == zig:* ]]; then
    zig_programs "${compiler#zig:}"
  else
    options=("-DCMAKE_C_COMPILER=${compiler%:*}-gcc${compiler#*:}" "-DCMAKE_CXX_COMPILER=${compiler%:*}-g++${compiler#*:}")
  fi
  for source in "$sources"/[A-Z]*/; do
    name=$(basename -- "$source")
    options+=("-DFETCHCONTENT_SOURCE_DIR_$name=$(readlink -f -- "$source")")
  done
  # Everything inside one file, except where the system's own libraries cannot be.
  if [[ $target != macos ]]; then options+=(-DCMAKE_EXE_LINKER_FLAGS=-static); fi
  say "configuring build/portable/$target"
  cmake -S "$root" -B "$folder/$target" -G Ninja --log-level=WARNING "${options[@]}" -DCMAKE_SYSTEM_NAME="$system" \
    -DCMAKE_SYSTEM_PROCESSOR="$processor" -DCMAKE_FIND_ROOT_PATH="$folder/none" -DCMAKE_FIND_ROOT_PATH_MODE_PACKAGE=ONLY \
    -DCMAKE_FIND_ROOT_PATH_MODE_INCLUDE=ONLY -DCMAKE_FIND_ROOT_PATH_MODE_LIBRARY=ONLY -DCMAKE_EXECUTABLE_SUFFIX= \
    -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS_RELEASE=-O2 -DNDEBUG" -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=16 -DLIMBER_CHECKS=ON \
    -DLIMBER_INSTALL=OFF -DLIMBER_FEWER_KERNELS=ON -DLIMBER_BUILD_TESTS=ON -DLIMBER_GTEST_SOURCES=/usr/src/googletest \
    -DCMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE=PRE_TEST \
    "-DCMAKE_CXX_COMPILER_LAUNCHER=$(command -v ccache || true)" </dev/null
  build "portable/$target" --target limber_program limber_unit_tests limber_io_tests
}

# Questions whose answers do not depend on the functions of a C library that round in their own ways.
spot=tests/data/spot.obj
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

# What an emulator makes too slow, or what is about time.
slow='*TakesTime*:RealTime.*:*SharesModelsBetweenThreads*:FloatEnvironment.*:Queries.FindTheClosestOfManyNearly*'
slow+=':Model.KeepsUp*:ContactReduction.KeepsWhat*:ShapeTruths.*:Bodies/BodyKinds.*:CountingCollector.*:LikelyPair.*'
slow+=':Front.*:PathImpact.*:ParallelPairs.*:SolidRelation.*:ExactPoint.*:ContactSides.*:*DriftVertexByVertex*'

# run TARGET EMULATOR: the tests, and the answers.
run() {
  local target=$1 filter=''
  emulator=("$2")
  export WINEDEBUG=-all WINEPREFIX=$folder/wine LC_ALL=C.UTF-8 LIMBER_UPDATE_SEQUENCES=100
  if [[ $2 == qemu-* ]]; then filter=":-$slow"; fi
  "$2" "$folder/$target/apps/limber/limber" version </dev/null
  run_programs "portable/$target" "unit$filter" io || die "$target: tests failed"
  answers_of "$2" "$folder/$target/apps/limber/limber" >"$folder/$target/answers"
  cmp -- "$folder/answers" "$folder/$target/answers" || die "$target: the program's answers are others than here"
  say "$target: tests passed; the program's answers, $(wc -c <"$folder/answers") bytes, are those of this machine"
}

wanted=("$@")
need build io program portable
get_sources
configure release -DLIMBER_BUILD_TESTS=OFF
build release --target limber_program
answers_of "$root/build/release/apps/limber/limber" >"$folder/answers"
done=()
while read -r target packages system processor compiler run; do
  if [[ -z $target || (${#wanted[@]} -gt 0 && " ${wanted[*]} " != *" $target "*) ]]; then continue; fi
  if [[ $packages != - ]]; then need "$packages"; fi
  (compile "$target" "$system" "$processor" "$compiler")
  if [[ $run == no ]]; then say "$target: compiled and linked; nothing of it can run here"; else (run "$target" "$run"); fi
  done+=("$target")
done <<<"$targets"
((${#done[@]} >= ${#wanted[@]} && ${#done[@]} > 0)) || die "there are the targets $(awk '{printf "%s ", $1}' <<<"$targets")"
say "done: ${done[*]}"
