#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: python [args]    build, type-check and test the Python package alone; arguments go to pytest
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

configure_checked
build checked --target limber_python limber_python_stub limber_program
run_tests checked -R '^python\.' -E '^python\.pytest$'
(cd -- "$root" && PYTHONPATH=build/checked/python PYTHONDONTWRITEBYTECODE=1 \
  LIMBER_PROGRAM=$root/build/checked/clients/program/limber build/python/bin/python -m pytest "$@") </dev/null
