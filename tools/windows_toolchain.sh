#!/usr/bin/env bash
# Installs what the Windows build needs: MinGW-w64 and Wine from Debian, and in build/deps/windows the libraries that
# the tool links, compiled for Windows, and MuJoCo's Windows wheel.
#
#   tools/windows_toolchain.sh [--check]
#
#   --check  install nothing; exit with 1 if something is missing or was made by other versions of these files
#
# zlib, libzip, tinyxml2 and LZ4 come as Debian sources (tools/windows_sources.txt) from the mirrors of this machine's
# apt, header-only libraries and GoogleTest from its packages. All downloads are checked by their SHA-256.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
deps=$root/build/deps/windows
sources=$deps/sources
made_by=$(cat "$root"/tools/{windows_toolchain.sh,windows_sources.txt,mujoco.txt} "$root/cmake/mingw.cmake" | sha256sum | cut -d' ' -f1)
host=x86_64-w64-mingw32
readonly kPackages=(g++-mingw-w64-x86-64-posix wine64 googletest zip)

say() { echo "windows_toolchain: $*" >&2; }

is_ready() {
  [ "$(cat "$deps/made_by" 2>/dev/null)" = "$made_by" ] && command -v "$host-g++-posix" >/dev/null &&
    { [ -x /usr/lib/wine/wine64 ] || command -v wine64 >/dev/null; }
}

if is_ready; then exit 0; fi
if [ "${1:-}" = --check ]; then exit 1; fi

install_packages() {
  local missing=() package
  for package in "${kPackages[@]}"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  local as_root=()
  [ "$(id -u)" -eq 0 ] || as_root=(sudo)
  say "installing with apt-get: ${missing[*]}"
  "${as_root[@]}" apt-get -qq install -y --no-install-recommends "${missing[@]}" >/dev/null </dev/null
}

# The wheel holds the DLL, but no import library for it: MinGW's linker takes the DLL itself.
fetch_mujoco() {
  say "fetching MuJoCo's Windows wheel"
  local python
  python=$("$root/tools/setup.sh" --print-python)
  "$python" -m pip install --quiet --disable-pip-version-check --no-deps --no-compile --only-binary=:all: \
    --platform win_amd64 --python-version 3.11 --require-hashes --requirement "$root/tools/mujoco.txt" \
    --target "$sources/wheel"
  mkdir -p "$deps/mujoco"
  cp -r "$sources/wheel/mujoco/include" "$sources/wheel/mujoco/mujoco.dll" "$deps/mujoco"
  find "$sources/wheel" -path '*.dist-info/*' -name 'LICENSE*' -exec cp {} "$deps/mujoco/" \;
}

# build_static NAME OPTION...: builds and installs a library by its own CMake files.
build_static() {
  local name=$1 log
  shift
  log=$sources/$name.log
  if ! { cmake -S "$sources/$name"-[0-9]* -B "$sources/build-$name" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_TOOLCHAIN_FILE="$root/cmake/mingw.cmake" -DCMAKE_INSTALL_PREFIX="$deps" -DBUILD_SHARED_LIBS=OFF -Wno-dev \
    "$@" && cmake --build "$sources/build-$name" --target install; } >"$log" 2>&1; then
    tail -n 20 "$log" >&2
    return 1
  fi
}

# compile_all ARCHIVE COMPILER FLAGS... < FILES
compile_all() {
  local archive=$1 file objects
  shift
  objects=$(mktemp -d "$sources/objects.XXXXXX")
  while read -r file; do
    "$@" -c "$file" -o "$objects/$(basename "$file").o"
  done
  "$host-ar" rcs "$deps/lib/$archive" "$objects"/*.o
}

build_libraries() {
  say "compiling zlib, tinyxml2, libzip, LZ4 and GoogleTest"
  local cc=("$host-gcc-posix" -O2 -w) cxx=("$host-g++-posix" -O2 -w -std=gnu++20)
  (cd "$sources"/zlib-* && cp zlib.h zconf.h "$deps/include" &&
    printf '%s\n' adler32.c compress.c crc32.c deflate.c inffast.c inflate.c inftrees.c trees.c uncompr.c zutil.c |
    compile_all libz.a "${cc[@]}")
  (cd "$sources"/tinyxml2-* && cp tinyxml2.h "$deps/include" && echo tinyxml2.cpp | compile_all libtinyxml2.a "${cxx[@]}")
  (cd "$sources"/lz4-*/lib && cp lz4.h lz4frame.h lz4hc.h "$deps/include" &&
    printf '%s\n' lz4.c lz4hc.c lz4frame.c xxhash.c | compile_all liblz4.a "${cc[@]}" -DXXH_NAMESPACE=LZ4_)
  build_static libzip -DENABLE_COMMONCRYPTO=OFF -DENABLE_GNUTLS=OFF -DENABLE_MBEDTLS=OFF -DENABLE_OPENSSL=OFF \
    -DENABLE_WINDOWS_CRYPTO=OFF -DENABLE_BZIP2=OFF -DENABLE_LZMA=OFF -DBUILD_TOOLS=OFF -DBUILD_REGRESS=OFF \
    -DBUILD_EXAMPLES=OFF -DBUILD_DOC=OFF -DCMAKE_C_FLAGS=-w
  local google=/usr/src/googletest
  printf '%s\n' "$google"/googletest/src/gtest-all.cc "$google"/googlemock/src/gmock-all.cc |
    compile_all libgtest.a "${cxx[@]}" -I"$google/googletest" -I"$google/googletest/include" -I"$google/googlemock" \
      -I"$google/googlemock/include"
  echo "$google/googlemock/src/gmock_main.cc" |
    compile_all libgtest_main.a "${cxx[@]}" -I"$google/googletest/include" -I"$google/googlemock/include"
  cp -r "$google/googletest/include/gtest" "$google/googlemock/include/gmock" "$deps/include"
}

