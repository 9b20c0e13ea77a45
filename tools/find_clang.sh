#!/usr/bin/env bash
# Prints the clang++ that the sanitizers and libFuzzer are built with: CXX where that is one, else version
# 14, else any.
set -euo pipefail

for name in "${CXX:-}" clang++-14 clang++ /usr/lib/llvm-*/bin/clang++; do
  if [[ $name == *clang* ]] && command -v "$name"; then exit 0; fi
done
echo "there is no clang++: run tools/setup.sh --dev" >&2
exit 1
