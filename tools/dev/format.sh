#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: format           apply clang-format to every source
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

need format
cd -- "$root"
cpp_files | xargs -0 clang-format -i
