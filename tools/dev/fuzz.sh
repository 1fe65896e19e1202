#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: fuzz [--seconds N] [target...]  run fuzz targets, all by default, N seconds each (60), as many at a time as there are
#:                  processors; committed regressions come first
#: fuzz --quick [target...]  10 seconds each, with kernels for two instruction sets
#: fuzz --replay FILE target  run one input, under the same limits
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

all_targets=(gltf model_operations moving_models obj off ply pose_csv stl triangle_pair)

# fuzz_program TARGET [libFuzzer arguments]: what no input may exceed. The sanitizers' own memory counts too.
fuzz_program() {
  local target=$1
  shift
  ASAN_OPTIONS=quarantine_size_mb=16:malloc_context_size=8 UBSAN_OPTIONS=print_stacktrace=1 \
    "$root/build/fuzz/fuzz/fuzz_$target" -timeout=10 -rss_limit_mb=512 -malloc_limit_mb=256 -print_funcs=0 "$@"
}

# fuzz_one TARGET SECONDS: regressions, then new inputs. Everything is kept below build/fuzz/run/TARGET.
fuzz_one() {
  local target=$1 seconds=$2 folder=$root/build/fuzz/run/$1 status=0 artifact
  local inputs=("$root/fuzz/regression/$target"/*) options=()
  rm -rf -- "$folder"
  mkdir -p -- "$folder/corpus" "$folder/artifacts"
  if [[ -e ${inputs[0]} ]] && ! fuzz_program "$target" "${inputs[@]}" >"$folder/regression.log" 2>&1; then
    tail -n 40 -- "$folder/regression.log" >&2
    say "fuzz: $target FAILED on a committed regression; the log is $folder/regression.log"
    return 1
  fi
  if [[ -d $root/fuzz/corpus/$target ]]; then cp -- "$root/fuzz/corpus/$target"/* "$folder/corpus"; fi
  if [[ -e $root/fuzz/dictionaries/$target.dict ]]; then
    options+=(-dict="$root/fuzz/dictionaries/$target.dict")
  else  # inputs that nobody has chosen, but long enough to mean something
    python3 - "$folder/corpus" <<<'import random, sys
for i in range(40): open(f"{sys.argv[1]}/random_{i}", "wb").write(random.Random(i).randbytes(500))'
  fi
  # Where changes are judged, the same inputs come in the same order; elsewhere each run tries others.
  if [[ -n ${CI:-} ]]; then options+=(-seed=1); fi
  # Inputs of the binary targets have no meaning when they are short, so their length is not to grow by and by.
  fuzz_program "$target" -max_total_time="$seconds" -max_len=2000 -len_control=0 "${options[@]}" \
    -artifact_prefix="$folder/artifacts/" "$folder/corpus" >"$folder/log" 2>&1 || status=$?
  if ((status == 0)); then
    say "fuzz: $target ok, $(sed -n 's/^Done \([0-9]* runs\).*/\1/p' "$folder/log")"
    return 0
  fi
  grep -v $'^#[0-9]*\t' "$folder/log" | tail -n 60 >&2
  say "fuzz: $target FAILED; the log is $folder/log"
  for artifact in "$folder"/artifacts/{crash,leak,oom,timeout}-*; do
    [[ ! -e $artifact ]] || say "fuzz: replay with: ./dev fuzz --replay $artifact $target"
  done
  return 1
}

seconds=60 options=() replay='' targets=()
while (($#)); do
  case $1 in
    --seconds) seconds=${2:-} && shift ;;
    --quick) seconds=10 options=(-DLIMBER_FEWER_KERNELS=ON) ;;
    --replay) replay=${2:-} && shift ;;
    -*) die "fuzz has no option '$1'; see ./dev help" ;;
    *) targets+=("$1") ;;
  esac
  shift || die "an option of fuzz has no value"
done
if ((${#targets[@]} == 0)); then targets=("${all_targets[@]}"); fi
[[ -z $replay || ${#targets[@]} == 1 ]] || die "name the target to replay '$replay' with"
need build io fuzz
configure fuzz "${options[@]}"
build fuzz --target "${targets[@]/#/fuzz_}"
if [[ -n $replay ]]; then
  fuzz_program "${targets[0]}" "$replay"
  exit
fi
say "fuzzing ${targets[*]}, $seconds s each, $jobs at a time"
in_parallel fuzz_one "${targets[@]/%/ $seconds}" || die "fuzzing found something"
say "fuzzing found nothing"
