#!/usr/bin/env bash
# Installs the dependencies for building and testing retarget.
#
#   tools/setup.sh [--dev | --tool] [--python] [--package] [--check | --print-python] [--older-mujoco]
#
#   --dev           also tools for developers: clang, clang-tidy, clang-format, ccache, Google Benchmark
#   --tool          only the dependencies of the tool, without libraries for tests
#   --python        also dependencies of the Python module and its tests: Python's headers, and
#                   nanobind, pytest and clients of streams as wheels in build/deps/python (tools/python.txt),
#                   Ray and readers of data sets in build/deps/data_sets (tools/data_sets.txt),
#                   what builds the site of the documentation in build/deps/docs (tools/docs.txt)
#   --package       also the packages that CPack needs for a .deb
#   --print-python  install nothing; print the chosen Python
#   --check         install nothing; list missing packages and exit with 1 if there are any
#   --older-mujoco  MuJoCo 3.3.7 instead of 4.0.0, for package indexes that lack the latter
#
# Debian and Ubuntu: installs packages with apt-get, as root or with sudo. Other systems: lists the missing
# packages. MuJoCo is installed from a wheel into build/deps/mujoco, checked by the SHA-256 of
# tools/mujoco.txt, unless MuJoCo_ROOT (or MUJOCO_DIR, mujoco_DIR) names an existing one. If exactly this
# wheel is not available, nothing is installed. Safe to repeat: existing packages do not change.
#
# Tests and module use one Python: RETARGET_PYTHON if it is set, otherwise the first of PYTHON, python3 and
# /usr/bin/python3 that lacks nothing, otherwise the last, which the packages complete.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)

# The wheel serves as the SDK: only its shared library and headers are used. They do not depend on the
# Python version, so the wheel of one version serves all.
readonly kMujocoVersion=4.0.0
readonly kOlderMujocoVersion=3.3.7
readonly kMujocoPython=3.11

# Debian package | Fedora | Arch | Homebrew | command that succeeds if it is installed
readonly kPackages='
g++                | gcc-c++        | gcc           | gcc           | has_compiler
cmake              | cmake          | cmake         | cmake         | has_cmake
ninja-build        | ninja-build    | ninja         | ninja         | has_command ninja
libeigen3-dev      | eigen3-devel   | eigen         | eigen         | has_header eigen3/Eigen/Core Eigen/Core
nlohmann-json3-dev | json-devel     | nlohmann-json | nlohmann-json | has_header nlohmann/json.hpp
libcli11-dev       | cli11-devel    | cli11         | cli11         | has_header CLI/CLI.hpp
libfmt-dev         | fmt-devel      | fmt           | fmt           | has_header fmt/format.h
libexpected-dev    | expected-devel | tl-expected   | tl-expected   | has_header tl/expected.hpp
zlib1g-dev         | zlib-devel     | zlib          | zlib          | has_header zlib.h
libzip-dev         | libzip-devel   | libzip        | libzip        | has_header zip.h
libtinyxml2-dev    | tinyxml2-devel | tinyxml2      | tinyxml2      | has_header tinyxml2.h
liblz4-dev         | lz4-devel      | lz4           | lz4           | has_header lz4frame.h
libzmq3-dev        | zeromq-devel   | zeromq        | zeromq        | has_header zmq.h
libhiredis-dev     | hiredis-devel  | hiredis       | hiredis       | has_header hiredis/hiredis.h
python3            | python3        | python        | python        | has_command python3
python3-pip        | python3-pip    | python-pip    | python        | has_pip_or_no_need
'
readonly kTestPackages='
libgtest-dev       | gtest-devel    | gtest         | googletest    | has_header gtest/gtest.h
libgmock-dev       | gmock-devel    | gtest         | googletest    | has_header gmock/gmock.h
python3-numpy      | python3-numpy  | python-numpy  | numpy         | has_numpy
chromium           | chromium       | chromium      | chromium      | has_command chromium chromium-browser google-chrome
redis-server       | valkey         | valkey        | redis         | has_command redis-server valkey-server
'
readonly kPythonPackages='
python3-dev        | python3-devel  | python        | python        | has_python_headers
python3-venv       | python3        | python        | python        | has_venv
'
readonly kPackagingPackages='
file               | file           | file          | file-formula  | has_command file
dpkg-dev           | dpkg-dev       | dpkg          | dpkg          | has_command dpkg-shlibdeps
'
readonly kDeveloperPackages='
ccache             | ccache           | ccache    | ccache           | has_command ccache
clang-14           | clang            | clang     | llvm             | has_command clang++-14 clang++
clang-tidy-14      | clang-tools-extra | clang    | llvm             | has_command clang-tidy-14 clang-tidy
clang-format-14    | clang-tools-extra | clang    | llvm             | has_command clang-format-14 clang-format
libclang-rt-14-dev | compiler-rt      | compiler-rt | llvm           | has_clang_runtime
libbenchmark-dev   | google-benchmark-devel | benchmark | google-benchmark | has_header benchmark/benchmark.h
npm                | nodejs-npm     | npm           | node          | has_command npm
shellcheck         | ShellCheck       | shellcheck | shellcheck      | has_command shellcheck
'

