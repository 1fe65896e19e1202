#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: mutants [name...]  break the code in many places, one at a time: the tests must notice each; a name may be a pattern
#: mutants --random N [file...] [--seed S]  break N places drawn at random, in all sources or in those that fit a pattern;
#:                  list those that no test notices, which a person has to judge; long
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

need_for_tests mutants
python3 "$root/tools/mutants.py" --jobs "$jobs" "$@"
