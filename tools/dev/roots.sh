# shellcheck shell=bash
# shellcheck disable=SC2034
# SPDX-FileCopyrightText: The limber authors
# SPDX-License-Identifier: BSD-3-Clause

# What the scripts of packages share: where they put what they make, sources to make it from, and bare systems to try it
# on.
source "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

artefacts=$root/build/packages
version=$(sed -n 's/^project(limber VERSION \([0-9.]*\).*/\1/p' "$root/CMakeLists.txt")

# check_versions: what names the version names that of CMakeLists.txt, which sees to limber/version.h itself.
check_versions() {
  local file
  for file in CITATION.cff clients/javascript/limber3d/package.json \
    packaging/{conda/recipe.yaml,vcpkg/vcpkg.json,conan/conanfile.py,homebrew/limber.rb,nix/default.nix,debian/changelog}; do
    grep -qF "$version" "$root/$file" || die "$file is not of version $version"
  done
  grep -q "^## .*\b${version%.0}\b" "$root/CHANGELOG.md" || die "CHANGELOG.md has no heading for version $version"
}

# Two builds give the same bits: times of files are that of the last commit, and no file names the folder of the build.
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -C "$root" log -1 --format=%ct 2>/dev/null || stat -c %Y "$root/CHANGELOG.md")}
export SOURCE_DATE_EPOCH
same_paths=-ffile-prefix-map=$root=.

# copy_sources FOLDER: the files of this checkout that git knows or would take; without git, all but build.
copy_sources() {
  mkdir -p -- "$1"
  # A copy below build lies in a checkout, but is none.
  if [[ $(git -C "$root" rev-parse --show-toplevel 2>/dev/null) == "$root" ]]; then
    (cd -- "$root" && git ls-files -z --cached --others --exclude-standard | tar --null -T - -cf -) | tar -C "$1" -xf -
  else
    tar -C "$root" --exclude=./build -cf - . | tar -C "$1" -xf -
  fi
}

# pack FILE FOLDER [tar arguments]: an archive of the folder by its last name, with the same bits at any time and place.
pack() {
  tar -C "$(dirname -- "$2")" --sort=name --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner \
    --mode=go=rX,u+rw,a-s --format=gnu "${@:3}" -cf - "$(basename -- "$2")" | gzip -n9 >"$1"
}

# debian_sources NAME...: the sources of these Debian packages, as their authors published them, in build/sources/NAME.
debian_sources() {
  local name folder=$root/build/sources options
  mkdir -p -- "$folder/parts" "$folder/lists/partial"
  sed -n 's/^deb /deb-src /p' /etc/apt/sources.list >"$folder/parts/debian.list" 2>/dev/null || true
  sed 's/^Types:.*/Types: deb-src/' /etc/apt/sources.list.d/debian.sources >"$folder/parts/debian.sources" 2>/dev/null || true
  options=(-qq -o Dir::Etc::SourceList=/dev/null -o "Dir::Etc::SourceParts=$folder/parts"
    -o "Dir::State::Lists=$folder/lists" -o APT::Sandbox::User=root)
  for name in "$@"; do
    if [[ -d $folder/$name ]]; then continue; fi
    [[ -n $(ls "$folder/lists/"*Sources* 2>/dev/null) ]] || apt-get "${options[@]}" update
    say "fetching the sources of Debian's $name"
    rm -rf -- "$folder/new"
    mkdir -- "$folder/new"
    (cd -- "$folder/new" && apt-get "${options[@]}" source --download-only "$name" && tar -xf ./*.orig.tar.*)
    mv -- "$folder"/new/*/ "$folder/$name"
  done
}

# bare_root SUITE NAME [PACKAGE...]: a minimal Debian of that suite in build/roots/NAME, fresh but for these packages. It
# has the machine's name servers and certificates, and nothing else of it.
bare_root() {
  local folder=$root/build/roots/$2 base=$root/build/roots/$1.tar
  ((EUID == 0)) || die "a bare root can be made by root alone"
  need roots
  rm -rf -- "$folder"
  mkdir -p -- "$folder"
  if [[ ! -s $base ]]; then
    say "making a bare Debian $1"
    debootstrap --variant=minbase "$1" "$folder" >"$root/build/roots/$1.log" 2>&1 || die "see build/roots/$1.log"
    tar -C "$folder" -cf "$base.new" .
    mv -- "$base.new" "$base"
  else
    tar -C "$folder" -xf "$base"
  fi
  cp -- /etc/resolv.conf "$folder/etc/"
  mkdir -p -- "$folder/packages"
  cp -- /etc/ssl/certs/ca-certificates.crt "$folder/etc/machine.crt"
  # Debian's own next release may be late with its lists.
  echo 'Acquire::Check-Valid-Until "false"; APT::Install-Recommends "false"; Acquire::Retries "3";' \
    >"$folder/etc/apt/apt.conf.d/90limber"
  in_root "$2" 'apt-get -qq update' >/dev/null
  if (($# > 2)); then in_root "$2" "apt-get -qq install -y ${*:3} >/tmp/log 2>&1 || { tail /tmp/log; exit 1; }"; fi
}

# in_root NAME SCRIPT: runs the script in the folder /root of build/roots/NAME; it ends with the first command that fails.
in_root() {
  env -i PATH=/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin HOME=/root LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
    PIP_CERT=/etc/machine.crt PIP_DISABLE_PIP_VERSION_CHECK=1 \
    NODE_EXTRA_CA_CERTS=/etc/machine.crt NPM_CONFIG_UPDATE_NOTIFIER=false \
    unshare --mount --pid --fork chroot "$root/build/roots/$1" \
    bash -c "mount -t proc proc /proc; cd /root; set -euo pipefail; $2" </dev/null
}

# expect_answer NAME SCRIPT TEXT...: what the script prints in the root has these texts in it; prints the lines that do.
expect_answer() {
  local found text
  found=$(in_root "$1" "$2" 2>&1) || die "in build/roots/$1: $(tail -n 30 <<<"$found")"
  for text in "${@:3}"; do
    grep -F -- "$text" <<<"$found" || die "build/roots/$1 gave no '$text': $(tail -n 20 <<<"$found")"
  done
}