readonly kWithoutPython='To leave the Python module out: RETARGET_NO_PYTHON=1 tools/test.sh'

say() { printf 'setup: %s\n' "$*" >&2; }

# --- installed software ----------------------------------------------------------------------

has_command() {
  local name
  for name; do
    command -v "$name" >/dev/null 2>&1 && return 0
  done
  return 1
}

# version_at_least HAVE WANTED
version_at_least() { [ "$(printf '%s\n' "$2" "$1" | sort -V | head -n 1)" = "$2" ]; }

has_compiler() {
  local compiler
  for compiler in "${CXX:-}" c++ g++ clang++; do
    has_command "$compiler" || continue
    "$compiler" -std=c++20 -fsyntax-only -x c++ - >/dev/null 2>&1 <<'CODE' && return 0
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ < 11
#error too old
#endif
#include <concepts>
#include <span>
CODE
  done
  return 1
}

has_cmake() { has_command cmake && version_at_least "$(cmake_version)" 3.22; }
cmake_version() { cmake --version | sed -n '1s/[^0-9]*\([0-9.]*\).*/\1/p'; }

has_header() {
  local places folder header
  IFS=: read -ra places <<<"${CPATH:-}:${CPLUS_INCLUDE_PATH:-}"
  for folder in /usr /usr/local /opt/homebrew $(tr ':;' '  ' <<<"${CMAKE_PREFIX_PATH:-}"); do
    places+=("$folder/include")
  done
  for folder in "${places[@]}"; do
    for header; do
      [ -n "$folder" ] && [ -e "$folder/$header" ] && return 0
    done
  done
  return 1
}

# can PYTHON CODE: succeeds if PYTHON can run CODE.
can() { has_command "$1" && "$1" -c "$2" >/dev/null 2>&1; }

# Prints the first Python that can run `python -c CODE`.
python_that_can() {
  local python
  for python in ${RETARGET_PYTHON:+"$RETARGET_PYTHON"} ${PYTHON:+"$PYTHON"} python3 /usr/bin/python3; do
    if can "$python" "$1"; then
      printf '%s\n' "$python"
      return 0
    fi
  done
  return 1
}

