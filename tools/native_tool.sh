#!/usr/bin/env bash
# Prints the command line tool of a build of this machine; builds the preset demo if there is none.
set -euo pipefail

cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
for folder in release demo; do
  if [ -x "build/$folder/tools/retarget/retarget" ]; then
    echo "build/$folder/tools/retarget/retarget"
    exit 0
  fi
done
cmake --preset demo >&2
cmake --build --preset demo --parallel "${JOBS:-$(nproc)}" >&2
echo build/demo/tools/retarget/retarget
