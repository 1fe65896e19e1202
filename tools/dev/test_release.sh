#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: test_release [args]  the unit and allocation tests in the build that users install, without checks
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

need_for_tests
configure release -DLIMBER_BUILD_TESTS=ON
build release --target limber_unit_tests limber_allocation_tests
(cd -- "$root" && ctest --test-dir build/release --output-on-failure --parallel "$jobs" \
  -R '^(unit|allocation)\.' "$@") </dev/null
