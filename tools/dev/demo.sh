#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: demo [args]      build the program and run `limber demo`; its page is build/limber-demo.html; arguments go to the demo
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

need build io program
configure release -DLIMBER_BUILD_TESTS=OFF
build release --target limber_program
"$root/build/release/clients/program/limber" demo --report "$root/build/limber-demo.html" "$@"
