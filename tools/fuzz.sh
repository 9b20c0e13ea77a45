#!/usr/bin/env bash
# Fuzzing of every reader under the address and undefined behaviour sanitizers.
#
#   tools/fuzz.sh MINUTES [TARGET...]        MINUTES of all targets together; bvh, npz, csv, ...
#   FUZZ_SECONDS=10 tools/fuzz.sh            so many seconds of each
#
# Builds with clang into build/fuzz. What was found interesting is kept in build/fuzz/corpus and goes on
# from there the next time; what breaks a reader is written to build/fuzz/findings, and the exit code is 1.
# Needs what tools/setup.sh --dev installs. JOBS: how many processes. CXX: another clang++.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
cd -- "$root"
jobs=${JOBS:-$(nproc)}
build=build/fuzz

fail() {
  echo "fuzz: $1" >&2
  exit 2
}

clang() {
  local name
  for name in "${CXX:-}" clang++-14 clang++ /usr/lib/llvm-*/bin/clang++; do
    if [[ $name == *clang* ]] && command -v "$name"; then return 0; fi
  done
  fail "there is no clang++: run tools/setup.sh --dev"
}

all=(bvh npz pickle npy csv motion mapping dialect bone_map path fit_options manifest profile model)
minutes=${1:-}
[ $# -eq 0 ] || shift
targets=("$@")
[ $# -gt 0 ] || targets=("${all[@]}")
for target in "${targets[@]}"; do
  [[ " ${all[*]} " == *" $target "* ]] || fail "unknown target \"$target\" (known: ${all[*]})"
done
if [ -n "${FUZZ_SECONDS:-}" ]; then
  seconds=$FUZZ_SECONDS
elif [[ $minutes =~ ^[1-9][0-9]*$ ]]; then
  seconds=$((60 * minutes / ${#targets[@]}))
else
  fail "usage: tools/fuzz.sh MINUTES [TARGET...]"
fi

# what the repository has of a kind of file; several readers share them
seeds() {
  case $1 in
    bvh) find tests/bvh/conformance -name '*.bvh' ;;
    csv | motion) find tests/golden -name '*.csv' ;;
    mapping) find configs -maxdepth 1 -name '*.json' ;;
    dialect) find configs/skeletons -name '*.json' ;;
    profile) find robots -name robot.json ;;
    model) find robots -name model.xml ;;
  esac
  if [ -d "tests/fuzz/seeds/$1" ]; then find "tests/fuzz/seeds/$1" -type f; fi
}

# the beginnings are enough: a fuzzer is slow with large files
take_seeds() {
  local folder=$build/seeds/$1 file number=0
  mkdir -p "$folder"
  while IFS= read -r file; do
    number=$((number + 1))
    case $file in
      *.csv) head -n 3 "$file" >"$folder/$number" ;;
      *) cp "$file" "$folder/$number" ;;
    esac
  done < <(seeds "$1" | sort)
}

cmake -S . -B "$build" -G Ninja -DCMAKE_CXX_COMPILER="$(clang)" -DCMAKE_BUILD_TYPE=RelWithDebInfo \
  -DRETARGET_BUILD_TESTS=ON -DRETARGET_BUILD_FUZZERS=ON -DRETARGET_BUILD_TOOLS=OFF \
  -DRETARGET_INSTALL=OFF -DRETARGET_CHECK_HEADERS=OFF
cmake --build "$build" --parallel "$jobs" --target "${targets[@]/%/_reader_fuzz}"

mkdir -p "$build/findings"
broken=()
for target in "${targets[@]}"; do
  take_seeds "$target"
  mkdir -p "$build/corpus/$target"
  options=(-max_total_time="$seconds" -timeout=20 -rss_limit_mb=2048 -max_len=65536 -verbosity=0
    -print_final_stats=1 -artifact_prefix="$build/findings/$target-")
  if [ -e "tests/fuzz/$target.dict" ]; then options+=(-dict="tests/fuzz/$target.dict"); fi
  echo "fuzz: $target, $seconds seconds"
  "$(find "$build" -name "${target}_reader_fuzz" -type f)" "${options[@]}" "$build/corpus/$target" \
    "$build/seeds/$target" >"$build/$target.log" 2>&1 || broken+=("$target")
  grep -E '^stat::(number_of_executed_units|peak_rss_mb)' "$build/$target.log" || true
done
if [ ${#broken[@]} -gt 0 ]; then
  for target in "${broken[@]}"; do grep -E 'ERROR|runtime error|not true|SUMMARY' "$build/$target.log" >&2 || true; done
  echo "fuzz: broken: ${broken[*]}; see $build/findings and $build/*.log" >&2
  exit 1
fi
