#!/usr/bin/env bash
# Builds retarget and runs all its tests, after installing what is missing (tools/setup.sh).
#
#   tools/test.sh [options for ctest]
#
# JOBS says how many processes to use (default: the number of processors). Safe to repeat.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
# a relative MuJoCo_ROOT is meant from where the user is
if [ -n "${MuJoCo_ROOT:-}" ]; then
  MuJoCo_ROOT=$(realpath -- "$MuJoCo_ROOT")
  export MuJoCo_ROOT
fi
jobs=${JOBS:-$(nproc)}

"$root/tools/setup.sh" --python
cd -- "$root"
# CI builds everything once: several files at a time are quicker then
cmake --preset release -DRETARGET_BUILD_PYTHON=ON ${CI:+-DRETARGET_UNITY_BUILD=ON}
cmake --build --preset release --parallel "$jobs"
exec ctest --preset release --parallel "$jobs" "$@"
