#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: wheel            build the package as others install it: a wheel with all libraries, tested where it alone is installed

# The wheel gets the tag of the oldest system that has what this one links, and a copy of the libraries that such systems
# lack. It is tested in a virtual environment of its own, from a folder that has nothing of the sources but the tests.
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

folder=$root/build/wheels
need build io python
python_environment wheel_tools requirements_wheel.txt
rm -rf -- "$folder" "$root/build/wheel_test"
mkdir -p -- "$folder/tests"
(cd -- "$root" && CMAKE_BUILD_PARALLEL_LEVEL=$jobs build/wheel_tools/bin/python -m build --outdir "$folder") \
  </dev/null >"$folder/log" 2>&1 || { tail -n 40 -- "$folder/log" >&2 && die "the wheel could not be built"; }
PATH=$root/build/wheel_tools/bin:$PATH "$root/build/wheel_tools/bin/auditwheel" repair --wheel-dir "$folder/repaired" \
  "$folder"/*.whl </dev/null
found=$(python3 -m zipfile -l "$folder"/repaired/*.whl)
for license in LICENSE {Apache-2.0,libhwy-dev,libtbb-dev,nanobind,nlohmann-json3-dev,robin_map}.txt; do
  [[ $found == *"licenses/$license "* ]] || die "the wheel has not licenses/$license"
done
python3 -m venv "$root/build/wheel_test"
place=$root/build/wheel_test/bin/python
"$place" -m pip install -q "$folder"/repaired/*.whl -r "$root/python/requirements_test.txt" </dev/null
cp -- "$root"/python/tests/*.py "$folder/tests"
(cd -- "$folder" && PYTHONDONTWRITEBYTECODE=1 "$place" -m pytest -q -p no:cacheprovider tests) </dev/null
"$root/build/wheel_test/bin/limber3d" --version </dev/null
say "the wheel is $(cd -- "$folder/repaired" && echo *.whl) in $folder/repaired"
