#!/usr/bin/env bash
# Retargets the sample walk to the Unitree G1 and prints the path of the CSV. First installs missing
# packages (tools/setup.sh) and builds the tool in a separate folder (preset demo). Says what it does: the
# build prints a line per compiled unit, with the compiler's output if one fails. Safe to repeat.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
# A relative MuJoCo_ROOT is relative to the working directory of the user.
if [ -n "${MuJoCo_ROOT:-}" ]; then
  MuJoCo_ROOT=$(realpath -- "$MuJoCo_ROOT")
  export MuJoCo_ROOT
fi

echo "1/4 packages: looking for missing ones"
"$root/tools/setup.sh" --tool

cd -- "$root"
jobs=${JOBS:-$(nproc)}
echo "2/4 configuring"
# CMake's notes matter only if it fails.
notes=$(mktemp)
trap 'rm -f -- "$notes"' EXIT
cmake --preset demo >"$notes" || { cat -- "$notes" >&2; exit 1; }

echo "3/4 compiling with $jobs processes: a few minutes without a compiler cache"
NINJA_STATUS='3/4 compiling: %f of %t, %e s: ' cmake --build --preset demo --parallel "$jobs" --target retarget_cli

echo "4/4 retargeting data/walk.bvh to the Unitree G1"
csv=$root/build/walk.csv
build/demo/tools/retarget/retarget --bvh data/walk.bvh --robot unitree_g1 -o "$csv"
echo "The trajectory is in $csv"
