#!/usr/bin/env bash
# Makes and tests the files of a release for Linux, in build/release_artifacts.
#
#   tools/release.sh [--arch x86_64|aarch64|all] [--test] [--python VERSION]...
#
#   --arch    the processors (default: that of this machine)
#   --test    also unpack and install every file in an empty folder and test it there (tools/release_test.sh)
#   --python  versions of CPython older than 3.12 with modules of their own, and one from 3.12 for the stable ABI
#             (default: 3.10, 3.11 and 3.12; each must be installed with its headers)
#
#   retarget-VERSION-linux-ARCH.tar.gz   command, shared library, data, documents
#   retarget_VERSION_DEBIANARCH.deb      the same
#   retarget-VERSION-...-ARCH.whl        command and Python module
#   retarget-robots-unverified.zip       the robots that they leave out, for `retarget robots install`
#   retarget-VERSION-linux-ARCH.cdx.json the parts of each (CycloneDX)
#   SHA256SUMS
#
# One shared library serves command and module. It and the command link everything but MuJoCo and the C library statically,
# and need glibc 2.28 or later (cmake/linux_release.cmake). The files have the same bytes in every run with the same
# commit, tools and libraries: their time is that of the commit (or SOURCE_DATE_EPOCH).
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
out=$root/build/release_artifacts
jobs=${JOBS:-$(nproc)}
# The wheel must stay below the usual limits of package indexes by far.
readonly kMaxWheelBytes=12000000
architectures=() pythons=() with_tests=false
version=$(sed -nE 's/^project\(retarget VERSION ([0-9.]+).*/\1/p' "$root/CMakeLists.txt")
glibc=$(sed -nE 's/^set\(RETARGET_GLIBC ([0-9.]+)\)/\1/p' "$root/cmake/linux_release.cmake")

say() { printf 'release: %s\n' "$*" >&2; }

fail() {
  say "$*"
  exit 1
}

while [ $# -gt 0 ]; do
  case $1 in
    --arch)
      case ${2:-} in
        all) architectures=(x86_64 aarch64) ;;
        x86_64 | aarch64) architectures=("$2") ;;
        *) fail "unknown architecture \"${2:-}\" (known: x86_64, aarch64, all)" ;;
      esac
      shift
      ;;
    --python)
      pythons+=("${2:?}")
      shift
      ;;
    --test) with_tests=true ;;
    *)
      say "unknown option $1 (known: --arch, --python, --test)"
      exit 2
      ;;
  esac
  shift