# Code that the chosen Python must be able to run.
readonly kNumpy='import numpy'
readonly kPip='import pip'
readonly kVenv='import ensurepip'
readonly kHeaders='import os, sys, sysconfig
sys.exit(sys.version_info < (3, 10) or not os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h")))'

# choose_python: sets chosen_python, depending on with_tests and with_python.
choose_python() {
  local python candidates codes=()
  if $with_tests; then codes+=("$kNumpy"); fi
  if $with_python; then codes+=("$kHeaders" "$kVenv" "$kPip"); fi
  candidates=(${PYTHON:+"$PYTHON"} python3 /usr/bin/python3)
  [ -z "${RETARGET_PYTHON:-}" ] || candidates=("$RETARGET_PYTHON")
  for python in "${candidates[@]}"; do
    # Use the interpreter itself: a shim chooses one by the working directory.
    chosen_python=$("$python" -c 'import sys; print(sys.executable)' 2>/dev/null) || chosen_python=$python
    ! can_all "$chosen_python" "${codes[@]}" || return 0
  done
}

can_all() {
  local code
  for code in "${@:2}"; do
    can "$1" "$code" || return 1
  done
}

has_numpy() { can "$chosen_python" "$kNumpy"; }
has_python_headers() { can "$chosen_python" "$kHeaders"; }
has_venv() { can "$chosen_python" "$kVenv"; }

# Any pip can fetch MuJoCo, but the pip of the chosen Python must evaluate the tools' version markers.
has_pip_or_no_need() {
  if $with_python && ! has_python_tools; then
    can "$chosen_python" "$kPip"
  else
    has_mujoco || python_that_can "$kPip" >/dev/null
  fi
}

# The exact versions of tools/python.txt, without those for older Pythons only.
has_python_tools() {
  local requirement older_than version
  version=$("$chosen_python" -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>/dev/null) || return 1
  while read -r requirement older_than; do
    if [ -z "$older_than" ] || ! version_at_least "$version" "$older_than"; then
      [ -d "$root/build/deps/python/${requirement/==/-}.dist-info" ] || return 1
    fi
  done < <(sed -nE 's/^([a-z_]+==[0-9.]+)( *; *python_version < "([0-9.]+)")? *\\$/\1 \3/p' "$root/tools/python.txt")
}

has_clang_runtime() {
  local files=(/usr/lib/llvm-*/lib/clang/*/lib/linux/libclang_rt.fuzzer-*.a
    /usr/lib*/clang/*/lib/*/libclang_rt.fuzzer*.a)
  local file
  for file in "${files[@]}"; do
    [ -e "$file" ] && return 0
  done
  return 1
}

own_mujoco() { printf '%s' "${MuJoCo_ROOT:-${MUJOCO_DIR:-${mujoco_DIR:-}}}"; }

has_mujoco() {
  [ -n "$(own_mujoco)" ] && return 0
  local folder=$root/build/deps/mujoco version
  [ -e "$folder/include/mujoco/mujoco.h" ] || return 1
  for version in "$kMujocoVersion" "$kOlderMujocoVersion"; do
    [ -e "$folder/libmujoco.so.$version" ] || [ -e "$folder/libmujoco.$version.dylib" ] && return 0
  done
  return 1
}

# --- packages --------------------------------------------------------------------------------

# Prints the rows of kPackages (and kDeveloperPackages) whose check fails.
missing_rows() {
  local row check
  while IFS= read -r row; do
    [ -n "$row" ] || continue
    read -ra check <<<"${row##*|}"
    "${check[@]}" || printf '%s\n' "$row"
  done <<<"$1"
}

# Prints column N of the rows on one line, each name once.
names() { awk -F'|' -v n="$1" '{gsub(/ /, "", $n); if (!seen[$n]++) printf "%s%s", sep, $n; sep=" "}' <<<"$2"; }

cannot_install() {
  say "cannot install: $1"
  list_missing "$2"
}

list_missing() {
  {
    echo "Missing packages:"
    echo "  Debian, Ubuntu: apt-get install $(names 1 "$1")"
    echo "  Fedora:         dnf install $(names 2 "$1")"
    echo "  Arch:           pacman -S $(names 3 "$1")"
    echo "  Homebrew:       brew install $(names 4 "$1")"
    explain_old_tools
    if $with_python; then echo "$kWithoutPython"; fi
  } >&2
  exit 1
}

# A tool that is too old counts as missing; report it.
explain_old_tools() {
  if has_command cmake && ! has_cmake; then
    echo "  (cmake is installed, but $(cmake_version) is older than 3.22)"
  fi
  if has_command g++ && ! has_compiler; then
    echo "  (g++ is installed, but $(g++ -dumpversion) is too old for C++20; 11 or newer is needed)"
  fi
}

# Prefers versioned clang packages; falls back to the default version of the distribution.
available_names() {
  local name version
  for name; do
    if [[ $name == *-14* ]] && ! apt-cache show --no-all-versions "$name" >/dev/null 2>&1; then
      version=$(apt-cache depends clang | sed -n 's/.*Depends: clang-\([0-9]*\)$/\1/p' | head -n 1)
      name=${name/-14/-$version}
    fi
    printf '%s\n' "$name"
  done
}

install_packages() {
  local rows=$1 packages as_root=()
  has_command apt-get || cannot_install "this system has no apt-get" "$rows"
  if [ "$(id -u)" -ne 0 ]; then
    has_command sudo || cannot_install "you are not root and there is no sudo" "$rows"
    as_root=(sudo)
    # Without a terminal, sudo cannot ask for a password.
    [ -t 0 ] || as_root+=(-n)
  fi
  read -ra packages <<<"$(names 1 "$rows")"
  say "installing with ${as_root[*]:+sudo }apt-get: ${packages[*]}"
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq
    -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 -o Dpkg::Use-Pty=0)
  # Continue after a failed update, because an old package list may be sufficient.
  "${apt[@]}" update >/dev/null || say "apt-get update failed; trying with the lists that are here"
  mapfile -t packages < <(available_names "${packages[@]}")
  "${apt[@]}" install -y --no-install-recommends "${packages[@]}" >/dev/null </dev/null ||
    cannot_install "apt-get install failed (its messages are above)" "$rows"
  choose_python
  rows=$(missing_rows "$rows")
  [ -z "$rows" ] || cannot_install "still missing after apt-get install" "$rows"
}

