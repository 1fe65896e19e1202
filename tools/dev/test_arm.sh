#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: test_arm         the unit and property tests for 64-bit ARM, cross-compiled and run on an emulator; long

# The emulator is slow, so the tests draw fewer cases.
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

status=0
need_for_tests arm
if ! dpkg --print-foreign-architectures | grep -qx arm64; then
  ((EUID == 0)) || die "as root: dpkg --add-architecture arm64"
  dpkg --add-architecture arm64
fi
need arm_libraries
configure arm -DLIMBER_BUILD_PROGRAM=OFF -DLIMBER_BUILD_IO=ON
build arm --target limber_unit_tests limber_property_tests
export RC_PARAMS=max_success=100 LIMBER_UPDATE_SEQUENCES=100 LIMBER_ORACLE_PAIRS=10000 GTEST_TOTAL_SHARDS=$jobs
for program in unit property; do
  for ((shard = 0; shard < jobs; ++shard)); do
    log=$root/build/arm/${program}_$shard.log
    GTEST_SHARD_INDEX=$shard qemu-aarch64 "$root/build/arm/tests/limber_${program}_tests" --gtest_brief=1 >"$log" 2>&1 </dev/null &
  done
  while (($(jobs -rp | wc -l))); do wait -n || status=1; done
  tail -n 3 -- "$root/build/arm/${program}"_*.log >&2
done
((status == 0)) || die "tests failed on 64-bit ARM; the logs are in build/arm"
say "unit and property tests passed on 64-bit ARM"
