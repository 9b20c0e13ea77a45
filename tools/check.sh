#!/usr/bin/env bash
# The checks beyond the tests, for developers and CI.
#
#   tools/check.sh [format] [shell] [asan] [tsan] [tidy] [fuzz] [arm64] [viewer]   (default: all eight)
#
#   format  clang-format (version 14) would change nothing
#   shell   shellcheck finds nothing in the scripts
#   asan    all tests pass under the address and undefined behaviour sanitizers
#   asan-input   the same for the modules that read what users bring, and the command line, on the
#           library that fuzz is linked with
#   tsan    the tests of batches, fit and pipeline pass under the thread sanitizer
#   tidy    clang-tidy finds nothing in the library and the tool
#   fuzz    every reader is fuzzed for ten seconds (tools/fuzz.sh) and nothing breaks
#   arm64   the library and the tool compile for ARM64, where its cross compiler is there
#   viewer  the script of pages is what viewer/src makes, where there is Node (tools/viewer_bundle.sh)
#
# Needs what tools/setup.sh --dev installs, and calls it. JOBS: how many processes.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
jobs=${JOBS:-$(nproc)}

# the files of the repository (or of an unpacked archive of it) with the given endings
files() {
  local name tests=()
  for name; do tests+=(-o -name "$name"); done
  find . \( -path ./build -o -path ./.git \) -prune -o -type f \( "${tests[@]:1}" \) -print0
}

check_format() {
  local program
  program=$(command -v clang-format-14 || command -v /usr/lib/llvm-14/bin/clang-format || true)
  if [ -z "$program" ]; then
    echo "check: format left out: there is no clang-format 14, and others format differently" >&2
    return 0
  fi
  files '*.h' '*.cpp' | xargs -0 -r "$program" --dry-run -Werror
}

check_shell() {
  { files '*.sh' '*.sbatch'; printf '.ci/run\0'; } | xargs -0 -r shellcheck
}

# the Python module, too
check_asan() {
  "$root/tools/setup.sh" --python
  cmake --preset asan -DRETARGET_BUILD_PYTHON=ON -DRETARGET_PYTHON="$("$root/tools/setup.sh" --python --print-python)"
  cmake --build --preset asan --parallel "$jobs"
  ctest --preset asan --parallel "$jobs"
}

# CI's share of asan: compiling the numerical modules' tests with it takes longer than all else. With
# clang, so that one library serves these tests and the fuzzing.
check_asan-input() {
  local modules=(base batch bvh edit fuzz human io motion robot smpl stream) compiler
  # its tests talk to other people's clients
  "$root/tools/setup.sh" --python
  compiler=$(tools/find_clang.sh)
  cmake --preset fuzz -DCMAKE_CXX_COMPILER="$compiler"
  cmake --build --preset fuzz --parallel "$jobs" --target retarget_cli "${modules[@]/%/_test}"
  # of the command line what brings odd input; the rest solves ordinary clips, slowly
  ctest --preset fuzz --parallel "$jobs" -R "^($(IFS='|'; echo "${modules[*]}")|cli)\\." \
    -E '^cli\.(human|run|determinism|fit_odd_sources|compare_peers|default_motion|docs_commands|own_files|robot_to_robot|live_outputs|live_soak)$'
}

check_tsan() {
  JOBS=$jobs "$root/tools/fuzz.sh" threads
}

check_tidy() {
  cmake --preset tidy
  cmake --build --preset tidy --parallel "$jobs"
}

check_fuzz() {
  FUZZ_SECONDS=${FUZZ_SECONDS:-10} JOBS=$jobs "$root/tools/fuzz.sh"
}

check_arm64() {
  "$root/tools/check_arm64.sh"
}

check_viewer() {
  "$root/tools/viewer_bundle.sh" --check
}

checks=("$@")
[ $# -gt 0 ] || checks=(format shell asan tsan tidy fuzz arm64 viewer)
for check in "${checks[@]}"; do
  if ! declare -F "check_$check" >/dev/null; then
    echo "check: unknown check \"$check\" (known: format, shell, asan, asan-input, tsan, tidy, fuzz, arm64, viewer)" >&2
    exit 2
  fi
done

# the sanitizers come with the compiler
case "${checks[*]}" in asan | tsan) developer=() ;; *) developer=(--dev) ;; esac
"$root/tools/setup.sh" "${developer[@]}"
cd -- "$root"
for check in "${checks[@]}"; do
  echo "check: $check"
  "check_$check"
done