# package NAME VERSION CODE: a CMake package of a library that needs no more than these lines.
# shellcheck disable=SC2016  # variables of CMake
package() {
  mkdir -p "$deps/lib/cmake/$1"
  printf 'get_filename_component(root "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)\n%s\n' "$3" >"$deps/lib/cmake/$1/$1Config.cmake"
  printf 'set(PACKAGE_VERSION %s)\nset(PACKAGE_VERSION_COMPATIBLE TRUE)\n' "$2" >"$deps/lib/cmake/$1/$1ConfigVersion.cmake"
}

# Header-only libraries of this machine. Its include folder as a whole would hide the C library's headers.
# shellcheck disable=SC2016  # variables of CMake
link_headers() {
  local header file
  for header in Eigen/Core unsupported/Eigen/MatrixFunctions nlohmann/json.hpp fmt/format.h tl/expected.hpp CLI/CLI.hpp; do
    file=$(echo "#include <$header>" | c++ -xc++ -std=c++20 -I/usr/include/eigen3 -M - | tr ' ' '\n' | grep "/$header\$")
    file=${file%%$'\n'*}
    ln -sfn "${file%"/${header#*/}"}" "$deps/include/${header%%/*}"
  done
  local set='INTERFACE_INCLUDE_DIRECTORIES "${root}/include"'
  package Eigen3 3.4.0 "add_library(Eigen3::Eigen INTERFACE IMPORTED)
set_target_properties(Eigen3::Eigen PROPERTIES $set)"
  package nlohmann_json 3.11 "add_library(nlohmann_json::nlohmann_json INTERFACE IMPORTED)
set_target_properties(nlohmann_json::nlohmann_json PROPERTIES $set)"
  package tl-expected 1.0 "add_library(tl::expected INTERFACE IMPORTED)
set_target_properties(tl::expected PROPERTIES $set)"
  package CLI11 2.1.2 "add_library(CLI11::CLI11 INTERFACE IMPORTED)
set_target_properties(CLI11::CLI11 PROPERTIES $set)"
  package fmt 9.1 "add_library(fmt::fmt-header-only INTERFACE IMPORTED)
set_target_properties(fmt::fmt-header-only PROPERTIES $set INTERFACE_COMPILE_DEFINITIONS FMT_HEADER_ONLY=1)"
  package tinyxml2 9.0 "add_library(tinyxml2::tinyxml2 STATIC IMPORTED)
set_target_properties(tinyxml2::tinyxml2 PROPERTIES IMPORTED_LOCATION \"\${root}/lib/libtinyxml2.a\" $set)"
  package GTest 1.12 "foreach(name gtest gmock gtest_main)
  add_library(GTest::\${name} STATIC IMPORTED)
  set_target_properties(GTest::\${name} PROPERTIES IMPORTED_LOCATION \"\${root}/lib/libgtest.a\" $set)
endforeach()
set_target_properties(GTest::gtest_main PROPERTIES IMPORTED_LOCATION \"\${root}/lib/libgtest_main.a\"
  INTERFACE_LINK_LIBRARIES GTest::gtest)"
}

install_packages
# Old tools could be mixed with new libraries.
rm -rf -- "$deps"
mkdir -p "$deps"/{include,lib} "$sources"
fetch_mujoco
link_headers
"$root/tools/debian_sources.sh" "$root/tools/windows_sources.txt" "$sources"
build_libraries
echo "$made_by" >"$deps/made_by"
say "ready: build/deps/windows"
