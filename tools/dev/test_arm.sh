#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: test_arm         the unit and property tests for 64-bit ARM, cross-compiled and run on an emulator; long

# The emulator is slow, so the tests draw fewer cases.
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

need_for_tests arm
if ! dpkg --print-foreign-architectures | grep -qx arm64; then
  ((EUID == 0)) || die "as root: dpkg --add-architecture arm64"
  dpkg --add-architecture arm64
fi
need arm_libraries
configure arm -DLIMBER_BUILD_PROGRAM=OFF -DLIMBER_BUILD_IO=ON
build arm --target limber_unit_tests limber_property_tests
export RC_PARAMS=max_success=100 LIMBER_UPDATE_SEQUENCES=100 LIMBER_ORACLE_PAIRS=10000
emulator=(qemu-aarch64)
run_programs arm unit property || die "tests failed on 64-bit ARM"
say "unit and property tests passed on 64-bit ARM"
