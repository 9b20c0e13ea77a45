#!/usr/bin/env bash
# Installs in build/deps/linux_ARCH what a release for Linux needs: compiler, libraries, MuJoCo.
#
#   tools/release_toolchain.sh ARCH [--check]     (x86_64 or aarch64)
#
#   --check  install nothing; exit with 1 if something is missing or was made by other versions of these files
#
# The compiler is zig's clang (tools/zig.txt), which compiles for any glibc and links its own libc++ statically; so
# releases run with glibc 2.28 or later. bin/release-run runs a program of ARCH: natively, or with qemu-user and
# Debian's C library (tools/release_sysroot.sh). There bin/release-python is Debian's Python 3.11 with numpy
# (tools/release_numpy.txt).
# All downloads are checked by their SHA-256.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
glibc=$(sed -nE 's/^set\(RETARGET_GLIBC ([0-9.]+)\)/\1/p' "$root/cmake/linux_release.cmake")
arch=$1
deps=$root/build/deps/linux_$arch
compiler=$root/build/deps/zig
made_by=$(cat "$root/cmake/linux_release.cmake" "$root"/tools/{release_toolchain.sh,release_sysroot.sh,zig.txt,mujoco.txt,release_numpy.txt} | sha256sum | cut -d' ' -f1)

say() { echo "release_toolchain: $*" >&2; }

case $arch in
  x86_64 | aarch64) ;;
  *)
    say "unknown architecture $arch (known: x86_64, aarch64)"
    exit 2
    ;;
esac

libraries() {
  "$root/tools/release_libraries.sh" "$deps/usr" "-DCMAKE_TOOLCHAIN_FILE=$root/cmake/linux_release.cmake" \
    "-DRETARGET_ARCH=$arch"
}

if [ "$(cat "$deps/made_by" 2>/dev/null)" = "$made_by" ]; then
  if [ "${2:-}" != --check ]; then libraries; fi
  exit 0
fi
if [ "${2:-}" = --check ]; then exit 1; fi

python=$("$root/tools/setup.sh" --print-python)
pip_fetch() {
  "$python" -m pip install --quiet --disable-pip-version-check --no-deps --no-compile --only-binary=:all: \
    --require-hashes "$@"
}

fetch_compiler() {
  cmp -s "$root/tools/zig.txt" "$compiler/pinned" && return 0
  say "fetching the compiler (tools/zig.txt, 100 MB)"
  rm -rf -- "$compiler"
  pip_fetch --target "$compiler" --requirement "$root/tools/zig.txt"
  cp "$root/tools/zig.txt" "$compiler/pinned"
}

# CMake and ccache expect programs, not subcommands.
write_wrappers() {
  local tool
  mkdir -p "$deps/bin"
  for tool in cc c++; do
    cat >"$deps/bin/release-$tool" <<CODE
#!/usr/bin/env bash
# Compiles for Linux on $arch with glibc $glibc or later.
export ZIG_GLOBAL_CACHE_DIR=$compiler/cache ZIG_LOCAL_CACHE_DIR=$compiler/cache
exec $compiler/ziglang/zig $tool -target $arch-linux-gnu.$glibc "\$@"
CODE
  done
  for tool in ar ranlib; do
    printf '#!/usr/bin/env bash\nexec %q %s "$@"\n' "$compiler/ziglang/zig" "$tool" >"$deps/bin/release-$tool"
  done
  {
    echo '#!/usr/bin/env bash'
    if [ "$arch" = "$(uname -m)" ]; then
      echo 'exec "$@"'
    else
      printf 'exec qemu-%s-static -L %q "$@"\n' "$arch" "$deps/sysroot"
    fi
  } >"$deps/bin/release-run"
  chmod +x "$deps"/bin/*
}

# Prepares a machine for programs of another processor: qemu-user, Debian's C library and Python, and numpy for it.
prepare_foreign() {
  if ! command -v "qemu-$arch-static" >/dev/null; then
    local as_root=()
    [ "$(id -u)" -eq 0 ] || as_root=(sudo)
    say "installing with apt-get: qemu-user-static"
    "${as_root[@]}" apt-get -qq install -y --no-install-recommends qemu-user-static >/dev/null </dev/null
  fi
  "$root/tools/release_sysroot.sh" "$arch" "$deps/sysroot"
  rm -rf -- "$deps/numpy"
  pip_fetch --target "$deps/numpy" --implementation cp --python-version 3.11 --platform "manylinux_2_28_$arch" \
    --requirement "$root/tools/release_numpy.txt"
  {
    echo '#!/usr/bin/env bash'
    # shellcheck disable=SC2016  # the wrapper's own words
    printf 'export PYTHONPATH=%q${PYTHONPATH:+:$PYTHONPATH} PYTHONDONTWRITEBYTECODE=1\n' "$deps/numpy"
    printf 'exec %q %q "$@"\n' "$deps/bin/release-run" "$deps/sysroot/usr/bin/python3.11"
  } >"$deps/bin/release-python"
  chmod +x "$deps/bin/release-python"
}

fetch_mujoco() {
  say "fetching MuJoCo for $arch"
  rm -rf -- "$deps/wheel" "$deps/mujoco"
  pip_fetch --target "$deps/wheel" --python-version 3.11 --platform "manylinux_2_28_$arch" --platform "manylinux_2_27_$arch" \
    --platform "manylinux_2_17_$arch" --platform "manylinux2014_$arch" --requirement "$root/tools/mujoco.txt"
  mkdir -p "$deps/mujoco"
  mv "$deps"/wheel/mujoco/{include,libmujoco.so.*} "$deps/mujoco"
  find "$deps/wheel" -path '*.dist-info/*' -name 'LICENSE*' -exec cp {} "$deps/mujoco/" \;
  rm -rf -- "$deps/wheel"
}

fetch_compiler
write_wrappers
fetch_mujoco
[ "$arch" = "$(uname -m)" ] || prepare_foreign
libraries
echo "$made_by" >"$deps/made_by"
say "ready: build/deps/linux_$arch"
