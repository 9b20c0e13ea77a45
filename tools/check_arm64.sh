#!/usr/bin/env bash
# Checks that every source of the library and the tool compiles for ARM64 Linux.
#
#   tools/check_arm64.sh
#
# Needs the cross compiler aarch64-linux-gnu-g++ (Debian and Ubuntu: g++-aarch64-linux-gnu), which
# tools/setup.sh does not install; without it, prints a message and exits with 0. Nothing is linked: the
# headers are the same for every processor, but the MuJoCo library is not. JOBS: the number of processes.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
jobs=${JOBS:-$(nproc)}
folder=$root/build/arm64
compiler=aarch64-linux-gnu-g++

if ! command -v "$compiler" >/dev/null; then
  echo "check_arm64: left out: there is no $compiler (Debian: g++-aarch64-linux-gnu)" >&2
  exit 0
fi

cmake -S "$root" -B "$folder" -G Ninja -DCMAKE_SYSTEM_NAME=Linux \
  -DCMAKE_SYSTEM_PROCESSOR=aarch64 -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release \
  -DRETARGET_BUILD_TESTS=OFF -DRETARGET_BUILD_BENCH=OFF -DRETARGET_INSTALL=OFF \
  -DRETARGET_CCACHE=OFF -DRETARGET_WERROR=ON >/dev/null
cmake --build "$folder" --target retarget_build_facts >/dev/null

# Prints the commands of the build, reduced to syntax checks, as "file<NUL>command<NUL>".
commands() {
  python3 - "$folder/compile_commands.json" <<'CODE'
import json, sys
for entry in json.load(open(sys.argv[1], encoding="utf-8")):
    sys.stdout.write(entry["file"] + "\0" + entry["command"] + " -fsyntax-only" + "\0")
CODE
}

cd -- "$folder"
# shellcheck disable=SC2016  # the inner shell's own words
commands | xargs -0 -n 2 -P "$jobs" bash -c 'eval "$2" || { echo "check_arm64: $1" >&2; exit 255; }' -
echo "check_arm64: $(grep -c '"file"' compile_commands.json) sources compile for ARM64" >&2
