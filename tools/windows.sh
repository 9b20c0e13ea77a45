#!/usr/bin/env bash
# Builds the tool for Windows on x86-64 with MinGW-w64, and packs it: build/windows/retarget-VERSION-windows-x86_64.zip,
# and retarget-VERSION-py3-none-win_amd64.whl, a wheel with the same program.
#
#   tools/windows.sh [--test]
#
#   --test  then build the tests of kModules and run them and the tool under Wine; CSV files of the two tools must have
#           the same bytes
#
# Calls tools/setup.sh and tools/windows_toolchain.sh, which need Debian or Ubuntu. The tests need a native tool:
# RETARGET_TOOL, else that of build/release or build/demo, else they build the preset demo. JOBS: the number of
# processes. docs/building.md describes the result.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
jobs=${JOBS:-$(nproc)}
build=$root/build/windows
readonly kModules=(base batch bvh fit formats ik io live math motion scene smpl stream)
# Tests of the command line that also describe the tool on Windows. Those with @needs_posix are skipped there.
readonly kCommandTests=(bad_input conversions edit evaluate motion_files not_finite run trainer_formats)
cd -- "$root"

say() { printf 'windows: %s\n' "$*" >&2; }

# A folder with everything that the program needs; it may be moved.
pack() {
  local version name staged
  version=$(sed -nE 's/^project\(retarget VERSION ([0-9.]+).*/\1/p' CMakeLists.txt)
  name=retarget-$version-windows-x86_64
  staged=$build/package
  rm -rf -- "$staged" "$build/$name.zip"
  cmake --install "$build" --prefix "$staged/$name" --strip >/dev/null
  # A program that links the library needs a library built by its own compiler.
  rm -rf -- "$staged/$name/include" "$staged/$name"/lib/*.a "$staged/$name/lib/cmake"
  find "$staged/$name/lib/retarget" -mindepth 1 -maxdepth 1 -type d -exec rm -rf {} +
  mv "$staged/$name/lib/retarget" "$staged/$name/share/doc/retarget/mujoco"
  rm -rf -- "${staged:?}/$name/lib"
  # The program contains the compiler's libraries.
  cp /usr/share/doc/mingw-w64-x86-64-dev/copyright "$staged/$name/share/doc/retarget/copyright.mingw-w64"
  cp /usr/share/doc/gcc-mingw-w64-x86-64-posix-runtime/copyright "$staged/$name/share/doc/retarget/copyright.gcc"
  (cd "$staged" && find "$name" -print | LC_ALL=C sort | zip -q -X -@ "../$name.zip")
  python3 tools/windows_wheel.py "$staged/$name" "$build" >/dev/null
  say "$name.zip: $(stat -c %s "$build/$name.zip") bytes; a wheel beside it"
}

run_tests() {
  local wine module failed=() wrapper=$build/wine-retarget native python
  native=$(realpath "${RETARGET_TOOL:-$(tools/native_tool.sh)}")
  # Most tests of formats need its numpy.
  python=$("$root/tools/setup.sh" --print-python)
  wine=$(command -v wine64 || echo /usr/lib/wine/wine64)
  # Use a separate Wine prefix, without messages of Wine.
  export WINEPREFIX=$build/wine WINEDEBUG=-all HOME=$build/home WINEPATH="Z:${build//\//\\}"
  mkdir -p "$HOME"
  cp build/deps/windows/mujoco/mujoco.dll "$build/"
  "$wine" wineboot --init >/dev/null 2>&1 || true
  cmake --build "$build" --parallel "$jobs" --target "${kModules[@]/%/_test}"
  for module in "${kModules[@]}"; do
    say "tests of $module"
    (cd "$build/tests" && "$wine" "./${module}_test.exe" --gtest_brief=1) || failed+=("$module")
  done
  local program
  program=$(echo "$build"/package/*/bin/retarget.exe)
  printf '#!/bin/sh\nexec %q %q "$@"\n' "$wine" "$program" >"$wrapper"
  chmod +x "$wrapper"
  say "the wheel"
  rm -rf -- "$build/installed"
  "$python" -m pip install --quiet --disable-pip-version-check --no-deps --no-index \
    --platform win_amd64 --only-binary :all: --target "$build/installed" "$build"/retarget-*-win_amd64.whl
  "$wine" "$build/installed/bin/retarget.exe" data/walk.bvh g1 -o "$build/wheel.csv" --quiet || failed+=(wheel)
  "$native" data/walk.bvh g1 -o "$build/native.csv" --quiet
  cmp "$build/wheel.csv" "$build/native.csv" || failed+=(wheel)
  say "the tool in its package, against $native"
  "$python" tests/windows/wine_checks.py "$native" "$wrapper" || failed+=(wine_checks)
  for module in "${kCommandTests[@]}"; do
    say "tests of the command line: $module"
    RETARGET_TOOL=$wrapper RETARGET_TOOL_SYSTEM=windows RETARGET_HARDENED=OFF PYTHONDONTWRITEBYTECODE=1 \
      "$python" "tests/cli/${module}_test.py" || failed+=("cli.$module")
  done
  [ ${#failed[@]} -eq 0 ] || {
    say "failed: ${failed[*]}"
    exit 1
  }
  say "all tests passed under $("$wine" --version)"
}

settings=()
if [ "${1:-}" = --test ]; then
  "$root/tools/setup.sh"
  modules=$(IFS=';' && echo "${kModules[*]}")
  settings=(-DRETARGET_BUILD_TESTS=ON "-DRETARGET_TEST_MODULES=$modules" -DRETARGET_CHECK_HEADERS=OFF
    -DRETARGET_PRECOMPILE_TEST_HEADERS=ON)
else
  "$root/tools/setup.sh" --tool
fi
"$root/tools/windows_toolchain.sh"
cmake --preset windows "${settings[@]}" >/dev/null
cmake --build --preset windows --parallel "$jobs" --target retarget_cli
pack
if [ "${1:-}" = --test ]; then run_tests; fi
