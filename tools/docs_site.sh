#!/usr/bin/env bash
# Builds the site of the documentation: the pages of docs/, the notebooks with their outputs, and the reference of
# the Python package. Its pages work from the disk and load nothing from the web.
#
#   tools/docs_site.sh [FOLDER] [BUILD]      (default: build/site build/release)
#
# FOLDER is replaced. BUILD is a build folder with the Python module (-DRETARGET_BUILD_PYTHON=ON). Needs what
# tools/setup.sh --python installs, and no network. Exit code 1: broken links and other problems, which it lists.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
folder=${1:-$root/build/site} build=${2:-$root/build/release} deps=$root/build/deps

python=$("$root/tools/setup.sh" --python --print-python)
for needed in "$build/python/retarget/_retarget.pyi" "$deps/docs" "$deps/data_sets"; do
  [ -e "$needed" ] || {
    echo "docs_site: there is no $needed: run tools/test.sh, or tools/setup.sh --python and build the module" >&2
    exit 1
  }
done
export PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$build/python:$deps/python:$deps/data_sets:$deps/docs
exec "$python" "$root/tools/docs_site/build.py" "$folder"
