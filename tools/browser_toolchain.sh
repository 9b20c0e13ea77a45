#!/usr/bin/env bash
# Installs the toolchain of the browser build in build/deps/wasm: compiler, C++ library, and the libraries that
# the engine links, compiled for WebAssembly.
#
#   tools/browser_toolchain.sh [--check]
#
#   --check  install nothing; exit with 1 if the toolchain is missing or was made by other versions of these files
#
# The compiler is a Python wheel (tools/zig.txt). Its own C++ library for WebAssembly has no exceptions, mutexes or
# files, so libc++ is compiled here from the sources in the wheel with all three; threads exist but never start.
# zlib, libzip and tinyxml2 come as Debian sources (tools/browser_sources.txt) from the mirrors of this machine's
# apt. All downloads are checked by their SHA-256.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
deps=$root/build/deps/wasm
made_by=$(cat "$root"/tools/{browser_toolchain.sh,zig.txt,browser_sources.txt} | sha256sum | cut -d' ' -f1)

say() { echo "browser_toolchain: $*" >&2; }

is_ready() { [ "$(cat "$deps/made_by" 2>/dev/null)" = "$made_by" ]; }

if is_ready; then exit 0; fi
if [ "${1:-}" = --check ]; then exit 1; fi

python=$("$root/tools/setup.sh" --python --print-python)
# Old tools could be mixed with new libraries.
rm -rf -- "$deps"
mkdir -p "$deps"/{bin,include,lib,objects,sources,cache}

fetch_compiler() {
  say "fetching the compiler (tools/zig.txt, 100 MB)"
  "$python" -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes --only-binary :all: \
    --target "$deps/wheel" -r "$root/tools/zig.txt"
  # ccache and CMake expect programs, not subcommands.
  local flags="--target=wasm32-wasip1 -msimd128 -nostdinc"
  cat >"$deps/bin/wasm-cc" <<CODE
#!/usr/bin/env bash
# Compiles C for WebAssembly.
zig=$deps/wheel/ziglang
exec "\$zig/zig" clang $flags -D_WASI_EMULATED_SIGNAL -D_WASI_EMULATED_PROCESS_CLOCKS -D_WASI_EMULATED_GETPID \\
  -D_WASI_EMULATED_MMAN -isystem "\$zig/lib/include" -isystem "\$zig/lib/libc/include/wasm-wasi-musl" \\
  -isystem "\$zig/lib/libc/include/generic-musl" "\$@"
CODE
  cat >"$deps/bin/wasm-c++" <<CODE
#!/usr/bin/env bash
# Compiles C++ for WebAssembly; without -c, links objects.
export ZIG_GLOBAL_CACHE_DIR=$deps/cache ZIG_LOCAL_CACHE_DIR=$deps/cache
zig=$deps/wheel/ziglang
compiles=
for argument; do
  case \$argument in -c | -E | -S | -fsyntax-only | --version | -v | -dumpversion) compiles=1 ;; esac
done
if [ -z "\$compiles" ]; then
  exec "\$zig/zig" cc -target wasm32-wasi "\$@" $deps/lib/libc++.a \\
    -lwasi-emulated-signal -lwasi-emulated-process-clocks -lwasi-emulated-getpid
fi
exec "\$zig/zig" clang $flags -fwasm-exceptions -include $deps/include/libcxx_settings.h \\
  -isystem $deps/include \\
  -isystem "\$zig/lib/libcxx/include" -isystem "\$zig/lib/libcxxabi/include" -isystem "\$zig/lib/libunwind/include" \\
  -isystem "\$zig/lib/include" -isystem "\$zig/lib/libc/include/wasm-wasi-musl" \\
  -isystem "\$zig/lib/libc/include/generic-musl" "\$@"