# --- MuJoCo ----------------------------------------------------------------------------------

fetch_folder=
# fetch_folder: a new folder for downloads, removed when the script ends.
make_fetch_folder() {
  mkdir -p "$root/build/deps"
  # Remove an earlier folder. The trap expands the variable late, so quotes in the path are not code.
  [ -z "$fetch_folder" ] || rm -rf -- "$fetch_folder"
  fetch_folder=$(mktemp -d "$root/build/deps/.fetch.XXXXXX")
  trap 'rm -rf -- "$fetch_folder"' EXIT
  # pip turns an interrupt into an ordinary error.
  trap 'exit 130' INT TERM
}

# install_mujoco VERSION: installs a version that is pinned by a file of hashes.
install_mujoco() {
  local version=$1 python deps=$root/build/deps pinned=$root/tools/mujoco.txt
  [ "$version" = "$kMujocoVersion" ] || pinned=$root/tools/mujoco_older.txt
  python=$(python_that_can "$kPip") || {
    say "cannot fetch MuJoCo: no Python with pip (Debian: python3-pip)"
    exit 1
  }
  make_fetch_folder
  say "fetching MuJoCo $version (a Python wheel, used as an SDK) into build/deps/mujoco"
  fetch_wheel "$python" "$fetch_folder/wheel" "$pinned" || {
    say "cannot fetch MuJoCo $version as $pinned pins it: pip's messages are above. Nothing was installed." \
      "With a MuJoCo >= 3.3 of your own: export MuJoCo_ROOT=DIR"
    [ "$version" = "$kOlderMujocoVersion" ] ||
      say "If the package index lacks it: tools/setup.sh --older-mujoco takes $kOlderMujocoVersion"
    exit 1
  }
  # Keep the licences next to the library.
  find "$fetch_folder/wheel" -path '*.dist-info/*' -name 'LICENSE*' -exec cp {} "$fetch_folder/wheel/mujoco/" \;
  rm -rf -- "$deps/mujoco"
  mv -- "$fetch_folder/wheel/mujoco" "$deps/mujoco"
}

# nanobind, pytest, stream clients and their dependencies, pinned by tools/python.txt.
install_python_tools() {
  local deps=$root/build/deps
  make_fetch_folder
  say "fetching nanobind, pytest and clients of streams (tools/python.txt) into build/deps/python"
  pip_fetch "$chosen_python" "$fetch_folder/python" "$root/tools/python.txt" || {
    say "cannot fetch what tools/python.txt pins: pip's messages are above. Nothing was installed of it." \
      "$kWithoutPython"
    exit 1
  }
  rm -rf -- "$deps/python"
  mv -- "$fetch_folder/python" "$deps/python"
}

# install_libraries NAME CONTENTS: installs what tools/NAME.txt pins into build/deps/NAME. Not every system has wheels
# of all of it; without them, the tests that need them are skipped.
install_libraries() {
  local name=$1 contents=$2 version
  local pinned=$root/tools/$name.txt folder=$root/build/deps/$name
  version=$("$chosen_python" -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>/dev/null) || return 0
  [ -e "$folder/.python-$version" ] && cmp -s "$pinned" "$folder/.pinned" && return 0
  make_fetch_folder
  say "fetching $contents (tools/$name.txt) into build/deps/$name"
  # Compiled: many processes import them, and tests write no bytecode.
  if ! pip_fetch "$chosen_python" "$fetch_folder/$name" "$pinned" --compile || ! [ -d "$fetch_folder/$name" ]; then
    say "cannot fetch them: tests that need them are skipped"
    return 0
  fi
  cp "$pinned" "$fetch_folder/$name/.pinned"
  touch "$fetch_folder/$name/.python-$version"
  rm -rf -- "$folder"
  mv -- "$fetch_folder/$name" "$folder"
}

# fetch_wheel PYTHON FOLDER REQUIREMENTS: pip rejects files whose hash is not in the requirements.
fetch_wheel() {
  pip_fetch "$1" "$2" "$3" --python-version "$kMujocoPython" --ignore-requires-python &&
    [ -e "$2/mujoco/include/mujoco/mujoco.h" ]
}

