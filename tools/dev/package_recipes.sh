#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# The recipes of packaging: Conan's makes a package of these sources and the libraries of the system, and tries it; the
# others are only read by what reads their language.
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"
source "$root/tools/dev/roots.sh"

recipes=$root/packaging
tools=$root/build/recipe_tools/bin
check_versions
need build io recipes
python_environment recipe_tools requirements_recipes.txt
"$tools/python" -c 'import json, sys, rattler_build as rattler
rattler.Stage0Recipe.from_file(sys.argv[1]).render(rattler.VariantConfig({"c_stdlib": ["sysroot"]}))
json.load(open(sys.argv[2]))' "$recipes/conda/recipe.yaml" "$recipes/vcpkg/vcpkg.json"
ruby -c "$recipes/homebrew/limber.rb" >/dev/null
nix-instantiate --parse "$recipes/nix/default.nix" >/dev/null
say "recipes of conda, vcpkg, Homebrew and Nix can be read"
if [[ ${1:-} != --build ]]; then
  export CONAN_HOME=$root/build/conan
  "$tools/conan" profile detect --exist-ok
  "$tools/conan" create "$recipes/conan" --no-remote --build=missing -o 'limber/*:system=True' -s compiler.cppstd=20 \
    -c tools.cmake.cmaketoolchain:generator=Ninja \
    -c "tools.cmake.cmake_layout:test_folder=$root/build/conan_test" </dev/null
  say "Conan makes the package, and a program with it answers"
fi
