#!/usr/bin/env bash
# Makes viewer/dist/viewer.js, the script of the pages that `retarget view` writes, from viewer/src and
# three.js, and viewer/dist/gallery.js, the script of the index of a gallery. Uses the tools that
# viewer/package-lock.json pins.
#
#   tools/viewer_bundle.sh           writes viewer/dist; call it after a change in viewer/src
#   tools/viewer_bundle.sh --check   writes nothing; exits with 1 if viewer/dist is out of date
#
# Needs Node 18 and npm, and network access once for viewer/node_modules. The result is committed, so
# building retarget needs none of them. Without Node or its packages, --check reports it and exits with 0.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
viewer=$root/viewer

only_check=false
case ${1:-} in
  '') ;;
  --check) only_check=true ;;
  -h | --help)
    sed -n '2,/^set /s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
    exit 0
    ;;
  *)
    echo "viewer_bundle: unknown option $1 (known: --check)" >&2
    exit 2
    ;;
esac

# Reports a missing dependency. A check fails because of it only if RETARGET_STRICT_TESTS is set.
give_up() {
  echo "viewer_bundle: $1" >&2
  case $only_check,${RETARGET_STRICT_TESTS:-0} in true,0) exit 0 ;; esac
  exit 1
}

if ! command -v node >/dev/null || ! command -v npm >/dev/null; then
  give_up "left out: there is no Node with npm"
fi

# Install exactly the packages of the lock file.
if ! cmp -s "$viewer/package-lock.json" "$viewer/node_modules/.of_lock.json"; then
  npm ci --prefix "$viewer" --ignore-scripts --silent >&2 || give_up "npm cannot fetch the packages of viewer/package-lock.json"
  cp -- "$viewer/package-lock.json" "$viewer/node_modules/.of_lock.json"
fi

# Licence text that every copy of three.js must include; ASCII, like the whole script.
licence_comment() {
  printf '/* The viewer of retarget, with three.js:\n\n'
  sed 's/\xc2\xa9/(c)/g' node_modules/three/LICENSE
  printf '*/'
}

made=$(mktemp -d)
trap 'rm -rf -- "$made"' EXIT
cd -- "$viewer"
bundle() {
  node_modules/.bin/esbuild "$@" --bundle --minify --format=iife --target=es2022 --charset=ascii \
    --legal-comments=none --log-level=warning || give_up "esbuild failed"
}
bundle src/main.js --banner:js="$(licence_comment)" --outfile="$made/viewer.js"
bundle src/gallery.js --outfile="$made/gallery.js"
# Pages embed the script between <script> and </script>.
if grep -qi '</script\|<!--' "$made/viewer.js" "$made/gallery.js"; then
  echo "viewer_bundle: a script would end its element" >&2
  exit 1
fi
cp -- node_modules/three/LICENSE "$made/THREE_LICENSE"

for file in viewer.js gallery.js THREE_LICENSE; do
  if $only_check; then
    cmp -s "$made/$file" "dist/$file" || {
      echo "viewer_bundle: viewer/dist/$file is not what viewer/src makes: call tools/viewer_bundle.sh" >&2
      exit 1
    }
  else
    mkdir -p dist
    cp -- "$made/$file" "dist/$file"
  fi
done
