#!/usr/bin/env bash
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# check_installed.sh CHECK PREFIX LIBDIR: one check of what `cmake --install` has brought below PREFIX, whose libraries
# are in PREFIX/LIBDIR. CXX and CXXFLAGS are those the library was built with; sources are in LIMBER_SOURCE_DIR.
set -euo pipefail

prefix=$2
libraries=$prefix/$3
here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)
program=$prefix/bin/limber

die() { printf '%s\n' "$*" >&2; exit 1; }

# expect WHAT WANTED GOT
expect() { [[ $2 == "$3" ]] || die "$1: '$2' was expected, but it is '$3'"; }

# Lower-case words at the start of indented entries.
verbs() { "$program" --help | sed -nE 's/^  ([a-z][a-z-]*) .*/\1/p'; }

# Every public header, and all else that is not empty.
check_files() {
  local file
  for file in "$LIMBER_SOURCE_DIR"/include/limber/*.h; do
    cmp -- "$file" "$prefix/include/limber/${file##*/}"
  done
  for file in limber limber_io; do
    [[ -s $libraries/lib$file.a || -s $libraries/lib$file.so ]] || die "$libraries has no library $file"
  done
  for file in "$libraries"/pkgconfig/{limber,limber-io}.pc "$prefix/share/doc/limber/LICENSE" \
    "$libraries"/cmake/limber/limber{Config,ConfigVersion,Targets,IoTargets}.cmake; do
    [[ -s $file ]] || die "$file is missing or empty"
  done
  local owner owners=('Niels Lohmann' 'University of Cincinnati' 'Highway Project' 'Intel Corporation')
  if [[ -e $program ]]; then owners+=('three.js authors'); fi
  for owner in "${owners[@]}"; do
    grep -q "$owner" "$prefix/share/doc/limber/NOTICES.txt" || die "NOTICES.txt has no license of $owner"
  done
  [[ ! -e $program ]] || expect "the program's version" "limber $(pkg-config_of --modversion limber)" "$("$program" --version)"
}

# The manual page is sound for its formatter. It has the sections of manual pages, every verb with its usage and every
# option, and examples as help shows them.
check_manual() {
  local page=$prefix/share/man/man1/limber.1 text unindented warnings section verb option line
  warnings=$(man --warnings -l "$page" 2>&1 >/dev/null; groff -man -Tutf8 -ww -z "$page" 2>&1)
  [[ -z $warnings ]] || die "$warnings"
  text=$(MANWIDTH=200 man -l "$page" | col -bx)
  unindented=$(MANWIDTH=200 man -l "$page" | col -bx | sed 's/^ *//')
  for section in NAME SYNOPSIS DESCRIPTION; do
    grep -qx "$section" <<<"$text" || die "the manual page has no section $section"
  done
  while read -r line; do
    grep -qxF -- "$line" <<<"$unindented" || die "the manual page has not the example: $line"
  done < <("$program" --help | sed -n '1,/^Examples:$/d; s/^  //p')
  for verb in $(verbs); do
    grep -qF "limber $verb [OPTIONS]" <<<"$text" || die "the manual page has no usage of $verb"
    grep -qx "limber $verb" <<<"$text" || die "the manual page has no verb $verb"
    for option in $("$program" "$verb" --help | grep -oE '^  (-[a-z], *)?--[a-z-]+'); do
      grep -qE -- "^ +${option//[ ]/}( |\$)" <<<"$text" || die "the manual page has no option $option"
    done
  done
}

# completions WORD...: what bash completes the last word to.
completions() {
  (
    # shellcheck source=/dev/null
    . "$prefix/share/bash-completion/completions/limber"
    COMP_WORDS=("$program" "$@") COMP_CWORD=$#
    _limber
    printf '%s\n' "${COMPREPLY[@]}" | sort | xargs
  )
}

check_completion() {
  expect 'all verbs' "$( (verbs; echo --help; echo --version; echo -h; echo -v) | sort | xargs)" "$(completions '')"
  expect 'verbs on dist' distance "$(completions dist)"
  expect 'options on --pose' '--pose-a --pose-b' "$(completions distance a.obj b.obj --pose)"
  expect 'files' '' "$(completions info '')"
  [[ -s $prefix/share/zsh/site-functions/_limber ]] || die 'no completion for zsh'
  [[ -s $prefix/share/fish/vendor_completions.d/limber.fish ]] || die 'no completion for fish'
}

