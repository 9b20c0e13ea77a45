#!/usr/bin/env bash
# Installs missing packages (tools/setup.sh), builds retarget and runs all its tests.
#
#   tools/test.sh [options for ctest]
#
# JOBS sets the number of processes (default: the number of processors), RETARGET_PYTHON the Python interpreter
# (default: tools/setup.sh chooses one). RETARGET_NO_PYTHON=1 omits the Python module, its tests and its
# dependencies. Safe to repeat.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
# A relative MuJoCo_ROOT is relative to the working directory of the user.
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
# CI builds everything once. A unity build is faster then, and tools/demo.sh uses one as well.
cmake --preset release -DRETARGET_BUILD_PYTHON=$module -DRETARGET_PYTHON="$python" \
  ${CI:+-DRETARGET_UNITY_BUILD=ON -DRETARGET_UNITY_FILES=64 -DRETARGET_PRECOMPILE_HEADERS=ON -DRETARGET_QUICK_CODE=ON}
cmake --build --preset release --parallel "$jobs"
# One more than processors: tests of streams wait most of their time.
exec ctest --preset release --parallel "$((jobs + 1))" "$@"
