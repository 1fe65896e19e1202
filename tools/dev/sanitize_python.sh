#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: sanitize_python  the tests of the Python package under the address and undefined-behaviour sanitizers

# The tests of the Python package under the address and undefined-behaviour sanitizers of GCC. Python is built without
# them, so their library has to be loaded first; its own memory is left out of the search for leaks. Tests of batches on
# many processes, of programs and next to other packages run no other code of the module.
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

need_for_tests python
tests_environment
preload=''
for name in libasan libstdc++; do preload+=" $(g++ -print-file-name=$name.so)"; done
configure asan -DLIMBER_BUILD_PYTHON=ON "-DPython_EXECUTABLE=$root/build/python/bin/python"
build asan --target limber_python limber_program
(cd -- "$root" && LD_PRELOAD=${preload# } ASAN_OPTIONS=detect_leaks=0 PYTHONMALLOC=malloc PYTHONDONTWRITEBYTECODE=1 \
  UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1} PYTHONPATH=build/asan/python \
  LIMBER_PROGRAM=$root/build/asan/clients/program/limber \
  build/python/bin/python -m pytest --capture=sys --ignore-glob='*/test_'{batch,command_line,examples,migration,notebook}'*') </dev/null
