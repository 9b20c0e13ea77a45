#!/usr/bin/env bash
# Builds the Python wheel and tests what is installed from it, not the tree.
#
#   tools/wheel.sh [PYTHON [BUILD]]     (default: $PYTHON, else python3; a build folder of its own)
#
# The wheel comes into build/wheels: with the libraries that it needs inside, and named for the oldest
# glibc that it runs with (auditwheel). Then: installed into a fresh virtual environment with numpy
# alone, the program and the module work there, and the tests of python/tests pass.
# Calls tools/setup.sh --tool --python with this Python; pip fetches the pinned rest (tools/wheel.txt).
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
readonly kMaxBytes=30000000
python=${1:-${PYTHON:-python3}}
folder=${2:-}
out=$root/build/wheels
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT

say() { printf 'wheel: %s\n' "$*" >&2; }
pip() { "$1" -m pip --quiet --disable-pip-version-check "${@:2}"; }

build() {
  local settings=()
  say "building with $("$python" --version)"
  mkdir -p "$out" "$work/plain"
  # a folder that has the libraries already saves the time; for another Python's compiler it begins anew
  [ -z "$folder" ] || settings=(--config-settings "build-dir=$folder")
  CMAKE_BUILD_PARALLEL_LEVEL=${JOBS:-$(nproc)} pip "$python" wheel --no-deps "${settings[@]}" \
    --wheel-dir "$work/plain" "$root"
}

# the libraries of the distribution go into the wheel; MuJoCo is there already
repair() {
  "$python" -m venv "$work/tools"
  pip "$work/tools/bin/python" install --require-hashes --requirement "$root/tools/wheel.txt"
  PATH=$work/tools/bin:$PATH "$work/tools/bin/auditwheel" repair --wheel-dir "$work/repaired" \
    "$work"/plain/retarget-*.whl
  wheel=$(echo "$work"/repaired/retarget-*.whl)
  "$work/tools/bin/auditwheel" show "$wheel"
  local bytes
  bytes=$(stat -c %s "$wheel")
  say "$(basename "$wheel"): $bytes bytes"
  if [ "$bytes" -ge "$kMaxBytes" ]; then
    say "it is larger than $kMaxBytes bytes"
    exit 1
  fi
  check_notices
  cp "$wheel" "$out/"
}

# every library that auditwheel took in has its licence in the wheel's own notices
check_notices() {
  local library name notices=$work/notices
  "$python" -m zipfile -e "$wheel" "$notices"
  notices=$(find "$notices" -path '*.dist-info/*' -name THIRD_PARTY_NOTICES)
  if [ -z "$notices" ] || [ ! -e "$(dirname "$notices")/LICENSE" ]; then
    say "LICENSE and THIRD_PARTY_NOTICES are missing in it"
    exit 1
  fi
  for library in "$work"/notices/retarget.libs/*; do
    [ -e "$library" ] || continue
    # libzip-0123abcd.so.4, libtinyxml2-0123abcd.so.9
    name=$(basename "$library" | sed -E 's/(-[0-9a-f]{8})?\.so.*//')
    if ! grep -qxF "Shared libraries in the wheel: $name" "$notices"; then
      say "THIRD_PARTY_NOTICES says nothing of $name, which is inside"
      exit 1
    fi
  done
}

# outside of the tree, without its folders in any path
test_installed() {
  local installed=$work/installed
  "$python" -m venv "$installed"
  pip "$installed/bin/python" install "$wheel"
  pip "$installed/bin/python" list >&2
  cd -- "$work"
  unset PYTHONPATH RETARGET_TOOL RETARGET_DATA_DIR
  cp -r "$root/python/tests" "$root/data" "$work/"
  "$installed/bin/retarget" --version
  "$installed/bin/retarget" data/walk.bvh unitree_g1 -o walk.csv
  "$installed/bin/python" - <<'CODE'
import pathlib
import retarget

motion = retarget.to_robot("data/walk.bvh", "unitree_g1")
motion.save("python.csv")
assert pathlib.Path("python.csv").read_bytes() == pathlib.Path("walk.csv").read_bytes()
assert "installed" in retarget.__file__, retarget.__file__
print(repr(motion), retarget.evaluate(motion))
CODE
  # pytest beside it: what it brings is none of the package
  pip "$python" install --no-deps --target "$work/pytest" --require-hashes --requirement "$root/tools/python.txt"
  mkdir -p "$work/python" "$work/docs"
  mv "$work/tests" "$work/python/"
  cp "$root/docs/options.md" "$work/docs/"
  PYTHONPATH=$work/pytest "$installed/bin/python" -m pytest -q -p no:cacheprovider "$work/python/tests"
}

python=$("$python" -c 'import sys; print(sys.executable)')
RETARGET_PYTHON=$python "$root/tools/setup.sh" --tool --python
wheel=
build
repair
test_installed
say "built and tested: $out/$(basename "$wheel")"