CODE
  local tool
  for tool in ar ranlib; do
    printf '#!/usr/bin/env bash\nexec %q %s "$@"\n' "$deps/wheel/ziglang/zig" "$tool" >"$deps/bin/wasm-$tool"
  done
  chmod +x "$deps"/bin/*
  # The wheel has no __config_site: its own driver passes these definitions.
  cat >"$deps/include/libcxx_settings.h" <<'CODE'
#pragma once
#define _LIBCPP_ABI_VERSION 1
#define _LIBCPP_ABI_NAMESPACE __1
#define _LIBCPP_HAS_THREADS 1
#define _LIBCPP_HAS_THREAD_API_PTHREAD 1
#define _LIBCPP_HAS_THREAD_API_EXTERNAL 0
#define _LIBCPP_HAS_THREAD_API_WIN32 0
#define _LIBCPP_HAS_THREAD_API_C11 0
#define _LIBCPP_HAS_MONOTONIC_CLOCK 1
#define _LIBCPP_HAS_TERMINAL 0
#ifndef _LIBCPP_HAS_MUSL_LIBC
#define _LIBCPP_HAS_MUSL_LIBC 1
#endif
#define _LIBCPP_DISABLE_VISIBILITY_ANNOTATIONS
#define _LIBCPP_HAS_VENDOR_AVAILABILITY_ANNOTATIONS 0
#define _LIBCPP_HAS_FILESYSTEM 1
#define _LIBCPP_HAS_RANDOM_DEVICE 1
#define _LIBCPP_HAS_LOCALIZATION 1
#define _LIBCPP_HAS_UNICODE 1
#define _LIBCPP_HAS_WIDE_CHARACTERS 1
#define _LIBCPP_HAS_TIME_ZONE_DATABASE 0
#define _LIBCPP_PSTL_BACKEND_SERIAL
#define _LIBCPP_HARDENING_MODE_DEFAULT _LIBCPP_HARDENING_MODE_NONE
#define _LIBCPP_HARDENING_MODE _LIBCPP_HARDENING_MODE_NONE
#define _LIBCPP_ASSERTION_SEMANTIC_DEFAULT _LIBCPP_ASSERTION_SEMANTIC_IGNORE
#define _LIBCPP_HAS_NO_STD_MODULES
CODE
}

# compile_all COMPILER FLAGS... < FILES: compiles each file to an object named after its path.
compile_all() {
  # shellcheck disable=SC2016  # the inner shell's own words
  xargs -P "${JOBS:-$(nproc)}" -I{} sh -c \
    'file=$1; objects=$2; shift 2; "$@" -c "$file" -o "$objects/$(echo "$file" | tr / _).o"' - {} "$deps/objects" "$@"
}

build_cxx_library() {
  say "compiling libc++"
  local lib=$deps/wheel/ziglang/lib
  local flags=(-std=gnu++23 -O2 -DNDEBUG -w -D_LIBCPP_BUILDING_LIBRARY -DLIBCXX_BUILDING_LIBCXXABI
    -DLIBCXXABI_USE_LLVM_UNWINDER -D_LIBCXXABI_BUILDING_LIBRARY "-I$lib/libcxx/src" "-I$lib/libcxxabi/src"
    "-I$lib/libcxx/libc")
  find "$lib/libcxx/src" "$lib/libcxxabi/src" -name '*.cpp' |
    grep -vE 'cxa_noexception|cxa_thread_atexit|tzdb|time_zone|/pstl/|/experimental/|/support/|operations.cpp' | LC_ALL=C sort |
    compile_all "$deps/bin/wasm-c++" "${flags[@]}"
  # musl declares copy_file_range, but WASI has no such call.
  echo "$lib/libcxx/src/filesystem/operations.cpp" |
    compile_all "$deps/bin/wasm-c++" "${flags[@]}" -D_LIBCPP_HAS_MUSL_LIBC=0
  echo "$lib/libunwind/src/Unwind-wasm.c" |
    compile_all "$deps/bin/wasm-cc" -std=c17 -O2 -w -DNDEBUG -fdeclspec -fwasm-exceptions -D__USING_WASM_EXCEPTIONS__ \
      -D_LIBUNWIND_HIDE_SYMBOLS "-I$lib/libunwind/src" "-I$lib/libunwind/include"
  # The compiler expects the tag of C++ exceptions from the library.
  printf '.globl __cpp_exception\n.tagtype __cpp_exception i32\n__cpp_exception:\n' >"$deps/sources/exception_tag.s"
  "$deps/wheel/ziglang/zig" clang --target=wasm32-wasip1 -c "$deps/sources/exception_tag.s" \
    -o "$deps/objects/exception_tag.o"
  "$deps/bin/wasm-ar" rcs "$deps/lib/libc++.a" "$deps"/objects/*.o
  rm -f -- "$deps"/objects/*.o
}

build_libraries() {
  say "compiling zlib, tinyxml2 and libzip"
  local sources=$deps/sources
  (cd "$sources"/zlib-* && cp zlib.h zconf.h "$deps/include" &&
    printf '%s\n' adler32.c compress.c crc32.c deflate.c inffast.c inflate.c inftrees.c trees.c uncompr.c zutil.c |
    compile_all "$deps/bin/wasm-cc" -O2 -w)
  "$deps/bin/wasm-ar" rcs "$deps/lib/libz.a" "$deps"/objects/*.o && rm -f -- "$deps"/objects/*.o
  (cd "$sources"/tinyxml2-* && cp tinyxml2.h "$deps/include" &&
    echo tinyxml2.cpp | compile_all "$deps/bin/wasm-c++" -O2 -w)
  "$deps/bin/wasm-ar" rcs "$deps/lib/libtinyxml2.a" "$deps"/objects/*.o && rm -f -- "$deps"/objects/*.o
  local folder
  folder=$(echo "$sources"/libzip-[0-9]*)
  # Nothing links during these checks, so each function seems to exist.
  local absent=() name
  for name in _CLOSE _DUP _FDOPEN _FILENO _SETMODE _SNPRINTF _STRDUP _STRICMP _STRTOI64 _STRTOUI64 _UNLINK \
    ARC4RANDOM CLONEFILE EXPLICIT_BZERO EXPLICIT_MEMSET FICLONERANGE GETPROGNAME NULLABLE SETMODE STRICMP; do
    absent+=("-DHAVE_$name=0")
  done
  cmake -S "$folder" -B "$sources/build-libzip" -G Ninja -DCMAKE_TOOLCHAIN_FILE="$root/browser/toolchain.cmake" \
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$deps" -DCMAKE_C_FLAGS="-w -Wno-implicit-function-declaration -I$deps/include" -DBUILD_SHARED_LIBS=OFF \
    "${absent[@]}" -Wno-dev \
    -DENABLE_COMMONCRYPTO=OFF -DENABLE_GNUTLS=OFF -DENABLE_MBEDTLS=OFF -DENABLE_OPENSSL=OFF -DENABLE_BZIP2=OFF \
    -DENABLE_LZMA=OFF -DBUILD_TOOLS=OFF -DBUILD_REGRESS=OFF -DBUILD_EXAMPLES=OFF -DBUILD_DOC=OFF \
    -DZLIB_LIBRARY="$deps/lib/libz.a" -DZLIB_INCLUDE_DIR="$deps/include" >"$sources/libzip.log"
  cmake --build "$sources/build-libzip" --target zip >>"$sources/libzip.log"
  cp "$sources/build-libzip/lib/libzip.a" "$deps/lib"
  cp "$folder/lib/zip.h" "$sources/build-libzip/zipconf.h" "$deps/include"
}

# Header-only libraries of this machine. Its include folder as a whole would hide the C library's headers.
link_headers() {
  local header file
  for header in Eigen/Core nlohmann/json.hpp fmt/format.h tl/expected.hpp; do
    file=$(echo "#include <$header>" | c++ -xc++ -std=c++20 -I/usr/include/eigen3 -M - | tr ' ' '\n' | grep "/$header\$")
    file=${file%%$'\n'*}
    ln -s "${file%/*}" "$deps/include/${header%%/*}"
  done
}

fetch_compiler
link_headers
build_cxx_library
say "fetching the sources of zlib, tinyxml2 and libzip"
"$root/tools/debian_sources.sh" "$root/tools/browser_sources.txt" "$deps/sources"
build_libraries
echo "$made_by" >"$deps/made_by"
say "ready: build/deps/wasm"
