#!/usr/bin/env bash
# Unpacks the C library of a Debian release, and if it is bookworm Python 3.11 and the C++ library that its numpy needs, in a
# folder, where chroot or qemu-user runs releases of retarget.
#
#   tools/release_sysroot.sh ARCH FOLDER [SUITE]     (x86_64 or aarch64; default: bookworm; bullseye has glibc 2.31)
#
# Needs apt-get and dpkg-deb. A private list of packages is used, so that the system's packages do not change.
set -euo pipefail

case $1 in
  x86_64) debian=amd64 ;;
  aarch64) debian=arm64 ;;
  *)
    echo "release_sysroot: unknown architecture $1 (known: x86_64, aarch64)" >&2
    exit 2
    ;;
esac
mkdir -p "$2"
folder=$(realpath -- "$2")
suite=${3:-bookworm}
packages=(libc6 libgcc-s1 libcrypt1 zlib1g libexpat1)
[ "$suite" != bookworm ] ||
  packages+=(python3.11-minimal libpython3.11-minimal libpython3.11-stdlib libffi8 libbz2-1.0 liblzma5 libuuid1 libstdc++6)

[ "$(cat "$folder/suite" 2>/dev/null)" != "$suite ${packages[*]}" ] || exit 0
apt=$folder/apt
mkdir -p "$apt"/{lists,cache}/partial
: >"$apt/status"
for file in /etc/apt/sources.list.d/*.sources; do
  grep -q '^Suites: *bookworm ' "$file" 2>/dev/null || continue
  sed "s/^Suites:.*/Suites: $suite/" "$file" | sed '/^$/q' >"$apt/$(basename "$file")"
done
options=(-qq -o "APT::Architecture=$debian" -o "APT::Architectures=$debian" -o "Dir::Etc::sourcelist=/dev/null"
  -o "Dir::Etc::sourceparts=$apt" -o "Dir::State::lists=$apt/lists" -o "Dir::State::status=$apt/status" -o "Dir::Cache=$apt/cache"
  -o "APT::Sandbox::User=$(id -un)")
apt-get "${options[@]}" update
cd -- "$apt"
apt-get "${options[@]}" download "${packages[@]}"
for file in *.deb; do
  dpkg-deb --extract "$file" "$folder"
done
rm -rf -- "$apt"
echo "$suite ${packages[*]}" >"$folder/suite"