done
[ ${#architectures[@]} -gt 0 ] || architectures=("$(uname -m)")
[ ${#pythons[@]} -gt 0 ] || pythons=(3.10 3.11 3.12)
for arch in "${architectures[@]}"; do
  # The Python of release-python makes the stubs and tests the wheel.
  [ "$arch" = "$(uname -m)" ] || [[ " ${pythons[*]} " == *" 3.11 "* ]] || fail "$arch needs a module for Python 3.11: add --python 3.11"
done

export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -C "$root" log -1 --format=%ct)}
# Modes of files in archives do not depend on the user.
umask 022

# find_python VERSION: prints an interpreter of this version that has its headers.
find_python() {
  local python
  for python in "python$1" "$HOME"/.pyenv/versions/"$1".*/bin/python /usr/bin/python3 python3; do
    "$python" -c "import os, sys, sysconfig
sys.exit('%d.%d' % sys.version_info[:2] != '$1' or not os.path.exists(sysconfig.get_path('include') + '/Python.h'))" \
      2>/dev/null || continue
    "$python" -c 'import sys; print(sys.executable)'
    return 0
  done
  fail "there is no Python $1 with its headers: install it, or choose versions with --python"
}

python_headers() { "$1" -c 'import sysconfig; print(sysconfig.get_path("include"))'; }

# Tools that make wheels and lists of parts, in a separate environment.
prepare_tools() {
  tools=$root/build/deps/release_tools
  cmp -s "$root/tools/release.txt" "$tools/pinned" && return 0
  rm -rf -- "$tools"
  "$(find_python "$tool_python")" -m venv "$tools"
  "$tools/bin/python" -m pip --quiet --disable-pip-version-check install --require-hashes --no-deps \
    --requirement "$root/tools/release.txt"
  cp "$root/tools/release.txt" "$tools/pinned"
}

# configure NAME ARCH SOURCE ARGUMENT...: in build/NAME_ARCH
configure() {
  local folder=$root/build/$1_$2
  local arch=$2 source=$3
  shift 3
  cmake -S "$source" -B "$folder" -G Ninja -DCMAKE_TOOLCHAIN_FILE="$root/cmake/linux_release.cmake" "-DRETARGET_ARCH=$arch" \
    -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS_RELEASE=-O2 -DNDEBUG" "$@" >"$folder.log" || {
    cat "$folder.log" >&2
    return 1
  }
}

build_engine() {
  local arch=$1
  say "$arch: building command and library"
  configure linux "$arch" "$root" -DBUILD_SHARED_LIBS=ON -DRETARGET_BUILD_TESTS=OFF -DRETARGET_UNITY_BUILD=ON \
    -DRETARGET_UNITY_FILES=64 -DRETARGET_CCACHE=OFF "-DMuJoCo_ROOT=$root/build/deps/linux_$arch/mujoco" -DRETARGET_LZ4=ON \
    -DRETARGET_ZEROMQ=ON -DRETARGET_REDIS=ON -DCMAKE_INSTALL_PREFIX=/usr -DCMAKE_INSTALL_LIBDIR=lib
  cmake --build "$root/build/linux_$arch" --parallel "$jobs" \
    --target retarget_cli retarget_bash retarget_zsh retarget_fish retarget_man
  rm -rf -- "$tree"
  cmake --install "$root/build/linux_$arch" --prefix "$tree" >/dev/null
}

# build_module ARCH PYTHON SUFFIX
build_module() {
  local arch=$1 python=$2 suffix=$3
  local name=module${suffix%.so}
  say "$arch: building the module$suffix"
  configure "$name" "$arch" "$root/tools/release_module" "-Dretarget_DIR=$tree/lib/cmake/retarget" \
    "-DMODULE_SOURCES=$root/python/src" "-DMODULE_PYTHON_HEADERS=$(python_headers "$python")" \
    "-DMODULE_NANOBIND=$root/build/deps/python/nanobind" "-DMODULE_SUFFIX=$suffix"
  cmake --build "$root/build/${name}_$arch" --parallel "$jobs"
  cp "$root/build/${name}_$arch/_retarget$suffix" "$modules/"
}

build_modules() {
  local arch=$1 version python
  rm -rf -- "$modules"
  mkdir -p "$modules"
  for version in "${pythons[@]}"; do
    python=$(find_python "$version")
    case $version in
      3.10 | 3.11) build_module "$arch" "$python" ".cpython-${version/./}-$arch-linux-gnu.so" ;;
      *) build_module "$arch" "$python" .abi3.so ;;
    esac
  done
}