# pip_fetch PYTHON FOLDER REQUIREMENTS [OPTION...]
pip_fetch() {
  local python=$1 folder=$2 requirements=$3
  shift 3
  PIP_ROOT_USER_ACTION=ignore "$python" -m pip install --quiet --disable-pip-version-check --no-deps --no-compile \
    --only-binary=:all: "$@" --require-hashes --requirement "$requirements" --target "$folder" >&2
}

# --- modules of npm -----------------------------------------------------------------------------

# npm packages of the tests, pinned by a lock file; without them, tests report what they skip.
install_node_modules() {
  local source=$root/tests/node folder=$root/build/deps/node
  [ -e "$source/package-lock.json" ] || return 0
  cmp -s "$source/package-lock.json" "$folder/package-lock.json" && return 0
  if ! has_command npm; then
    say "there is no npm: tests of GLB files skip Khronos's validator"
    return 0
  fi
  rm -rf -- "$folder"
  mkdir -p "$folder"
  cp "$source/package.json" "$source/package-lock.json" "$folder/"
  say "fetching gltf-validator (npm) into build/deps/node"
  (cd "$folder" && npm ci --ignore-scripts --silent --no-audit --no-fund >&2) || {
    say "npm could not fetch it: tests of GLB files skip Khronos's validator"
    rm -rf -- "$folder"
  }
}

# --- main ------------------------------------------------------------------------------------

# RETARGET_PYTHON belongs to the user: packages of the distribution cannot complete it.
check_named_python() {
  [ -n "${RETARGET_PYTHON:-}" ] || return 0
  local lacks=
  if ! can "$RETARGET_PYTHON" ''; then
    say "RETARGET_PYTHON names \"$RETARGET_PYTHON\", which is not a Python interpreter"
    exit 1
  fi
  # Packages complete the Python of the distribution.
  [ "$chosen_python" != /usr/bin/python3 ] || return 0
  if $with_tests && ! has_numpy; then lacks+=", numpy"; fi
  if $with_python; then
    has_python_headers || lacks+=", Python 3.10 with its headers"
    has_venv || lacks+=", venv"
    has_python_tools || can "$chosen_python" "$kPip" || lacks+=", pip"
  fi
  [ -z "$lacks" ] || {
    say "RETARGET_PYTHON names \"$RETARGET_PYTHON\", which lacks: ${lacks#, }"
    exit 1
  }
}

check_only() {
  has_mujoco || say "missing: MuJoCo (a Python wheel; tools/setup.sh fetches it)"
  [ -z "$1" ] || list_missing "$1"
  has_mujoco || exit 1
  if $with_python && ! has_python_tools; then
    say "missing: nanobind, pytest or clients of streams (tools/python.txt; tools/setup.sh --python fetches them)"
    exit 1
  fi
  exit 0
}

main() {
  local wanted=$kPackages$kTestPackages job=install version=$kMujocoVersion further='' missing own
  with_tests=true with_python=false
  while [ $# -gt 0 ]; do
    case $1 in
      --dev) wanted+=$kDeveloperPackages ;;
      --tool)
        wanted=$kPackages
        with_tests=false
        ;;
      --python)
        with_python=true
        further+=$kPythonPackages
        ;;
      --package) further+=$kPackagingPackages ;;
      --check) job=check ;;
      --print-python) job=print ;;
      --older-mujoco) version=$kOlderMujocoVersion ;;
      -h | --help)
        sed -n '2,/^set /s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
        exit 0
        ;;
      *)
        say "unknown option $1 (known: --dev, --tool, --python, --package, --check, --print-python, --older-mujoco)"
        exit 2
        ;;
    esac
    shift
  done

  own=$(own_mujoco)
  if [ -n "$own" ] && ! [ -d "$own" ]; then
    say "MuJoCo_ROOT, MUJOCO_DIR or mujoco_DIR names \"$own\", which is not a folder"
    exit 1
  fi
  choose_python
  check_named_python
  if [ "$job" = print ]; then
    printf '%s\n' "$chosen_python"
    exit 0
  fi

  missing=$(missing_rows "$wanted$further")
  [ "$job" = install ] || check_only "$missing"
  [ -z "$missing" ] || install_packages "$missing"
  has_mujoco || install_mujoco "$version"
  if $with_python && ! has_python_tools; then install_python_tools; fi
  if $with_tests && $with_python; then
    install_libraries data_sets "Ray and readers of data sets"
    install_libraries docs "pdoc, a reader of Markdown and Jupyter's kernel"
  fi
  if $with_tests; then install_node_modules; fi
}

main "$@"
