#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: docs             the site in build/docs/site: pages, the interfaces of C++ and Python; fails where a link leads nowhere

# The Python interface comes from the package as the tests build it.
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

configure_checked
need docs
build checked --target limber_python_stub
python_environment docs_tools ../docs/site/requirements.txt
PYTHONPATH=$root/build/checked/python PYTHONDONTWRITEBYTECODE=1 "$root/build/docs_tools/bin/python" \
  "$root/tools/build_docs.py" "$root/build/docs" </dev/null
