#!/usr/bin/env bash
# Retargets a folder of BVH files into a folder of CSV files, several at a time.
#
#   batch_retarget.sh [options] IN_FOLDER OUT_FOLDER [-- options for retarget]
#
#   --robot NAME     the robot (default: unitree_g1)
#   -j, --jobs N     how many files at a time (default: the number of processors)
#   --retarget FILE  the retarget program (default: $RETARGET_TOOL, else the one beside this
#                    script, else the one in build/, else the one in PATH)
#   -q, --quiet      no line for each file, only failures and the count
#
# Sub-folders are mirrored: IN/a/b.bvh becomes OUT/a/b.csv. A file that fails does not stop the
# others; what the program said about it is printed, and all failures are listed at the end.
# Exit codes: 0 all done, 1 some failed, 2 wrong call, 3 no BVH file to read, 130 interrupted.
set -euo pipefail

here=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)

say() { printf '%s\n' "$*" >&2; }

fail() {
  say "batch_retarget: error: $2"
  exit "$1"
}

# --- one file (xargs runs this script with --one) ----------------------------------------------

# retarget_one LENGTH COMMAND... NUMBER INPUT OUTPUT SHOWN, the command being LENGTH words long;
# prints `NUMBER STATUS` in one short write, so that lines of several processes never mix
retarget_one() {
  local command=("${@:2:$1}") text status=0
  shift $(($1 + 1))
  local number=$1 input=$2 output=$3 shown=$4
  mkdir -p -- "$(dirname -- "$output")"
  text=$("${command[@]}" --bvh "$input" -o "$output" 2>&1 </dev/null) || status=$?
  if [ "$status" -ne 0 ]; then
    printf 'failed (exit code %d): %s\n%s\n' "$status" "$shown" "$text" >&2
  elif [ -z "${BATCH_RETARGET_QUIET:-}" ]; then
    printf 'done: %s\n' "$shown" >&2
  fi
  printf '%d %d\n' "$number" "$status"
  # 255 makes xargs stop: the user interrupted the program
  [ "$status" -ne 130 ] || exit 255
}

if [ "${1:-}" = --one ]; then
  shift
  retarget_one "$@"
  exit 0
fi

# --- the call ------------------------------------------------------------------------------------

robot=unitree_g1
jobs=$(nproc 2>/dev/null || echo 1)
program=${RETARGET_TOOL:-}
folders=()
extra=()

need_value() { [ $# -ge 2 ] || fail 2 "$1 needs a value"; }

while [ $# -gt 0 ]; do
  case $1 in
    --robot) need_value "$@"; robot=$2; shift ;;
    --robot=*) robot=${1#*=} ;;
    -j | --jobs) need_value "$@"; jobs=$2; shift ;;
    --jobs=*) jobs=${1#*=} ;;
    --retarget) need_value "$@"; program=$2; shift ;;
    --retarget=*) program=${1#*=} ;;
    -q | --quiet) export BATCH_RETARGET_QUIET=1 ;;
    -h | --help)
      sed -n '2,/^set /s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
      exit 0
      ;;
    --) shift; extra=("$@"); break ;;
    -?*) fail 2 "unknown option $1 (options for retarget go after --)" ;;
    *) folders+=("$1") ;;
  esac
  shift
done

[ "${#folders[@]}" -eq 2 ] || fail 2 "give two folders: IN_FOLDER OUT_FOLDER (see --help)"
[[ $jobs =~ ^[1-9][0-9]*$ ]] || fail 2 "--jobs must be a whole number from 1 on, not \"$jobs\""
in=${folders[0]}
out=${folders[1]}
[ -d "$in" ] || fail 3 "the input folder \"$in\" does not exist"
[ -e "$out" ] && [ ! -d "$out" ] && fail 2 "the output \"$out\" is not a folder"

if [ -z "$program" ]; then
  for candidate in "$here/retarget" "$here"/../build/release/tools/retarget/retarget \
    "$here"/../build/*/tools/retarget/retarget "$(command -v retarget || true)"; do
    if [ -f "$candidate" ] && [ -x "$candidate" ]; then
      program=$candidate
      break
    fi
  done
  [ -n "$program" ] || fail 2 "no retarget program found; build it or name it with --retarget FILE"
fi
command -v -- "$program" >/dev/null || fail 2 "\"$program\" is not a program that can be run"

# --- the work ------------------------------------------------------------------------------------

mapfile -d '' -t files < <(cd -- "$in" && find -L . -type f -iname '*.bvh' -print0 | sort -z)
[ "${#files[@]}" -gt 0 ] || fail 3 "no BVH file in \"$in\""
# a folder whose name begins with a dash must not look like an option
[[ $in == -* ]] && in=./$in
[[ $out == -* ]] && out=./$out

# one record a file: number, input, output, name to show; all ended by a zero byte
records() {
  local i name output
  declare -A taken=()
  for i in "${!files[@]}"; do
    name=${files[i]#./}
    output=$out/${name%.*}.csv
    # two inputs that differ in the case of .bvh alone: the second keeps its ending
    [ -z "${taken[$output]:-}" ] || output=$out/$name.csv
    taken[$output]=1
    printf '%s\0' "$i" "$in/$name" "$output" "$name"
  done
}

# counts the `NUMBER STATUS` lines, lists the failures; the files without a line were not reached
report() {
  local number status failed=() reached=0
  while read -r number status; do
    reached=$((reached + 1))
    [ "$status" -eq 0 ] || failed+=("$number")
  done
  local text="$((reached - ${#failed[@]})) of ${#files[@]} files done, ${#failed[@]} failed"
  [ "$reached" -eq "${#files[@]}" ] || text+=", $((${#files[@]} - reached)) not tried"
  say "$text"
  if [ "${#failed[@]}" -gt 0 ]; then
    # in the order of the names, not of the processes
    for number in $(printf '%s\n' "${failed[@]}" | sort -n); do
      say "  failed: ${files[number]#./}"
    done
  fi
  [ "$reached" -eq "${#files[@]}" ] && [ "${#failed[@]}" -eq 0 ]
}

run_all() {
  local command=("$program" --robot "$robot" "${extra[@]}")
  records | xargs -0 -n 4 -P "$jobs" \
    bash "$here/$(basename -- "${BASH_SOURCE[0]}")" --one "${#command[@]}" "${command[@]}"
}

# ends every process of the work and waits until they are gone
# shellcheck disable=SC2317  # reached by trap
stop() {
  trap '' INT TERM HUP
  kill -TERM -- "-$group" 2>/dev/null || true
  for _ in {1..50}; do
    kill -0 -- "-$group" 2>/dev/null || break
    sleep 0.1
  done
  kill -KILL -- "-$group" 2>/dev/null || true
  say "batch_retarget: interrupted"
  exit 130
}

# in a process group of its own, which an interrupt can end as a whole
set -m
{ run_all || true; } | report &
group=$(jobs -p %+)
trap stop INT TERM HUP
status=0
wait %+ || status=$?
exit "$status"
