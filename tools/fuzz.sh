#!/usr/bin/env bash
# Fuzzes every reader, and the conversion from a BVH to a robot's CSV, under the address and undefined
# behaviour sanitizers. docs/security.md lists the targets.
#
#   tools/fuzz.sh MINUTES [TARGET...]        MINUTES for all targets together; bvh, npz, csv, ...
#   FUZZ_SECONDS=10 tools/fuzz.sh            ten seconds per target, from the committed inputs
#   tools/fuzz.sh threads                    no fuzzing: batch, fit, live, pipeline and stream under the thread sanitizer
#
# Builds with clang into build/fuzz. Interesting inputs are kept in build/fuzz/corpus, where the next run
# continues. Inputs that break a reader are written to build/fuzz/findings, and the exit code is 1.
# Runs with FUZZ_SECONDS always begin from tests/fuzz/seeds and tests/fuzz/regressions, with the same random
# seed. Needs tools/setup.sh --dev. JOBS: the number of processes. CXX: another clang++.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
cd -- "$root"
jobs=${JOBS:-$(nproc)}
build=build/fuzz

fail() {
  echo "fuzz: $1" >&2
  exit 2
}

# Batches fork, a run of a clip has up to three threads, and the fit distributes its windows over threads.
check_threads() {
  local rooms=(batch fit live pipeline stream)
  cmake --preset tsan
  cmake --build --preset tsan --parallel "$jobs" --target retarget_cli "${rooms[@]/%/_test}"
  # Random streams do not start threads; a tenth of them suffices here.
  RETARGET_LIVE_STREAMS=${RETARGET_LIVE_STREAMS:-1000} ctest --preset tsan --parallel "$jobs" \
    -R "^($(IFS='|'; echo "${rooms[*]}"))\.|^cli\.batch(_|$)|^cli\.live(_follow|_outputs|_senders)?$"
}

# Collects files of one kind from the repository, in addition to tests/fuzz/seeds and tests/fuzz/regressions.
other_seeds() {
  case $1 in
    bvh) find tests/bvh/conformance -name '*.bvh' ;;
    csv | motion | motion_table) find tests/golden -name '*.csv' ;;
    ik_config) find configs -maxdepth 1 -name '*.json' ;;
    skeleton_profile) find configs/skeletons -name '*.json' ;;
    gates) find configs/quality -name '*.json' ;;
    profile) find robots -name robot.json ;;
    model) find robots -name model.xml ;;
  esac
}

# Use only the beginning of large files, with which a fuzzer is slow.
take_other_seeds() {
  local folder=$build/seeds/$1 file number=0
  rm -rf -- "$folder"
  mkdir -p "$folder"
  while IFS= read -r file; do
    number=$((number + 1))
    case $file in
      *.csv) head -n 3 "$file" >"$folder/$number" ;;
      *) cp "$file" "$folder/$number" ;;
    esac
  done < <(other_seeds "$1" | sort)
}

# fuzz TARGET SECONDS: succeeds if nothing broke; writes messages to a log.
fuzz() {
  local target=$1 folder=$build/corpus/$1 options
  options=(-max_total_time="$2" -timeout=20 -rss_limit_mb=2048 -max_len=65536 -verbosity=1
    -print_final_stats=1 -artifact_prefix="$build/findings/$target-")
  if [ -e "tests/fuzz/dictionaries/$target.dict" ]; then
    options+=(-dict="tests/fuzz/dictionaries/$target.dict")
  fi
  if $from_kept; then
    folder=$build/fresh/$target
    rm -rf -- "$folder"
    options+=(-seed=1)
  fi
  local folders=("$folder" "$build/seeds/$target" "tests/fuzz/seeds/$target")
  if [ -d "tests/fuzz/regressions/$target" ]; then folders+=("tests/fuzz/regressions/$target"); fi
  mkdir -p "$folder"
  take_other_seeds "$target"
  "$build/tests/fuzz/retarget_fuzz" --target="$target" "${options[@]}" "${folders[@]}" \
    >"$build/$target.log" 2>&1
}

# Summarises the log of TARGET on one line.
report() {
  awk -v target="$1" '
    /^#[0-9]/ { for (i = 1; i < NF; ++i) { if ($i == "cov:") cov = $(i + 1); if ($i == "ft:") ft = $(i + 1) } }
    /^stat::number_of_executed_units/ { runs = $2 }
    /^stat::peak_rss_mb/ { memory = $2 }
    END { printf "fuzz: %-16s %9d executions, %5d edges, %6d features, %4d MB\n", target, runs, cov, ft, memory }
  ' "$build/$1.log"
}

# Fuzzes a target and reports the result; the file `passed` communicates it to other processes.
run() {
  rm -f -- "$build/$1.passed"
  if fuzz "$1" "$2"; then : >"$build/$1.passed"; fi
  report "$1"
}

minutes=${1:-}
[ $# -eq 0 ] || shift
if [ "$minutes" = threads ]; then
  check_threads
  exit
fi
from_kept=false
if [ -n "${FUZZ_SECONDS:-}" ]; then
  from_kept=true
  if [ -n "$minutes" ]; then set -- "$minutes" "$@"; fi
elif ! [[ $minutes =~ ^[1-9][0-9]*$ ]]; then
  fail "usage: tools/fuzz.sh MINUTES [TARGET...]"
fi

compiler=$(tools/find_clang.sh)
cmake --preset fuzz -DCMAKE_CXX_COMPILER="$compiler"
cmake --build --preset fuzz --parallel "$jobs" --target retarget_fuzz
read -ra all < <({ "$build/tests/fuzz/retarget_fuzz" 2>&1 || true; } | sed -n 's/^give --target=NAME of one of these: //p')
[ ${#all[@]} -gt 0 ] || fail "the program does not run: $build/tests/fuzz/retarget_fuzz"

targets=("$@")
[ $# -gt 0 ] || targets=("${all[@]}")
for target in "${targets[@]}"; do
  [[ " ${all[*]} " == *" $target "* ]] || fail "unknown target \"$target\" (known: ${all[*]})"
done
seconds=${FUZZ_SECONDS:-$((60 * minutes / ${#targets[@]}))}

mkdir -p "$build/findings"
echo "fuzz: ${#targets[@]} targets, $seconds seconds each, $jobs at a time"
for target in "${targets[@]}"; do
  while [ "$(jobs -rp | wc -l)" -ge "$jobs" ]; do wait -n || true; done
  run "$target" "$seconds" &
done
wait
broken=()
for target in "${targets[@]}"; do
  if ! [ -e "$build/$target.passed" ]; then broken+=("$target"); fi
done
if [ ${#broken[@]} -gt 0 ]; then
  for target in "${broken[@]}"; do
    echo "fuzz: $target is broken; the input is in $build/findings, all messages in $build/$target.log:" >&2
    grep -E 'ERROR|runtime error|not true|SUMMARY|Test unit' "$build/$target.log" >&2 || true
  done
  exit 1
fi