# The stubs describe the module, and so are the same for every processor and Python.
make_stubs() {
  local arch=$1
  local package=$root/build/stubs_$arch/retarget python
  # The package imports numpy.
  python=$("$root/tools/setup.sh" --python --print-python)
  [ "$arch" = "$(uname -m)" ] || python=$root/build/deps/linux_$arch/bin/release-python
  rm -rf -- "$root/build/stubs_$arch"
  mkdir -p "$root/build/stubs_$arch"
  cp -r "$root/python/retarget" "$package"
  cp -r "$tree/lib" "$tree/share" "$package/"
  cp "$modules"/_retarget.*.so "$package/"
  env PYTHONPATH="$root/build/stubs_$arch:$root/build/deps/python" PYTHONDONTWRITEBYTECODE=1 \
    "$python" "$root/python/stubs/make_stubs.py" "$package"
  cp "$package"/*.pyi "$modules/"
}

# A release has no headers: its library uses clang's C++ library, which programs of other compilers cannot link.
prune() {
  cp -r "$tree" "$1"
  rm -rf -- "$1"/include "$1"/lib/cmake "$1"/lib/retarget/include "$1"/lib/libretarget.so
}

make_archive() {
  local arch=$1 name=retarget-$version-linux-$1
  rm -rf -- "$work/archive"
  mkdir "$work/archive"
  prune "$work/archive/$name"
  tar -C "$work/archive" --sort=name "--mtime=@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner -cf - "$name" |
    gzip -9n >"$out/$name.tar.gz"
}

make_debian() {
  local arch=$1 debian=amd64 package
  [ "$arch" = x86_64 ] || debian=arm64
  package=$work/debian
  rm -rf -- "$package"
  mkdir -p "$package/DEBIAN"
  prune "$package/usr"
  find "$package/usr/share/man" -type f -exec gzip -9n {} +
  cat >"$package/DEBIAN/control" <<CODE
Package: retarget
Version: $version
Architecture: $debian
Maintainer: ${RETARGET_PACKAGE_CONTACT:-retarget contributors <contributors@retarget.invalid>}
Section: science
Priority: optional
Depends: libc6 (>= $glibc)
Installed-Size: $(du -sk --apparent-size "$package/usr" | cut -f1)
Description: human motion capture to joint trajectories of humanoid robots
 The command retarget, its library, MuJoCo, and the data of 19 robots.
CODE
  dpkg-deb --root-owner-group -Zxz --build "$package" "$out/retarget_${version}_$debian.deb" >/dev/null
}

make_wheel() {
  local arch=$1 wheel
  rm -f -- "$out"/retarget-*"$arch.whl"
  "$tools/bin/python" "$root/tools/make_wheel.py" --tree "$tree" --modules "$modules" --arch "$arch" --glibc "$glibc" -o "$out"
  wheel=$(echo "$out"/retarget-*"$arch.whl")
  # auditwheel knows the symbols that each level may use.
  "$tools/bin/auditwheel" show "$wheel" | grep -F "manylinux_${glibc/./_}_$arch" >/dev/null ||
    fail "auditwheel does not accept $wheel as manylinux_${glibc/./_}: $("$tools/bin/auditwheel" show "$wheel")"
  [ "$(stat -c %s "$wheel")" -lt "$kMaxWheelBytes" ] || fail "$wheel has more than $kMaxWheelBytes bytes"
}

# The robots without a licence, with the commit's time for every entry.
make_robots() {
  "$tools/bin/python" - "$root" "$out/retarget-robots-unverified.zip" <<'CODE'
import os, pathlib, sys, time, zipfile
root, output = map(pathlib.Path, sys.argv[1:])
date = time.gmtime(int(os.environ["SOURCE_DATE_EPOCH"]))[:6]
with zipfile.ZipFile(output, "w", zipfile.ZIP_DEFLATED) as archive:
    for file in sorted(root.glob("robots/unverified/**/*")):
        if file.is_file():
            entry = zipfile.ZipInfo(str(file.relative_to(root)), date)
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, file.read_bytes(), zipfile.ZIP_DEFLATED)
CODE
}

"$root/tools/setup.sh" --tool --python
# The newest of the chosen versions also runs the tools.
tool_python=$(printf '%s\n' "${pythons[@]}" | sort -V | tail -n 1)
work=$(mktemp -d)
trap 'rm -rf -- "$work"' EXIT
mkdir -p "$out"
prepare_tools
for arch in "${architectures[@]}"; do
  tree=$root/build/release_tree/$arch modules=$root/build/release_modules/$arch
  "$root/tools/release_toolchain.sh" "$arch"
  build_engine "$arch"
  build_modules "$arch"
  make_stubs "$arch"
  make_archive "$arch"
  make_debian "$arch"
  make_wheel "$arch"
  "$tools/bin/python" "$root/tools/sbom.py" "$arch" >"$out/retarget-$version-linux-$arch.cdx.json"
done
make_robots
(cd -- "$out" && LC_ALL=C sha256sum retarget* >SHA256SUMS)
if $with_tests; then
  for arch in "${architectures[@]}"; do "$root/tools/release_test.sh" "$arch"; done
fi
say "made in build/release_artifacts:"
(cd -- "$out" && ls -l) >&2
