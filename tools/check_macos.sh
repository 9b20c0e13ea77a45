#!/usr/bin/env bash
# Checks that every source of the library and the tool compiles for macOS on ARM64, on any Linux machine.
#
#   tools/check_macos.sh
#
# The compiler is a Python wheel (tools/zig.txt) that contains the C and C++ headers of macOS. Nothing is linked and
# nothing runs: the check only shows that the code uses nothing that macOS lacks. JOBS: the number of processes.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
jobs=${JOBS:-$(nproc)}
folder=$root/build/macos
zig=
for place in "$root/build/deps/wasm/wheel/ziglang" "$folder/wheel/ziglang"; do
  if [ -x "$place/zig" ]; then zig=$place/zig; fi
done
if [ -z "$zig" ]; then
  echo "check_macos: fetching the compiler (tools/zig.txt, 100 MB)" >&2
  "$("$root/tools/setup.sh" --python --print-python)" -m pip install --quiet --disable-pip-version-check --no-deps \
    --require-hashes --only-binary :all: --target "$folder/wheel" -r "$root/tools/zig.txt"
  zig=$folder/wheel/ziglang/zig
fi

# Headers of this machine's libraries. Its include folder as a whole would hide those of the C library.
rm -rf -- "$folder/include" "$folder/units"
mkdir -p "$folder"/{include,units,generated}
for header in Eigen/Core nlohmann/json.hpp fmt/format.h tl/expected.hpp CLI/CLI.hpp hiredis/hiredis.h; do
  file=$(echo "#include <$header>" | c++ -xc++ -std=c++20 -I/usr/include/eigen3 -M - | tr ' ' '\n' | grep "/$header\$")
  file=${file%%$'\n'*}
  mkdir -p "$folder/include/${header%%/*}"
  cp -r "${file%/*}/." "$folder/include/${header%%/*}"
done
for header in zlib.h zconf.h zip.h zipconf.h tinyxml2.h lz4frame.h lz4.h zmq.h; do
  file=$(echo "#include <$header>" | c++ -xc++ -M - | tr ' ' '\n' | grep "/$header\$")
  cp "${file%%$'\n'*}" "$folder/include/$header"
done
cmake -DSOURCE="$root" -DVERSION=0.0.0 -DOUTPUT="$folder/generated/build_facts.h" -P "$root/cmake/write_build_facts.cmake"

# One unit per folder, as in unity builds: names in a folder do not clash.
cd -- "$root"
while read -r file; do
  room=$(dirname "$file")
  echo "#include \"$root/$file\"" >>"$folder/units/${room//\//_}.cpp"
done < <(find src tools/retarget -name '*.cpp' ! -name '*_win32.cpp' ! -name main.cpp | LC_ALL=C sort)
echo "#include \"$root/tools/retarget/main.cpp\"" >"$folder/units/main.cpp"

# The compiler's own driver always writes an object, so the include folders are given here. It also passes what
# libc++ expects of a header __config_site, which the wheel lacks.
lib=${zig%/*}/lib
for setting in ABI_VERSION:1 ABI_NAMESPACE:__1 HAS_THREADS:1 HAS_THREAD_API_PTHREAD:1 HAS_THREAD_API_EXTERNAL:0 \
  HAS_THREAD_API_WIN32:0 HAS_THREAD_API_C11:0 HAS_MONOTONIC_CLOCK:1 HAS_TERMINAL:0 HAS_MUSL_LIBC:0 \
  HAS_VENDOR_AVAILABILITY_ANNOTATIONS:0 HAS_FILESYSTEM:1 HAS_RANDOM_DEVICE:1 HAS_LOCALIZATION:1 HAS_UNICODE:1 \
  HAS_WIDE_CHARACTERS:1 HAS_TIME_ZONE_DATABASE:0 PSTL_BACKEND_SERIAL: \
  HARDENING_MODE_DEFAULT:_LIBCPP_HARDENING_MODE_NONE ASSERTION_SEMANTIC_DEFAULT:_LIBCPP_ASSERTION_SEMANTIC_IGNORE; do
  echo "#define _LIBCPP_${setting/:/ }"
done >"$folder/generated/libcxx_settings.h"

# shellcheck disable=SC2016  # the inner shell's own words
find "$folder/units" -name '*.cpp' -print0 | xargs -0 -P "$jobs" -I{} sh -c \
  'file=$1; shift; "$@" "$file" || { echo "check_macos: $file" >&2; exit 255; }' - {} \
  "$zig" clang --target=aarch64-macos.13.0 -nostdinc -std=gnu++20 -fsyntax-only -fcxx-exceptions -fexceptions \
  -Wall -Wextra -Werror -DFMT_HEADER_ONLY=1 -DRETARGET_HAS_LZ4 -DRETARGET_HAS_ZEROMQ -DRETARGET_HAS_HIREDIS \
  -DEIGEN_MAX_ALIGN_BYTES=16 -include "$folder/generated/libcxx_settings.h" \
  -I"$root/include" -I"$root/src" -I"$root/tools/retarget" -I"$folder/generated" \
  -isystem "$folder/include" -isystem "$root/build/deps/mujoco/include" -isystem "$root/third_party" \
  -isystem "$lib/libcxx/include" -isystem "$lib/libcxxabi/include" -isystem "$lib/include" \
  -isystem "$lib/libc/include/any-darwin-any"
echo "check_macos: $(find src tools/retarget -name '*.cpp' ! -name '*_win32.cpp' | wc -l) sources compile for macOS" >&2
