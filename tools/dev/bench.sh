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

# run_bench NAME [arguments]: runs a benchmark that has been built, and keeps its tables, processor, compiler and flags.
run_bench() {
  mkdir -p -- "$results"
  {
    printf 'processor  %s%s (family %s, model %s)\n' "$(processor 'model name')" "$(known_as)" "$(processor 'cpu family')" \
      "$(processor model)"
    printf 'cores      %s visible, 1 used\n' "$jobs"
    cat -- "$root/build/bench/bench/compiler.txt"
  } >"$results/machine.txt"
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

# Debian's own interpreter: matplotlib comes from apt, and another python3 may stand before it on PATH.
plot() { /usr/bin/python3 "$root/bench/plots/$1.py" "$results"; }

bench_thesis() {
  need build io program plots
  build_benches queries updates
  run_bench queries
  run_bench updates
  plot plot_thesis
}

bench_peers() {
  use_meshes "$@"
  need build io program peers plots
  build_benches peers mix
  run_bench peers "${meshes[@]}"
  plot plot_peers
  run_bench mix "${meshes[@]}"
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
  need build io program
  build_benches deadlines caches
  run_bench deadlines "${meshes[@]}" "${@:2}"
  run_bench caches "${meshes[@]}"
}

# bench_contacts FOLDER: other libraries first, then ours, which reads their times, their answers and their meshes.
bench_contacts() {
  local answers=$root/build/contact_answers contacts=../bench/contacts peers=(ipctk coal fcpw trimesh) theirs=()
  local requirements=("$contacts/requirements.txt")
  (($#)) || die "bench contacts: which folder has the meshes?"
  if [[ ${LIMBER_WITH_MESHLIB:-} == 1 ]]; then
    requirements+=("$contacts/requirements_meshlib.txt")
    peers=(meshlib "${peers[@]}")
  fi
  need build io program points
  build_benches contacts
  rm -rf -- "$answers"
  if (python_environment peers "${requirements[@]}"); then
    say "running other libraries: ${peers[*]}"
    PYTHONDONTWRITEBYTECODE=1 "$root/build/peers/bin/python" "$root/bench/contacts/peers.py" "$1" \
      --peers "${peers[@]}" --out "$results" --answers "$answers" </dev/null
    theirs=(--peers "$results/contact_peers.csv" --answers "$answers")
  else
    say "other libraries are left out, and so are the meshes of two cloths: PyPI's could not be installed"
  fi
  run_bench contacts --meshes "$1" "${theirs[@]}" "${@:2}"
}

bench_motion() {
  local theirs=()
  (($#)) || die "bench motion: which folder has the meshes?"
  need build io program points
  build_benches motion
  if (python_environment peers ../bench/contacts/requirements.txt); then
    say "running the IPC Toolkit"
    PYTHONDONTWRITEBYTECODE=1 "$root/build/peers/bin/python" "$root/bench/motion/ipc_steps.py" "$1" --out "$results" \
      </dev/null
    theirs=(--peers "$results/motion_peers.csv")
  else
    say "the IPC Toolkit is left out: PyPI's could not be installed"
  fi
  run_bench motion --meshes "$1" "${theirs[@]}" "${@:2}"
}

bench_configurations() {
  need build io python
  tests_environment
  configure release -DLIMBER_BUILD_TESTS=OFF -DLIMBER_BUILD_PYTHON=ON "-DPython_EXECUTABLE=$root/build/python/bin/python"
  build release --target limber_python
  PYTHONPATH=$root/build/release/python PYTHONDONTWRITEBYTECODE=1 "$root/build/python/bin/python" \
    "$root/bench/scene/configurations.py" --out "$results" "$@" </dev/null
}

bench_solvers() {
  (($#)) || die "bench solvers: which folder has the meshes?"
  need build io program
  build_benches bodies
  run_bench bodies
  bench_contacts "$1"
  bench_configurations "${@:2}"
  python3 "$root/bench/solvers/table.py" "$results"
}

name=${1:-thesis}
results=$root/bench/results/$(machine)
mkdir -p -- "$results"
case $name in
  thesis | peers | deadlines | against | contacts | motion | configurations | solvers) "bench_$name" "${@:2}" ;;
  mix | deforming) use_meshes "${@:2}" && simple peers "$name" "${meshes[@]}" "${@:3}" ;;
  threads) use_meshes "${@:2}" && simple io threads "${meshes[@]}" ;;
  scene) simple peers scene "${@:2}" ;;
  spikes | haptics | answers) simple io "$name" "${@:2}" ;;
  *) die "no benchmark is called '$name'; bench/README.md has the names" ;;
esac
say "results are in $results"
