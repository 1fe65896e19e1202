#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: bench [NAME]     run benchmarks, and keep their tables in bench/results/<machine>/; bench/README.md has the names

source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

# processor KEY: a value of the first processor's entry in /proc/cpuinfo, if it has one.
processor() { sed -n "s/^$1[[:space:]]*: *//p; T; q" /proc/cpuinfo; }

# The folder under bench/results that belongs to this machine. Virtual machines leave the number out of a processor's
# name, so family and model are part of it.
machine() {
  local name family model
  name=$(processor 'model name') family=$(processor 'cpu family') model=$(processor model)
  name=${LIMBER_MACHINE:-$name${family:+ family $family}${model:+ model $model}}
  name=$(tr '[:upper:]' '[:lower:]' <<<"$name" | sed -E 's/\((r|tm)\)//g; s/[^a-z0-9]+/-/g; s/^-+|-+$//g')
  printf '%s\n' "${name:-$(uname -m)}"
}

# The name that people know a server's processor by.
known_as() {
  case "$(processor 'cpu family') $(processor model)" in
    '6 106') printf ', Ice Lake' ;;
    '6 143') printf ', Sapphire Rapids' ;;
    '6 207') printf ', Emerald Rapids' ;;
    '25 1') printf ', Milan' ;;
    '25 17') printf ', Genoa' ;;
    '26 2') printf ', Turin' ;;
  esac
}

# build_benches NAME...: builds these benchmarks, next to all libraries that are found.
build_benches() {
  local coal
  # Coal comes as a Python wheel with headers and a library inside; without it the comparison goes on.
  coal=$(python3 -c 'import coal, pathlib; print(pathlib.Path(coal.__file__).parents[4])' 2>/dev/null || true)
  configure bench -DLIMBER_BUILD_PROGRAM=OFF -DLIMBER_BUILD_IO=ON "-DLIMBER_COAL_PREFIX=$coal"
  build bench --target "${@/#/limber_bench_}"
}

# note_machine COMMAND...: keeps the processor, and what that command says of compiler and flags.
note_machine() {
  mkdir -p -- "$results"
  {
    printf 'processor  %s%s (family %s, model %s)\n' "$(processor 'model name')" "$(known_as)" "$(processor 'cpu family')" \
      "$(processor model)"
    printf 'cores      %s visible, 1 used\n' "$jobs"
    "$@"
  } >"$results/machine.txt"
}

# run_bench NAME [arguments]: runs a benchmark that has been built, and keeps its tables.
run_bench() {
  note_machine cat -- "$root/build/bench/bench/compiler.txt"
  say "running limber_bench_$1"
  "$root/build/bench/bench/limber_bench_$1" --out "$results" "${@:2}" </dev/null
}

# The options of a program for the folder of meshes that a verb was given, or not.
meshes=()
use_meshes() { if (($#)); then meshes=(--meshes "$1"); fi; }

# simple LIST NAME [arguments]: a benchmark that is one program, which needs that list of packages besides.
simple() {
  need build io program "$1"
  build_benches "$2"
  run_bench "${@:2}"
}

bench_thesis() {
  need build io program plots
  build_benches queries updates
  run_bench queries
  run_bench updates
  # Debian's own interpreter: matplotlib comes from apt, and another python3 may stand before it on PATH.
  /usr/bin/python3 "$root/bench/plots/plot_thesis.py" "$results"
}

# bench_against REV [folder of meshes]: builds that revision with its namespace renamed, so that both can be linked.
bench_against() {
  local before=$root/build/against flags='-Dlimber=limber_before -O3 -DNDEBUG'
  (($#)) || die "bench against: which revision?"
  need build io program git
  rm -rf -- "$before"
  mkdir -p -- "$before"
  git -C "$root" archive "$1" | tar -x -C "$before"
  [[ -e $before/bench/against/engine.cpp ]] || die "bench against: $1 is too old, it has no bench/against/engine.cpp"
  cmake -S "$before" -B "$before/build/against" -G Ninja -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS=$flags" \
    -DLIMBER_BUILD_IO=OFF -DLIMBER_BUILD_PROGRAM=OFF -DLIMBER_BUILD_TESTS=OFF -DLIMBER_INSTALL=OFF \
    "-DCMAKE_CXX_COMPILER_LAUNCHER=$(command -v ccache || true)" >/dev/null </dev/null
  cmake --build "$before/build/against" --parallel "$jobs" --target limber </dev/null
  configure bench -DLIMBER_BUILD_PROGRAM=OFF -DLIMBER_BUILD_IO=ON "-DLIMBER_AGAINST=$before"
  build bench --target limber_bench_against
  {
    printf '# This revision next to %s\n\n' "$1"
    "$root/build/bench/bench/limber_bench_against" "${@:2}" </dev/null
  } | tee -- "$results/against.md"
}

bench_deadlines() {
  if (($# == 0)); then
    results=$root/build/bench/results
    say "without FOLDER there are no scans: results go to $results"
  fi
  use_meshes "$@"
  simple io deadlines "${meshes[@]}" "${@:2}"
}

# in_python NAME [arguments]: a benchmark in Python, next to libraries from PyPI.
in_python() {
  need build io python
  python_environment peers requirements.txt requirements_peers.txt ../bench/python/requirements.txt
  configure release -DLIMBER_BUILD_TESTS=OFF -DLIMBER_BUILD_PYTHON=ON "-DPython_EXECUTABLE=$root/build/peers/bin/python"
  build release --target limber_python
  note_machine "$root/build/peers/bin/python" -VV
  PYTHONPATH=$root/build/release/python PYTHONDONTWRITEBYTECODE=1 "$root/build/peers/bin/python" \
    "$root/bench/python/$1.py" --out "$results" "${@:2}" </dev/null
}

name=${1:-thesis}
results=$root/bench/results/$(machine)
mkdir -p -- "$results"
case $name in
  thesis | deadlines | against) "bench_$name" "${@:2}" ;;
  mix | points) use_meshes "${@:2}" && simple peers "$name" "${meshes[@]}" "${@:3}" ;;
  threads) use_meshes "${@:2}" && simple io threads "${meshes[@]}" ;;
  scene | deforming) simple peers "$name" "${@:2}" ;;
  haptics | answers) simple io "$name" "${@:2}" ;;
  contacts | motion | configurations) in_python "$name" "${@:2}" ;;
  *) die "no benchmark is called '$name'; bench/README.md has the names" ;;
esac
say "results are in $results"