pkg-config_of() { PKG_CONFIG_PATH=$libraries/pkgconfig pkg-config "$@"; }

# Compiled by hand, with what pkg-config says and nothing else, from a moved copy.
check_pkg_config() {
  local flags
  read -ra flags <<<"${CXXFLAGS:-}"
  cat >"$scratch/main.cpp" <<'CPP'
#include <limber/limber.h>
int main() {
  const limber::Mesh mesh = limber::Mesh::create({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}).value();
  const limber::Model model(mesh);
  return limber::distance({model}, {model, {{}, {0, 0, 3}}}).upper == 3 ? 0 : 1;
}
CPP
  cp -a -- "$prefix" "$scratch/moved"
  libraries=$scratch/moved/${libraries#"$prefix"/}
  # shellcheck disable=SC2046 # several words
  "$CXX" "${flags[@]}" "$scratch/main.cpp" $(pkg-config_of --cflags --libs limber) -o "$scratch/main"
  "$scratch/main"
  [[ $(pkg-config_of --libs limber-io) == *-llimber_io*-llimber\ * ]] || die "$(pkg-config_of --libs limber-io)"
}

# find_package(limber COMPONENTS io) against an installation without limber::io says why it fails.
check_missing_component() {
  local component message
  cp -a -- "$prefix" "$scratch/without_io"
  rm -- "$scratch/without_io/${libraries#"$prefix"/}"/cmake/limber/limberIoTargets*.cmake
  for component in io telepathy; do
    if message=$(cmake -G Ninja -S "$here/seeker" -B "$scratch/build" "-DCOMPONENT=$component" \
      "-DCMAKE_PREFIX_PATH=$scratch/without_io" 2>&1); then
      die "component $component was found"
    fi
    case $component in
      io) [[ $message == *'was built without limber::io'* ]] || die "$message" ;;
      *) [[ $message == *"limber has no component 'telepathy'"* ]] || die "$message" ;;
    esac
  done
  cmake -G Ninja -S "$here/seeker" -B "$scratch/build" "-DCMAKE_PREFIX_PATH=$scratch/without_io" -DCOMPONENT= >/dev/null
}

# The shared libraries show what the lists in exports say, with the types of arguments, and nothing else.
check_exports() {
  local library
  for library in limber limber_io; do
    [[ $(readelf --wide --version-info "$libraries/lib$library.so") == *'Name: LIMBER_'* ]] ||
      die "lib$library.so gives its symbols no version"
    nm -D --defined-only --without-symbol-versions -C "$libraries/lib$library.so" |
      sed -E '/ A LIMBER_/d; s/^[0-9a-f]+ . //' | LC_ALL=C sort -u |
      diff "$here/exports/$library.txt" - ||
      die "lib$library.so does not show (<), or shows (>), what tests/package/exports/$library.txt has"
  done
}

# Shared libraries name no folders to search. The program names that of the libraries, unless all is installed where the
# system looks anyway.
check_run_paths() {
  local library install_prefix found
  for library in limber limber_io; do
    [[ $(readelf -d "$libraries/lib$library.so") != *PATH* ]] || die "lib$library.so names folders to search"
  done
  for install_prefix in /usr /opt/limber; do
    cmake -G Ninja -S "$LIMBER_SOURCE_DIR" -B "$scratch/build" -DBUILD_SHARED_LIBS=ON -DLIMBER_BUILD_TESTS=OFF \
      "-DCMAKE_INSTALL_PREFIX=$install_prefix" -DCMAKE_INSTALL_LIBDIR=lib >/dev/null
    found=$(grep -rhoE 'NEW_RPATH "[^"]+"' "$scratch/build" --include=cmake_install.cmake || true)
    case $install_prefix in
      /usr) expect 'what is in /usr searches' '' "$found" ;;
      *) expect "what is in $install_prefix searches" "NEW_RPATH \"\\\$ORIGIN/../lib\"" "$found" ;;
    esac
  done
}

scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
"check_$1"
