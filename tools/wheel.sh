#!/usr/bin/env bash
# Builds the Python wheel and tests its installed contents, not those of the source tree.
#
#   tools/wheel.sh [PYTHON [BUILD]]     (default: $PYTHON, otherwise python3; a separate build folder)
#
# Writes the wheel to build/wheels. It contains the libraries that it needs and is named for the oldest
# glibc that it supports (auditwheel). retarget-robots-unverified.zip next to it has the excluded robots.
# Then installs the wheel into a new virtual environment that has only numpy. The program and the module
# must work there, and the tests of python/tests must pass.
# Calls tools/setup.sh --tool --python with this Python; pip fetches the other pinned tools (tools/wheel.txt).
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
  # An existing build folder saves time; another Python causes a new build.
  [ -z "$folder" ] || settings=(--config-settings "build-dir=$folder")
  CMAKE_BUILD_PARALLEL_LEVEL=${JOBS:-$(nproc)} pip "$python" wheel --no-deps "${settings[@]}" \
    --wheel-dir "$work/plain" "$root"
}

# Adds the libraries of the distribution to the wheel, which already contains MuJoCo.
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

# The notices of the wheel must contain the licence of every library that auditwheel added.
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
    # For example libzip-0123abcd.so.4, libtinyxml2-0123abcd.so.9.
    name=$(basename "$library" | sed -E 's/(-[0-9a-f]{8})?\.so.*//')
    if ! grep -qxF "Shared libraries in the wheel: $name" "$notices"; then
      say "THIRD_PARTY_NOTICES does not mention $name, which the wheel contains"
      exit 1
    fi
  done
}

# The tool must list an excluded robot as not installed, and find it after its installation.
try_left_out() {
  local status=0
  export XDG_DATA_HOME=$work/data_home
  "$1" data/walk.bvh booster_k1 -o left_out.csv 2>message || status=$?
  if [ "$status" != 4 ] || ! grep -qF "booster_k1 is not installed" message; then
    say "exit code $status for a robot that is not installed: $(cat message)"
    exit 1
  fi
  "$1" robots install booster_k1 --source "$robots"
  "$1" data/walk.bvh booster_k1 -o left_out.csv
  unset XDG_DATA_HOME
}

# Run outside the source tree, without its folders in any path.
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
  try_left_out "$installed/bin/retarget"
  "$installed/bin/python" - <<'CODE'
import pathlib
import retarget

motion = retarget.to_robot("data/walk.bvh", "unitree_g1")
motion.save("python.csv")
assert pathlib.Path("python.csv").read_bytes() == pathlib.Path("walk.csv").read_bytes()
assert "installed" in retarget.__file__, retarget.__file__
print(repr(motion), retarget.evaluate(motion))
CODE
  # Install pytest in a separate folder; its dependencies are not part of the package.
  pip "$python" install --no-deps --target "$work/pytest" --require-hashes --requirement "$root/tools/python.txt"
  mkdir -p "$work/python" "$work/docs"
  mv "$work/tests" "$work/python/"
  cp "$root/docs/options.md" "$work/docs/"
  PYTHONPATH=$work/pytest "$installed/bin/python" -m pytest -q -p no:cacheprovider "$work/python/tests"
}

python=$("$python" -c 'import sys; print(sys.executable)')
RETARGET_PYTHON=$python "$root/tools/setup.sh" --tool --python
wheel=
robots=$out/retarget-robots-unverified.zip
build
(cd -- "$root" && cmake -E tar cf "$robots" --format=zip robots/unverified)
repair
test_installed
say "built and tested: $out/$(basename "$wheel")"
