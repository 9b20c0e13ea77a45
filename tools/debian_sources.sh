#!/usr/bin/env bash
# Downloads and unpacks Debian source archives from the mirrors of this machine's apt.
#
#   tools/debian_sources.sh LIST FOLDER
#
# LIST has a line per archive: package, file, SHA-256. Every archive is checked before it is unpacked in FOLDER.
# A private list of packages is used, so that the system's lists do not change. A mirror may lack a version that it
# lists; an older one has the same archive.
set -euo pipefail

list=$(realpath -- "$1")
mkdir -p "$2"
folder=$(realpath -- "$2")
apt=$folder/apt
mkdir -p "$apt"/{lists,cache}/partial
: >"$apt/sources.sources"
for file in /etc/apt/sources.list.d/*.sources; do
  [ -e "$file" ] && sed 's/^Types:.*/Types: deb-src/' "$file" >>"$apt/sources.sources" && echo >>"$apt/sources.sources"
done
if [ -e /etc/apt/sources.list ]; then sed -nE 's/^deb(-src)? /deb-src /p' /etc/apt/sources.list >"$apt/old.list"; fi
options=(-qq -o "Dir::Etc::sourcelist=$apt/old.list" -o "Dir::Etc::sourceparts=$apt" -o "Dir::State::lists=$apt/lists"
  -o "Dir::Cache=$apt/cache" -o "APT::Sandbox::User=$(id -un)")
apt-get "${options[@]}" update
cd -- "$folder"
grep -v '^#' "$list" | while read -r package file hash; do
  mapfile -t versions < <(apt-cache "${options[@]}" showsrc "$package" | sed -n 's/^Version: //p' | sort -rVu)
  for version in "${versions[@]}"; do
    [ -e "$file" ] || apt-get "${options[@]}" source --download-only "$package=$version" || true
  done
  echo "$hash  $file" | sha256sum --quiet --check
  tar -xf "$file"
done
