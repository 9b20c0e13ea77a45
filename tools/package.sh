#!/usr/bin/env bash
# Makes packages of the installed tree, a .deb and a .tar.gz, and tries what is in them.
#
#   tools/package.sh [BUILD]     (default: build/package, an optimised build without tests)
#
# They come into BUILD/packages. Each is unpacked into an empty folder, where the program must run, find
# its data and MuJoCo, and give the bytes of BUILD's.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=${1:-$root/build/package}
jobs=${JOBS:-$(nproc)}
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT

say() { printf 'package: %s\n' "$*" >&2; }

"$root/tools/setup.sh" --tool
if [ ! -e "$build/CMakeCache.txt" ]; then
  cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DRETARGET_BUILD_TESTS=OFF \
    -DRETARGET_UNITY_BUILD=ON -DRETARGET_PRECOMPILE_HEADERS=ON
fi
cmake --build "$build" --parallel "$jobs" --target retarget_cli retarget_bash retarget_zsh retarget_fish retarget_man
rm -rf -- "$build/packages"
(cd -- "$build" && cpack)

# try NAME FOLDER: an installed tree's bin/ is in FOLDER
try() {
  local tool=$2/bin/retarget
  (
    cd -- "$work"
    unset RETARGET_DATA_DIR
    "$tool" --version
    "$tool" "$root/data/walk.bvh" unitree_g1 -o "$1.csv"
    if ldd "$tool" | grep -F libmujoco | grep -vF "$work"; then
      say "$1: takes MuJoCo from outside of the package"
      exit 1
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
if command -v dpkg-deb >/dev/null; then
  dpkg-deb --info "$debian" | grep -E 'Package|Version|Depends|Installed-Size'
  dpkg-deb --extract "$debian" "$work/debian"
  try debian "$work/debian/usr"
fi
ls -l "$build/packages"
