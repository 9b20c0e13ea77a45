#!/usr/bin/env bash
# Makes packages of the installed tree, a .deb and a .tar.gz, and tries what is in them.
#
#   tools/package.sh [BUILD]     (default: build/package, an optimised build without tests)
#
# They come into BUILD/packages. Each is unpacked into an empty folder, where the program must run, find
# its data and MuJoCo, and give the bytes of BUILD's. Without apt-get only the .tar.gz is made.
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

# what the program is linked with is what the package depends on: CPack says nothing where it could not look
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

# try NAME FOLDER: an installed tree's bin/ is in FOLDER
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
  )
  say "$1: works from $2"
}

"$build/tools/retarget/retarget" "$root/data/walk.bvh" unitree_g1 -o "$work/expected.csv" --quiet
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
