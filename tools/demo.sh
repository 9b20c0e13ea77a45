#!/usr/bin/env bash
# Retargets the sample walk to the Unitree G1 and prints the path of the CSV. First installs missing
# packages (tools/setup.sh) and builds the tool in a separate folder (preset demo). Safe to repeat.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
# A relative MuJoCo_ROOT is relative to the working directory of the user.
if [ -n "${MuJoCo_ROOT:-}" ]; then
  MuJoCo_ROOT=$(realpath -- "$MuJoCo_ROOT")
  export MuJoCo_ROOT
fi

"$root/tools/setup.sh" --tool
cd -- "$root"
cmake --preset demo >/dev/null
cmake --build --preset demo --parallel "${JOBS:-$(nproc)}" --target retarget_cli

csv=$root/build/walk.csv
build/demo/tools/retarget/retarget --bvh data/walk.bvh --robot unitree_g1 -o "$csv"
echo "The trajectory is in $csv"
