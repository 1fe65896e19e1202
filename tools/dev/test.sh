#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: test [args]      build with checks and run every test; arguments go to ctest (e.g. -R distance)
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

expect_minutes 11
configure_checked
build checked
run_tests checked "$@"
