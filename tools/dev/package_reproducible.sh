#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# Builds Debian's packages (library and program), wheels and the JavaScript package from two copies of the sources in
# folders of different names, without ccache, and compares the bits. Long: everything is compiled twice.
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"
source "$root/tools/dev/roots.sh"

names=(deb wheels npm)
if (($#)); then names=("$@"); fi
sums() { (cd -- "$1/build/packages" && find . -maxdepth 2 -name '*.deb' -o -maxdepth 2 -name '*.whl' -o \
  -maxdepth 2 -name '*.tar.gz' -o -maxdepth 2 -name '*.tgz' | sort | xargs sha256sum); }

copies=("$root/build/same/one" "$root/build/same/another/copy")
rm -rf -- "$root/build/same"
export CCACHE_DISABLE=1
for copy in "${copies[@]}"; do
  copy_sources "$copy"
  for name in "${names[@]}"; do "$copy/dev" package "$name" --build; done
  sums "$copy" >"$root/build/same/$(basename -- "$copy").sums"
done
diff "$root/build/same/one.sums" "$root/build/same/copy.sums" || die "two builds differ, see above"
cat -- "$root/build/same/one.sums"
say "two builds gave the same $(wc -l <"$root/build/same/one.sums") files, to the bit"
