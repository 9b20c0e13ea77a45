#!/usr/bin/env bash
# Retargets the sample walk to the Unitree G1 and prints the path of the CSV. First installs missing
# packages (tools/setup.sh) and builds the tool in a separate folder. The build prints a line per compiled
# unit, with the compiler's output if one fails. Safe to repeat.
#
#   tools/demo.sh          as soon as possible: without the commands batch, edit, live and robots, and with
#                          less optimisation; the same bytes (preset quick)
#   tools/demo.sh --all    the whole tool, fully optimised (preset demo)
set -euo pipefail

preset=quick
case "${1-}" in
  "") ;;
  --all) preset=demo ;;
  -h | --help)
    # The comment at the top of this file, without the line of the interpreter.
    sed -n '2,/^[^#]/{s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"
    exit 0
    ;;
  *)
    echo "error: unknown argument \"$1\"" >&2
    echo "  hint: tools/demo.sh, or tools/demo.sh --all for all commands" >&2
    exit 2
    ;;
esac

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
cmake --preset "$preset" >"$notes" || { cat -- "$notes" >&2; exit 1; }

echo "3/4 compiling with $jobs processes: a few minutes without a compiler cache"
NINJA_STATUS='3/4 compiling: %f of %t, %e s: ' cmake --build --preset "$preset" --parallel "$jobs" --target retarget_cli

echo "4/4 retargeting data/walk.bvh to the Unitree G1"
csv=$root/build/walk.csv
"build/$preset/tools/retarget/retarget" --bvh data/walk.bvh --robot unitree_g1 -o "$csv"
echo "The trajectory is in $csv"
echo "The tool is in $root/build/$preset/tools/retarget"
if [ "$preset" = quick ]; then
  echo "tools/demo.sh --all builds also the commands batch, edit, live and robots, and a tool that is twice as fast"
fi
