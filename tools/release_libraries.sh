#!/usr/bin/env bash
# Compiles the third-party libraries of a release as static libraries, for any compiler.
#
#   tools/release_libraries.sh PREFIX CMAKE_ARGUMENT...     (-DCMAKE_TOOLCHAIN_FILE=..., -DCMAKE_C_COMPILER=...)
#
# Writes PREFIX/include, PREFIX/lib and CMake packages there: zlib, LZ4, hiredis, tinyxml2, libzip and, unless
# WITHOUT_ZEROMQ=1, libzmq, from Debian's sources (tools/release_sources.txt), and the header-only libraries of this
# machine. Does nothing if PREFIX was made by the same files and arguments. SOURCES: where the sources are unpacked
# (default: build/deps/sources), for several compilers.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
prefix=$(realpath -m -- "$1")
shift
arguments=("$@" -G Ninja -DCMAKE_BUILD_TYPE=Release "-DCMAKE_INSTALL_PREFIX=$prefix" -Wno-dev)
sources=${SOURCES:-$root/build/deps/sources}
list=$root/tools/release_sources.txt
made_by=$({ cat "$root"/tools/{release_libraries.sh,release_libraries/CMakeLists.txt,release_sources.txt} && echo "$@"; } |
  sha256sum | cut -d' ' -f1)

say() { echo "release_libraries: $*" >&2; }

[ "$(cat "$prefix/made_by" 2>/dev/null)" != "$made_by" ] || exit 0

fetch() {
  cmp -s "$list" "$sources/list" && return 0
  say "fetching the sources of zlib, LZ4, hiredis, tinyxml2, libzip and libzmq"
  rm -rf -- "$sources"
  "$root/tools/debian_sources.sh" "$list" "$sources"
  # The only archive with Debian's changes is that of hiredis.
  patch --quiet -d "$sources"/hiredis-[0-9]* -p1 <"$(echo "$sources"/debian/patches/*CVE-2021-32765.patch)"
  # That patch widens a parameter; the type of the pointer to this function must match.
  sed -i 's/\(createArray)(const redisReadTask\*, \)int/\1size_t/' "$sources"/hiredis-[0-9]*/read.h
  cp "$list" "$sources/list"
}

# build NAME SOURCE ARGUMENT...: configures, compiles and installs
build() {
  local name=$1 source=$2 folder=$prefix/build/$1
  shift 2
  say "compiling $name"
  mkdir -p "$folder"
  { cmake -S "$source" -B "$folder" "${arguments[@]}" "$@" && cmake --build "$folder" --parallel "${JOBS:-$(nproc)}" &&
    cmake --install "$folder"; } >"$folder.log" 2>&1 || {
    tail -n 30 "$folder.log" >&2
    return 1
  }
}

fetch
# Old headers could be mixed with new libraries.
rm -rf -- "$prefix"
mkdir -p "$prefix"
build libraries "$root/tools/release_libraries" "-DRELEASE_SOURCES=$sources"
common=(-DBUILD_SHARED_LIBS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON
  "-DCMAKE_C_FLAGS=-w -ffunction-sections -fvisibility=hidden"
  "-DCMAKE_CXX_FLAGS=-w -ffunction-sections -fvisibility=hidden")
build libzip "$(echo "$sources"/libzip-[0-9]*)" "${common[@]}" "-DZLIB_INCLUDE_DIR=$prefix/include" \
  "-DZLIB_LIBRARY=$prefix/lib/libz.a" -DENABLE_COMMONCRYPTO=OFF -DENABLE_GNUTLS=OFF -DENABLE_MBEDTLS=OFF \
  -DENABLE_OPENSSL=OFF -DENABLE_WINDOWS_CRYPTO=OFF -DENABLE_BZIP2=OFF -DENABLE_LZMA=OFF -DBUILD_TOOLS=OFF \
  -DBUILD_REGRESS=OFF -DBUILD_EXAMPLES=OFF -DBUILD_DOC=OFF
# Omits everything that would need a further library: encryption and WebSockets.
[ "${WITHOUT_ZEROMQ:-}" = 1 ] ||
  build libzmq "$(echo "$sources"/libzmq-[0-9]*)" "${common[@]}" -DBUILD_SHARED=OFF -DBUILD_STATIC=ON -DBUILD_TESTS=OFF \
    -DZMQ_BUILD_TESTS=OFF -DWITH_PERF_TOOL=OFF -DWITH_DOCS=OFF -DWITH_LIBSODIUM=OFF -DENABLE_CURVE=OFF -DWITH_TLS=OFF \
    -DENABLE_WS=OFF -DWITH_LIBBSD=OFF -DENABLE_DRAFTS=OFF -DENABLE_CPACK=OFF -DWITH_OPENPGM=OFF -DWITH_NORM=OFF
echo "$made_by" >"$prefix/made_by"
say "ready: $prefix"
