#!/usr/bin/env bash
# Runs checks in addition to the tests, for developers and CI.
#
#   tools/check.sh [format] [shell] [asan] [tsan] [tidy] [fuzz] [arm64] [viewer] [words] [workflows] [browser] [macos] [windows] [quick]
#                                                     (default: all but the last four)
#
#   format  clang-format (version 14) would change nothing
#   shell   shellcheck has no findings in the scripts
#   asan    all tests pass under the address and undefined behaviour sanitizers
#   asan-input   the same for the modules that read users' files, and the command line, on the
#           library that fuzz links
#   tsan    the tests of batches, fit, live, pipeline and stream pass under the thread sanitizer
#   tidy    clang-tidy has no findings in the library and the tool
#   fuzz    fuzzing every reader for ten seconds (tools/fuzz.sh) finds no fault
#   arm64   the library and the tool compile for ARM64; skipped without a cross compiler
#   viewer  the script of pages is up to date with viewer/src; skipped without Node (tools/viewer_bundle.sh)
#   words   comments, messages and pages contain none of the wording in tools/words.txt
#           (tools/check_words.py)
#   workflows    .github/workflows has the form of GitHub's workflows (check-jsonschema, with the schema in its wheel)
#   macos   the library and the tool compile for macOS (tools/check_macos.sh); not in CI
#   windows the tool for Windows builds, and its results under Wine are those of the native tool (tools/windows.sh);
#           not in CI
#   browser the browser page builds, and its results are those of the native tool (tools/browser.sh); not in CI
#   quick   the quick build (tools/demo.sh) compiles, writes the bytes of the build in build/release, if there is one,
#           and names the commands that it lacks; not in CI
#
# Calls tools/setup.sh --dev to install dependencies. JOBS: the number of processes.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
jobs=${JOBS:-$(nproc)}

# Lists the files of the repository (or of an unpacked archive of it) with the given extensions.
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

# Includes the Python module.
check_asan() {
  "$root/tools/setup.sh" --python
  cmake --preset asan -DRETARGET_BUILD_PYTHON=ON -DRETARGET_PYTHON="$("$root/tools/setup.sh" --python --print-python)"
  cmake --build --preset asan --parallel "$jobs"
  ctest --preset asan --parallel "$jobs"
}

# The part of asan that CI runs, because compiling the tests of the numerical modules takes longest.
# Uses clang so that these tests and the fuzzing share one library.
check_asan-input() {
  local modules=(base batch bvh fuzz human io motion robot scene_world smpl stream) compiler
  # The tests of the streams use third-party clients.
  "$root/tools/setup.sh" --python
  compiler=$(tools/find_clang.sh)
  # CI builds everything once. Both settings stay in the cache, for fuzz.
  cmake --preset fuzz -DCMAKE_CXX_COMPILER="$compiler" ${CI:+-DRETARGET_UNITY_FILES=32 -DRETARGET_QUICK_SANITIZERS=ON}
  cmake --build --preset fuzz --parallel "$jobs" --target retarget_cli "${modules[@]/%/_test}"
  # Run only command line tests with unusual input; the others solve ordinary clips, slowly. Sweeps over
  # generated motions, and edits of clips, take minutes under sanitizers. check_asan runs all of them.
  ctest --preset fuzz --parallel "$((jobs + 1))" -R "^($(IFS='|'; echo "${modules[*]}")|cli)\\." \
    -E '^(cli\.(human|run|travel|determinism|evaluate|batch|batch_resume|glb|live_options|provenance|scene_outputs|trainer_formats|view_browser_scene|fit_odd_sources|compare_peers|formats|conversions|inputs_are_spared|view_positions|turned_base|batch_merge|default_motion|docs_commands|own_files|robots|robot_to_robot|live_outputs|live_soak|perturbations|noise|batch_certify|batch_processes|configuration_choice|contact_edits|data_sets|edit|gallery.*|hands|inspect_page|live|live_blocked_outputs|odd_bodies|positions_motion|scene|setup|simulate|small_files_memory|terrain|time_scale|tracking_predictor|view|view_page)$|human\.LyingBodies\.|scene_world\.(DistanceField|SampleDistance)\.)'
}

check_tsan() {
  JOBS=$jobs "$root/tools/fuzz.sh" threads
}

# Reads each header once for all files of a wing: clang-tidy takes a tenth of the time that single files take.
check_tidy() {
  local program runner
  program=$(command -v clang-tidy-14 || command -v clang-tidy)
  runner=$(command -v run-clang-tidy-14 || command -v run-clang-tidy)
  cmake --preset tidy -DCMAKE_CXX_COMPILER="$(tools/find_clang.sh)"
  cmake --build --preset tidy --parallel "$jobs" --target retarget_build_facts
  "$runner" -clang-tidy-binary "$program" -p build/tidy -j "$jobs" -quiet \
    -header-filter "^$root/(src|include/retarget|tools/retarget)/" '(/Unity/|/tools/retarget/)'
}

check_quick() {
  local quick=build/quick/tools/retarget/retarget release=build/release/tools/retarget/retarget
  tools/demo.sh
  if "$quick" batch data -o build/quick/batch --robot g1 || [ $? -ne 2 ]; then
    echo "check: quick: an absent command must be a usage error" >&2
    return 1
  fi
  [ -x "$release" ] || return 0
  "$release" --quiet --bvh data/walk.bvh --robot unitree_g1 -o build/quick/walk.csv
  cmp build/walk.csv build/quick/walk.csv
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

check_words() {
  python3 "$root/tools/check_words.py"
}

check_workflows() {
  local folder=$root/build/deps/workflows
  if ! cmp -s "$root/tools/workflows.txt" "$folder/workflows.txt"; then
    rm -rf -- "$folder"
    python3 -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes --only-binary :all: \
      --target "$folder" -r "$root/tools/workflows.txt"
    cp "$root/tools/workflows.txt" "$folder/"
  fi
  PYTHONPATH=$folder python3 -m check_jsonschema --builtin-schema vendor.github-workflows "$root"/.github/workflows/*.yml
}

check_macos() {
  JOBS=$jobs "$root/tools/check_macos.sh"
}

check_windows() {
  JOBS=$jobs "$root/tools/windows.sh" --test
}

check_browser() {
  JOBS=$jobs "$root/tools/browser.sh" --test
}

checks=("$@")
[ $# -gt 0 ] || checks=(format shell asan tsan tidy fuzz arm64 viewer words workflows)
for check in "${checks[@]}"; do
  if ! declare -F "check_$check" >/dev/null; then
    echo "check: unknown check \"$check\" (known: format, shell, asan, asan-input, tsan, tidy, fuzz, arm64, viewer, words, workflows, browser, macos, windows, quick)" >&2
    exit 2
  fi
done

# The compiler includes the sanitizers, and the words need only Python.
case "${checks[*]}" in
  words | workflows) ;;
  asan | tsan | browser | macos | windows | quick) "$root/tools/setup.sh" ;;
  *) "$root/tools/setup.sh" --dev ;;
esac
cd -- "$root"
for check in "${checks[@]}"; do
  echo "check: $check"
  "check_$check"
done
