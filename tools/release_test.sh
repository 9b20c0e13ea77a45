#!/usr/bin/env bash
# Tests the files of build/release_artifacts for one processor, unpacked or installed in empty folders.
#
#   tools/release_test.sh ARCH [--quick]     (x86_64 or aarch64; --quick: without python/tests)
#
#   * archive and .deb: the command finds its data and MuJoCo, installs a robot from retarget-robots-unverified.zip, and gives
#     the bytes of a native build (build/release or build/demo, if there is one), for both methods
#   * the same with the C library of Debian 11 (glibc 2.31): in a chroot, as root, or under qemu-user
#   * ZeroMQ and Redis outputs: tests/cli/live_outputs_test.py with the command of the archive
#   * wheel: in a new environment of each Python that it names, the command's bytes and python/tests
#
# A processor other than this machine's runs under qemu-user, with Debian's Python 3.11 and without python/tests. Because
# that is slow, the .deb's command and libraries are only compared with the archive's.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
arch=$1
quick=${2:-}
out=$root/build/release_artifacts
deps=$root/build/deps/linux_$arch
glibc=$(sed -nE 's/^set\(RETARGET_GLIBC ([0-9.]+)\)/\1/p' "$root/cmake/linux_release.cmake")
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
# The installed files must find everything by themselves.
unset RETARGET_DATA_DIR RETARGET_TOOL PYTHONPATH

say() { printf 'release_test: %s: %s\n' "$arch" "$*" >&2; }

fail() {
  say "$*"
  exit 1
}

is_foreign() { [ "$arch" != "$(uname -m)" ]; }

# expect_same FILE NAME: compares with the result of the native build; without one, with that of the first file tested.
expect_same() {
  local expected=$work/expected.$2
  [ -e "$expected" ] || cp "$1" "$expected"
  cmp "$1" "$expected" || fail "other bytes than the native build: $2"
}

native_results() {
  local tool
  for tool in "$root"/build/{release,demo}/tools/retarget/retarget; do
    [ -x "$tool" ] || continue
    say "comparing with $tool"
    retarget_all "$tool" "$work/expected"
    "$tool" "$root/data/walk.bvh" booster_k1 -o "$work/expected.left_out.csv" --quiet
    return 0
  done
  say "there is no native build to compare with: comparing the files with each other"
}

# retarget_all TOOL PREFIX
retarget_all() {
  "$1" "$root/data/walk.bvh" unitree_g1 -o "$2.fit.csv" --quiet
  "$1" "$root/data/walk.bvh" unitree_g1 --method gmr -o "$2.gmr.csv" --quiet
}

# as_tool FOLDER NAME: writes a script that runs FOLDER/bin/retarget on this machine, and prints its path
as_tool() {
  printf '#!/usr/bin/env bash\nexec %q %q "$@"\n' "$deps/bin/release-run" "$1/bin/retarget" >"$work/$2.sh"
  chmod +x "$work/$2.sh"
  echo "$work/$2.sh"
}

# The tool must list an excluded robot as not installed, and find it after its installation.
try_left_out() {
  local tool=$1 name=$2 status=0
  export XDG_DATA_HOME=$work/$name.data
  "$tool" "$root/data/walk.bvh" booster_k1 -o "$work/$name.csv" 2>"$work/message" || status=$?
  if [ "$status" != 4 ] || ! grep -qF "booster_k1 is not installed" "$work/message"; then
    fail "$name: exit code $status for a robot that is not installed: $(cat "$work/message")"
  fi
  "$tool" robots install booster_k1 --source "$out/retarget-robots-unverified.zip"
  "$tool" "$root/data/walk.bvh" booster_k1 -o "$work/$name.csv" --quiet
  expect_same "$work/$name.csv" left_out.csv
  unset XDG_DATA_HOME
}

# try_tree FOLDER NAME: tests an unpacked tree
try_tree() {
  local tool method
  tool=$(as_tool "$1" "$2")
  (
    cd -- "$work"
    "$tool" --version
    [ "$("$tool" robots list | grep -c .)" -ge 19 ] || fail "$2: fewer than 19 robots"
    retarget_all "$tool" "$work/$2"
    for method in fit gmr; do expect_same "$work/$2.$method.csv" "$method.csv"; done
    try_left_out "$tool" "$2"
  )
  say "$2: works"
}

try_older_glibc() {
  local tree=$1 system=$deps/debian11
  "$root/tools/release_sysroot.sh" "$arch" "$system" bullseye
  if is_foreign; then
    qemu-"$arch"-static -L "$system" "$tree/bin/retarget" "$root/data/walk.bvh" unitree_g1 -o "$work/older.csv" --quiet
  elif [ "$(id -u)" -eq 0 ]; then
    rm -rf -- "$system/trial"
    mkdir -p "$system/trial" "$system/proc"
    cp -r "$tree" "$system/trial/retarget"
    cp "$root/data/walk.bvh" "$system/trial/"
    # The loader needs /proc to know where the command is.
    # shellcheck disable=SC2016  # the inner shell's own words
    unshare --mount bash -c 'mount --bind /proc "$1/proc" && exec chroot "$@"' - "$system" /trial/retarget/bin/retarget \
      /trial/walk.bvh unitree_g1 -o /trial/older.csv --quiet
    cp "$system/trial/older.csv" "$work/"
    rm -rf -- "$system/trial"
  else
    say "not tested with an older glibc: this needs root"
    return 0
  fi
  expect_same "$work/older.csv" fit.csv
  say "works with the C library of Debian 11"
}

