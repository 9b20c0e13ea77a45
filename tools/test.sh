#!/usr/bin/env bash
# Builds retarget and runs all its tests, after installing what is missing (tools/setup.sh).
#
#   tools/test.sh [options for ctest]
#
# JOBS says how many processes to use (default: the number of processors), RETARGET_PYTHON which Python (default:
# tools/setup.sh chooses). RETARGET_NO_PYTHON=1 leaves the Python module and its tests out, and then nothing is
# fetched for them. Safe to repeat.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
# a relative MuJoCo_ROOT is meant from where the user is
if [ -n "${MuJoCo_ROOT:-}" ]; then
  MuJoCo_ROOT=$(realpath -- "$MuJoCo_ROOT")
  export MuJoCo_ROOT
fi
jobs=${JOBS:-$(nproc)}

module=ON options=(--python)
if [ -n "${RETARGET_NO_PYTHON:-}" ] && [ "$RETARGET_NO_PYTHON" != 0 ]; then module=OFF options=(); fi

"$root/tools/setup.sh" "${options[@]}"
python=$("$root/tools/setup.sh" "${options[@]}" --print-python)
cd -- "$root"
# CI builds everything once: many files at a time are quicker then, and are what tools/demo.sh builds
cmake --preset release -DRETARGET_BUILD_PYTHON=$module -DRETARGET_PYTHON="$python" \
  ${CI:+-DRETARGET_UNITY_BUILD=ON -DRETARGET_UNITY_FILES=64 -DRETARGET_PRECOMPILE_HEADERS=ON}
cmake --build --preset release --parallel "$jobs"
exec ctest --preset release --parallel "$jobs" "$@"
