# shellcheck shell=bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# What the scripts of the verbs share. Each of them sources this file first.
set -euo pipefail

# ccache serves sources with a precompiled header only where it is told to.
export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros}

root=$(cd -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/../.." && pwd)
jobs=$(nproc)

say() { printf 'dev: %s\n' "$*" >&2; }
die() { say "$*"; exit 1; }

# need LIST...: installs those packages of these lists of packages.txt that are missing; one apt-get update, and only if
# there is something to install.
need() {
  local list line words packages=()
  for list in "$@"; do
    line=$(grep "^$list:" "$root/tools/dev/packages.txt") || die "packages.txt has no list '$list'"
    read -ra words <<<"${line#*:}"
    packages+=("${words[@]}")
  done
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    say "not a Debian system, so nothing is installed; needed are the likes of: ${packages[*]}"
    return 0
  fi
  local missing as_root=() log
  mapfile -t missing < <(comm -13 <(dpkg-query -W -f '${db:Status-Status} ${Package}\n' | sed -n 's/^installed //p' | sort -u) \
    <(printf '%s\n' "${packages[@]}" | sort -u))
  ((${#missing[@]})) || return 0

  if ((EUID != 0)); then
    command -v sudo >/dev/null || die "neither root nor sudo; ask for: apt-get install ${missing[*]}"
    as_root=(sudo)
  fi
  as_root+=(env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=600 -o Acquire::Retries=3)
  log=$(mktemp)
  say "installing ${missing[*]}"
  if ! { "${as_root[@]}" update &&
    "${as_root[@]}" install -y --no-install-recommends "${missing[@]}"; } </dev/null >"$log" 2>&1; then
    tail -n 20 -- "$log" >&2
    rm -f -- "$log"
    die "apt-get could not install: ${missing[*]}"
  fi
  rm -f -- "$log"
}

# configure PRESET [cmake arguments]
configure() {
  local preset=$1 fresh=() found
  shift
  # Left alone, CMake stays with the compiler that an earlier CXX chose.
  found=$(sed -n 's/^CMAKE_CXX_COMPILER:FILEPATH=//p' "$root/build/$preset/CMakeCache.txt" 2>/dev/null || true)
  if [[ -n ${CXX:-} && -n $found && $found != "$(command -v "${CXX%% *}")" ]]; then fresh=(--fresh); fi
  say "configuring build/$preset"
  (cd -- "$root" && cmake --preset "$preset" "${fresh[@]}" --log-level=WARNING \
    "-DCMAKE_CXX_COMPILER_LAUNCHER=$(command -v ccache || true)" "$@") </dev/null
}

# build PRESET [cmake --build arguments]
build() {
  local preset=$1
  shift
  say "building build/$preset"
  cmake --build "$root/build/$preset" --parallel "$jobs" "$@" </dev/null
}

# newest_clang: the newest Clang there is. The security archive has 22; the main one ends with 19.
newest_clang() {
  if apt-cache show clang-22 >/dev/null 2>&1; then printf 'clang-22\n'; else printf 'clang-19\n'; fi
}

# run_tests PRESET [ctest arguments]; ctest's own closing line stays the last.
run_tests() {
  local preset=$1
  shift
  (cd -- "$root" && ctest --preset "$preset" --parallel "$jobs" "$@") </dev/null
}

# in_parallel FUNCTION WORDS...: calls it with the words of each argument, as many at a time as there are processors.
in_parallel() {
  local function=$1 call words running=0 status=0
  for call in "${@:2}"; do
    if ((running < jobs)); then running=$((running + 1)); else wait -n || status=1; fi
    read -ra words <<<"$call"
    "$function" "${words[@]}" &
  done
  for ((; running > 0; --running)); do wait -n || status=1; done
  return "$status"
}

# run_programs PRESET NAME[:FILTER]...: the programs of these tests, each in as many shards as there are processors. ctest
# starts a process for each test, which costs more than most tests where processes start slowly: with sanitizers, on an
# emulator. What a program printed is in build/PRESET/NAME_SHARD.log, and shown if it failed.
emulator=()
run_programs() {
  local preset=$1 run shard shards=()
  shift
  for run in "$@"; do
    for ((shard = 0; shard < jobs; ++shard)); do shards+=("$preset $run $shard"); done
  done
  in_parallel run_shard "${shards[@]}"
}

# run_shard PRESET NAME[:FILTER] SHARD
run_shard() {
  local preset=$1 name=${2%%:*} shard=$3 filter='*' log start=$SECONDS
  if [[ $2 == *:* ]]; then filter=${2#*:}; fi
  log=$root/build/$preset/${name}_$shard.log
  if (cd -- "$root" && GTEST_TOTAL_SHARDS=$jobs GTEST_SHARD_INDEX=$shard \
    "${emulator[@]}" "$root/build/$preset/tests/limber_${name}_tests" --gtest_filter="$filter") >"$log" 2>&1 </dev/null; then
    say "$preset: $name, shard $((shard + 1)) of $jobs: $(sed -n 's/^\[  PASSED  \] //p' "$log") in $((SECONDS - start)) s"
  else
    tail -n 60 -- "$log" >&2
    say "$preset: $name, shard $((shard + 1)) of $jobs FAILED; the log is $log"
    return 1
  fi
}

# need_for_tests [LIST...]
need_for_tests() { need build io program tests "$@"; }

# python_environment NAME FILE...: the virtual environment build/NAME of python3, with what those files of python require
# from PyPI. What is there already is not asked for again.
python_environment() {
  local name=$1 environment=$root/build/$1 file files=() wanted
  shift
  for file in "$@"; do files+=("$root/python/$file"); done
  wanted=$(python3 -VV && cat -- "${files[@]}")
  if [[ $wanted == "$(cat -- "$environment/installed" 2>/dev/null)" ]]; then return 0; fi
  # Debian packages headers and the module for virtual environments by themselves; other interpreters have both.
  if ! python3 -c 'import ensurepip, os, sysconfig, venv
os.stat(os.path.join(sysconfig.get_path("include"), "Python.h"))' 2>/dev/null; then need python; fi
  say "installing from PyPI into build/$name: ${*}"
  rm -rf -- "$environment"
  python3 -m venv "$environment"
  "$environment/bin/python" -m pip install -q --retries 3 "${files[@]/#/-r}" </dev/null ||
    die "pip could not install what ${*} name"
  printf '%s\n' "$wanted" >"$environment/installed"
}

# What the tests of the Python package need; one environment, so that verbs do not replace each other's.
tests_environment() { python_environment python requirements.txt requirements_{test,examples,peers}.txt; }

# The preset `checked` with the Python package.
configure_checked() {
  need_for_tests python
  tests_environment
  # pyright gets its program from the npm registry when it first runs.
  export PYRIGHT_PYTHON_CACHE_DIR=$root/build/python/pyright
  configure checked -DLIMBER_BUILD_PYTHON=ON "-DPython_EXECUTABLE=$root/build/python/bin/python"
}

# on_emscripten COMMAND...: Emscripten's scripts find their modules also where node is not Debian's.
on_emscripten() { NODE_PATH=/usr/share/nodejs${NODE_PATH:+:$NODE_PATH} CXX='' "$@"; }

# compile_web PRESET: the JavaScript package, in build/PRESET/limber3d.
compile_web() {
  need build web
  rm -rf -- "$root/build/$1"/{limber3d/*.js,tests,examples}  # among them what the sources no longer have
  on_emscripten configure "$1"
  on_emscripten build "$1"
}

# install_typescript PRESET: what npm installs beside the JavaScript package; the working directory is then build/PRESET.
install_typescript() {
  if ! command -v npm >/dev/null; then need npm; fi
  cd -- "$root/build/$1"
  if ! cmp -s package.json node_modules/installed.json; then
    say "installing from npm into build/$1: TypeScript"
    npm install --install-links=false --no-audit --no-fund --no-package-lock --loglevel=error </dev/null
    cp -- package.json node_modules/installed.json
  fi
}

# build_package PRESET: the JavaScript package with its types; the working directory is then build/PRESET.
build_package() {
  compile_web "$1"
  install_typescript "$1"
  rm -f -- limber3d/*.d.ts
  node_modules/.bin/tsc -p tsconfig.json
}

# block FILE LANGUAGE PATTERN: the first fenced code of that language after the first line that matches the pattern.
block() {
  awk -v language="$2" -v pattern="$3" '
    !found && $0 ~ pattern { found = 1 }
    found && !inside && $0 == "```" language { inside = 1; next }
    inside && $0 == "```" { exit }
    inside' "$root/$1"
}

# Our C++ files below the working directory, each ended by a zero byte. Needs no git.
cpp_files() {
  local folders=() folder
  for folder in include src scenes clients tests bench examples fuzz python; do
    if [[ -d $folder ]]; then folders+=("$folder"); fi
  done
  find "${folders[@]}" -type f \( -name '*.h' -o -name '*.cpp' \) -print0 | sort -z
}