try_outputs() {
  local python
  if is_foreign; then return 0; fi
  python=$("$root/tools/setup.sh" --python --print-python)
  # Missing clients are failures.
  RETARGET_STRICT_TESTS=1 RETARGET_TOOL=$1/bin/retarget PYTHONPATH=$root/build/deps/python "$python" "$root/tests/cli/live_outputs_test.py"
  say "ZeroMQ and Redis outputs work"
}

find_python() {
  local python
  for python in "python$1" "$HOME"/.pyenv/versions/"$1".*/bin/python /usr/bin/python3 python3; do
    "$python" -c "import sys, ensurepip; sys.exit('%d.%d' % sys.version_info[:2] != '$1')" 2>/dev/null || continue
    "$python" -c 'import sys; print(sys.executable)'
    return 0
  done
  return 1
}

# Code that runs without the source tree: the module's bytes are the command's.
readonly kSmallTest='
import pathlib, sys
import retarget
motion = retarget.to_robot("data/walk.bvh", "unitree_g1")
motion.save("python.csv")
assert pathlib.Path("python.csv").read_bytes() == pathlib.Path("walk.csv").read_bytes()
assert "installed" in retarget.__file__, retarget.__file__
print(sys.version.split()[0], repr(motion), retarget.evaluate(motion))
'

# try_wheel VERSION
try_wheel() {
  local python installed=$work/installed_$1
  python=$(find_python "$1") || {
    say "wheel: not tested with Python $1, which is not here"
    return 0
  }
  "$python" -m venv "$installed"
  "$installed/bin/python" -m pip --quiet --disable-pip-version-check install "$wheel"
  mkdir -p "$work/run_$1/python" "$work/run_$1/docs"
  cd -- "$work/run_$1"
  cp -r "$root/data" .
  cp "$root/docs/options.md" docs/
  cp -r "$root/python/tests" python/
  "$installed/bin/retarget" data/walk.bvh unitree_g1 -o walk.csv --quiet
  expect_same walk.csv fit.csv
  "$installed/bin/python" -c "$kSmallTest"
  if [ -z "$quick" ]; then
    # Install pytest in a separate folder; its dependencies are not part of the package.
    "$installed/bin/python" -m pip --quiet --disable-pip-version-check install --no-deps --target "$work/pytest_$1" \
      --require-hashes --requirement "$root/tools/python.txt"
    PYTHONPATH=$work/pytest_$1 "$installed/bin/python" -m pytest -q -p no:cacheprovider python/tests
  fi
  cd -- "$root"
  say "wheel: works with Python $1"
}

# Debian's Python of the other processor
try_foreign_wheel() {
  local installed=$work/installed
  python3 -m pip --quiet --disable-pip-version-check install --no-deps --no-index --only-binary=:all: --implementation cp \
    --python-version 3.11 --platform "manylinux_${glibc/./_}_$arch" --target "$installed" "$wheel"
  mkdir -p "$work/run"
  cd -- "$work/run"
  cp -r "$root/data" .
  cp "$work/expected.fit.csv" walk.csv
  PYTHONPATH=$installed "$deps/bin/release-python" -c "$kSmallTest"
  cd -- "$root"
  say "wheel: works with Debian's Python 3.11 under qemu-user"
}

native_results
mkdir "$work/archive"
tar -xzf "$(echo "$out"/retarget-*-linux-"$arch".tar.gz)" -C "$work/archive"
tree=$(echo "$work"/archive/retarget-*)
try_tree "$tree" archive
debian=amd64
[ "$arch" = x86_64 ] || debian=arm64
dpkg-deb --extract "$(echo "$out"/retarget_*_"$debian".deb)" "$work/debian"
if is_foreign; then
  for folder in bin lib share/retarget; do
    diff -r "$tree/$folder" "$work/debian/usr/$folder" || fail "the .deb has other files than the archive"
  done
  "$(as_tool "$work/debian/usr" debian)" --version
  say "debian: the files of the archive"
else
  try_tree "$work/debian/usr" debian
fi
for file in copyright LICENSE THIRD_PARTY_NOTICES; do
  [ -s "$work/debian/usr/share/doc/retarget/$file" ] || fail "the .deb lacks share/doc/retarget/$file"
done
try_older_glibc "$tree"
try_outputs "$tree"
wheel=$(echo "$out"/retarget-*"$arch".whl)
if is_foreign; then
  try_foreign_wheel
else
  for version in 3.10 3.11 3.12 3.13; do try_wheel "$version"; done
fi
(cd -- "$out" && sha256sum --quiet --check SHA256SUMS)
say "all tests passed"
