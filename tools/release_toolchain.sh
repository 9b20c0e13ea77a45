#!/usr/bin/env bash
# Installs in build/deps/linux_ARCH what a release for Linux needs: compiler, libraries, MuJoCo.
#
#   tools/release_toolchain.sh ARCH [--check]     (x86_64 or aarch64)
#
#   --check  install nothing; exit with 1 if something is missing or was made by other versions of these files
#
# The compiler is zig's clang (tools/zig.txt), which compiles for any glibc and links its own libc++ statically; so
# releases run with glibc 2.28 or later. bin/release-run runs a program of ARCH: natively, or with qemu-user and
# Debian's C library (tools/release_sysroot.sh).
# All downloads are checked by their SHA-256.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
glibc=$(sed -nE 's/^set\(RETARGET_GLIBC ([0-9.]+)\)/\1/p' "$root/cmake/linux_release.cmake")
arch=$1
deps=$root/build/deps/linux_$arch
compiler=$root/build/deps/zig
made_by=$(cat "$root/cmake/linux_release.cmake" "$root"/tools/{release_toolchain.sh,zig.txt,mujoco.txt} | sha256sum | cut -d' ' -f1)

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
[ "$arch" = "$(uname -m)" ] || "$root/tools/release_sysroot.sh" "$arch" "$deps/sysroot"
libraries
echo "$made_by" >"$deps/made_by"
say "ready: build/deps/linux_$arch"
