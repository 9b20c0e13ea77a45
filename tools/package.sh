#!/usr/bin/env bash
# Makes packages of the installed tree, a .deb and a .tar.gz, and tests their contents.
#
#   tools/package.sh [BUILD]     (default: build/package, an optimised build without tests)
#
# Writes them to BUILD/packages, with retarget-robots-unverified.zip, which has the excluded robots for
# `retarget robots install`. Unpacks each package into an empty folder, where the program must run, find its
# data and MuJoCo, install a robot from the ZIP file, and give the same bytes as that of BUILD. Without
# apt-get, only the .tar.gz is made.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=${1:-$root/build/package}
jobs=${JOBS:-$(nproc)}
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT

fail() {
  say "$*"
  exit 1
}

# The package must depend on all linked libraries; CPack reports no error if it could not determine them.
check_debian() {
  local depends library
  depends=$(dpkg-deb --field "$debian" Depends)
  for library in libzip libtinyxml2 libssl libzmq libhiredis; do
    [[ " $depends" =~ \ ${library}[0-9] || " $depends" =~ \ $library-[0-9] ]] ||
      fail "the .deb does not depend on $library: $depends"
  done
  dpkg-deb --field "$debian" Maintainer | grep -qE '^[^<>]+ <[^<> @]+@[^<> @]+>$' ||
    fail "the .deb has no maintainer with an address"
}

say() { printf 'package: %s\n' "$*" >&2; }

generators=TGZ options=(--tool)
if command -v apt-get >/dev/null; then
  generators+=";DEB"
  options+=(--package)
fi
"$root/tools/setup.sh" "${options[@]}"
if [ ! -e "$build/CMakeCache.txt" ]; then
  cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DRETARGET_BUILD_TESTS=OFF \
    -DRETARGET_UNITY_BUILD=ON -DRETARGET_PRECOMPILE_HEADERS=ON
fi
cmake --build "$build" --parallel "$jobs" --target retarget_cli retarget_bash retarget_zsh retarget_fish retarget_man
rm -rf -- "$build/packages"
(cd -- "$build" && cpack -G "$generators")
robots=$build/packages/retarget-robots-unverified.zip
(cd -- "$root" && cmake -E tar cf "$robots" --format=zip robots/unverified)

# The tool must list an excluded robot as not installed, and find it after its installation.
try_left_out() {
  local tool=$1 out=$2.left_out.csv status=0
  export XDG_DATA_HOME=$work/$2.data
  "$tool" "$root/data/walk.bvh" booster_k1 -o "$out" 2>"$2.message" || status=$?
  if [ "$status" != 4 ] || ! grep -qF "booster_k1 is not installed" "$2.message"; then
    fail "$2: exit code $status for a robot that is not installed: $(cat "$2.message")"
  fi
  "$tool" robots install booster_k1 --source "$robots"
  "$tool" "$root/data/walk.bvh" booster_k1 -o "$out"
  cmp "$out" expected.left_out.csv
}

# try NAME FOLDER: tests an installed tree whose bin/ is in FOLDER.
try() {
  local tool=$2/bin/retarget
  (
    cd -- "$work"
    unset RETARGET_DATA_DIR
    "$tool" --version
    "$tool" "$root/data/walk.bvh" unitree_g1 -o "$1.csv"
    if ldd "$tool" | grep -F libmujoco | grep -vF "$work"; then
      fail "$1: takes MuJoCo from outside of the package"
    fi
    cmp "$1.csv" expected.csv
    try_left_out "$tool" "$1"
  )
  say "$1: works from $2"
}

"$build/tools/retarget/retarget" "$root/data/walk.bvh" unitree_g1 -o "$work/expected.csv" --quiet
"$build/tools/retarget/retarget" "$root/data/walk.bvh" booster_k1 -o "$work/expected.left_out.csv" --quiet
archive=$(find "$build/packages" -maxdepth 1 -name '*.tar.gz')
mkdir "$work/archive"
tar -xzf "$archive" -C "$work/archive"
try archive "$(echo "$work"/archive/retarget-*)"
debian=$(find "$build/packages" -maxdepth 1 -name '*.deb')
if [ -n "$debian" ]; then
  dpkg-deb --info "$debian" | grep -E 'Package|Version|Maintainer|Depends|Installed-Size'
  check_debian
  dpkg-deb --extract "$debian" "$work/debian"
  try debian "$work/debian/usr"
  for file in copyright LICENSE THIRD_PARTY_NOTICES; do
    [ -s "$work/debian/usr/share/doc/retarget/$file" ] || fail "the .deb lacks share/doc/retarget/$file"
  done
fi
ls -l "$build/packages"
