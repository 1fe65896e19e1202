#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

#: package NAME     build what others install, below build/packages, and install it on bare Debian systems with a first
#:                  query: wheels [VERSION...], deb, npm; recipes checks those of packaging; reproducible builds twice and compares
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

names=(wheels deb npm recipes reproducible)
for name in "${names[@]}"; do
  if [[ $name == "${1:-}" ]]; then exec "$root/tools/dev/package_$name.sh" "${@:2}"; fi
done
die "usage: ./dev package NAME [--build]; names: ${names[*]}; --build leaves out what installs and tries"
