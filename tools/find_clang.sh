#!/usr/bin/env bash
# Prints the clang++ for builds with sanitizers and libFuzzer: CXX if it is clang++, otherwise version 14,
# otherwise any version.
set -euo pipefail

for name in "${CXX:-}" clang++-14 clang++ /usr/lib/llvm-*/bin/clang++; do
  if [[ $name == *clang* ]] && command -v "$name"; then exit 0; fi
done
echo "there is no clang++: run tools/setup.sh --dev" >&2
exit 1
