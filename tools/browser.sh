#!/usr/bin/env bash
# Builds the browser page: build/wasm/page/retarget.html, one file that retargets motions without a server.
#
#   tools/browser.sh [--test]
#
#   --test  then run its tests: the engine in Node and the page in headless Chromium against the native tool
#
# Needs a native tool, which packs the robots: RETARGET_TOOL, else that of build/release or build/demo, else it builds
# the preset demo. JOBS: the number of processes. docs/browser.md describes the page.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
jobs=${JOBS:-$(nproc)}
cd -- "$root"

"$root/tools/setup.sh" --tool
"$root/tools/browser_toolchain.sh"
tool=${RETARGET_TOOL:-$(tools/native_tool.sh)}
cmake --preset wasm >/dev/null
cmake --build --preset wasm --parallel "$jobs"
python3 browser/make_page.py --engine build/wasm/retarget.wasm --tool "$tool" --output build/wasm/page
if [ "${1:-}" = --test ]; then
  RETARGET_TOOL=$(realpath "$tool") RETARGET_BROWSER=$root/build/wasm python3 -m unittest discover -s tests/browser -p '*_test.py' -v
fi
