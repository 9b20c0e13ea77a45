#!/usr/bin/env bash
# Regenerates the golden CSVs of the sample clips with the built tool (tools/test.sh builds it):
#
#   tests/golden/regenerate.sh             tests/golden/*.csv, from this project's tool
#   tests/golden/regenerate.sh --oracle    tests/golden/oracle/*.csv, from the independent Python
#                                          reference in ../shared (or RETARGET_SHARED); PYTHON names
#                                          the interpreter that has its packages
#
# Check the changes before committing: a golden that moved by more than 1e-6 is a change that users will notice.
set -euo pipefail

root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
shared=${RETARGET_SHARED:-$root/../shared}
tool=${RETARGET_TOOL:-$root/build/release/tools/retarget/retarget}

for clip in "$root"/data/*.bvh; do
  name=$(basename -- "$clip" .bvh)
  if [ "${1:-}" = --oracle ]; then
    full=$(mktemp)
    OMP_NUM_THREADS=1 "${PYTHON:-python3}" "$shared/oracle/retarget_oracle.py" --bvh "$clip" \
      --robot-xml "$shared/reference/robots/unitree_g1/g1_mocap_29dof.xml" \
      --ik-config "$shared/reference/ik_configs/bvh_to_g1.json" -o "$full"
    # Nine decimals are sufficient for a comparison at 1e-6.
    awk -F, -v OFS=, '{ for (i = 1; i <= NF; ++i) $i = sprintf("%.9f", $i); print }' "$full" \
      > "$root/tests/golden/oracle/$name.csv"
    rm -- "$full"
  else
    "$tool" --bvh "$clip" --robot unitree_g1 --method gmr --precision 9 --quiet \
      -o "$root/tests/golden/$name.csv"
  fi
done
