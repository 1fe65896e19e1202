#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: bench [name]     run and plot benchmarks (thesis, the default) into bench/results/<machine>/
#: bench peers [F]  compare with other libraries; F is a folder with stanford-bunny.obj and armadillo.obj
#: bench mix [F]    a broad mix of scenes next to FCL and Coal, with all meshes of F that it knows; --poses N for other
#:                  than 40 poses a situation, --scene PARTS... for scenes with one of these in their names
#: bench against REV [F]  this revision next to another in one process: ratios of queries, updates and builds
#: bench answers    a hash of the answers to 200 000 queries of every kind, to be compared with other machines, compilers,
#:                  revisions; --scale N for 4 000 N queries
#: bench deadlines [F]  what queries know when their time is up, how late they are, how much work it takes to the end, and
#:                  what a cache saves and costs
#: bench spikes     what moves and commits take at worst while trees stay as good as new
#: bench haptics    a force loop for a minute at 1 kHz and one at 5 kHz: times of ticks, missed ones, answers; --rates,
#:                  --seconds, --tick-budget-us and --core change that
#: bench deforming [F]  what keeping trees of deforming meshes up to date costs, next to other libraries
#: bench contacts F  pairs of triangles that intersect or are close, and closest points, next to Embree, CGAL and
#:                  libraries from PyPI, which go into a virtual environment below build/; F is a folder with
#:                  cloth_ball_92.ply, cloth_ball_93.ply, stanford-bunny.obj and armadillo.obj. MeshLib takes part with
#:                  LIMBER_WITH_MESHLIB=1 only: its license does not allow commercial use, and whoever installs it
#:                  accepts that license
#: bench motion F   how far moving meshes can go, next to the IPC Toolkit from PyPI; F is a folder with cloth_ball_92.ply,
#:                  cloth_ball_93.ply, armadillo_rollers_326.ply and armadillo_rollers_327.ply
#: bench scene      candidate pairs and queries of 2 000 moving bodies, next to FCL and Coal
#: bench configurations  the closest links of two arms in 10 000 configurations, in Python, next to python-fcl
#: bench threads [F]  how much faster what runs on several threads is, on 2, 4, 8, ... of them; F is a folder with
#:                  cloth_ball_92.ply, cloth_ball_93.ply, stanford-bunny.obj and armadillo.obj
#: bench solvers F  what solvers ask for, in one table: contacts of a heap of bodies on one thread and on two, and from
#:                  bench contacts F and bench configurations self-intersections, elements and configurations
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
    printf 'processor  %s, family %s, model %s\n' "$(processor 'model name')" "$(processor 'cpu family')" "$(processor model)"
    printf 'cores      %s visible, 1 used\n' "$jobs"
    cat -- "$root/build/bench/bench/compiler.txt"
  } >"$results/machine.txt"
  say "running limber_bench_$1"
  "$root/build/bench/bench/limber_bench_$1" --out "$results" "${@:2}" </dev/null
}

# The options of a program for the folder of meshes that a verb was given, or not.
meshes=()
use_meshes() { if (($#)); then meshes=(--meshes "$1"); fi; }

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

bench_mix() {
  use_meshes "$@"
  need build io program peers
  build_benches mix
  run_bench mix "${meshes[@]}" "${@:2}"
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

bench_answers() {
  need build io program
  build_benches answers
  run_bench answers "$@"
}

bench_deforming() {
  use_meshes "$@"
  need build io program peers
  build_benches deforming
  run_bench deforming "${meshes[@]}"
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

bench_spikes() {
  need build io program
  build_benches spikes
  run_bench spikes "$@"
}

bench_haptics() {
  need build io program
  build_benches haptics
  run_bench haptics "$@"
}

# bench_contacts FOLDER: other libraries first, then ours, which reads their times, their answers and their meshes.
bench_contacts() {
  local answers=$root/build/contact_answers contacts=../bench/contacts peers=(ipctk coal fcpw trimesh) theirs=()
  local requirements=("$contacts/requirements.txt")
  (($#)) || die "bench contacts: which folder has the meshes? See ./dev help"
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
  (($#)) || die "bench motion: which folder has the meshes? See ./dev help"
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

bench_scene() {
  need build io program peers
  build_benches scene
  run_bench scene "$@"
}

bench_configurations() {
  need build io python
  tests_environment
  configure release -DLIMBER_BUILD_TESTS=OFF -DLIMBER_BUILD_PYTHON=ON "-DPython_EXECUTABLE=$root/build/python/bin/python"
  build release --target limber_python
  PYTHONPATH=$root/build/release/python PYTHONDONTWRITEBYTECODE=1 "$root/build/python/bin/python" \
    "$root/bench/scene/configurations.py" --out "$results" "$@" </dev/null
}

bench_threads() {
  use_meshes "$@"
  need build io program
  build_benches threads
  run_bench threads "${meshes[@]}"
}

bench_solvers() {
  (($#)) || die "bench solvers: which folder has the meshes? See ./dev help"
  need build io program
  build_benches bodies
  run_bench bodies
  bench_contacts "$1"
  bench_configurations
  python3 "$root/bench/solvers/table.py" "$results"
}

name=${1:-thesis}
results=$root/bench/results/$(machine)
mkdir -p -- "$results"
case $name in
  thesis | all) bench_thesis ;;
  peers) bench_peers "${@:2}" ;;
  mix) bench_mix "${@:2}" ;;
  deforming) bench_deforming "${@:2}" ;;
  deadlines) bench_deadlines "${@:2}" ;;
  spikes) bench_spikes "${@:2}" ;;
  haptics) bench_haptics "${@:2}" ;;
  against) bench_against "${@:2}" ;;
  answers) bench_answers "${@:2}" ;;
  contacts) bench_contacts "${@:2}" ;;
  motion) bench_motion "${@:2}" ;;
  scene) bench_scene "${@:2}" ;;
  configurations) bench_configurations "${@:2}" ;;
  threads) bench_threads "${@:2}" ;;
  solvers) bench_solvers "${@:2}" ;;
  *) die "no benchmark is called '$name'; there are:" \
    "thesis, peers, mix, deforming, deadlines, spikes, haptics, against, answers, contacts, motion, scene," \
    "configurations, threads, solvers" ;;
esac
say "results are in $results"
