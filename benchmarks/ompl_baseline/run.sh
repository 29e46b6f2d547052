#!/usr/bin/env bash
# Comparison of the RRT* of Protean and OMPL in the city of the chasing game. SEEDS=21 by default.
# With OMPL_PYTHON, a Python that has the wheel `ompl` 2, its planners too. Intermediate results go to a temporary folder; the table to stdout.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
seeds="${SEEDS:-21}"
budget_ms="${BUDGET_MS:-120}"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

prefix="${OMPL_PREFIX:-/usr}"
g++ -O3 -march=native -std=c++17 "$here/main.cpp" -o "$work/ompl_baseline" \
    -I"$prefix/include/ompl-1.5" -I"$prefix/include/eigen3" \
    -I/usr/include/ompl-1.5 -I/usr/include/eigen3 \
    -L"$prefix/lib/$(gcc -print-multiarch)" -lompl
export LD_LIBRARY_PATH="$prefix/lib/$(gcc -print-multiarch)${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"

cargo run --quiet --release --manifest-path "$here/../../Cargo.toml" -p evader_rrt_star \
    --example planner_quality -- "$seeds" "$budget_ms" > "$work/all.csv"
for planner in RRTstar InformedRRTstar; do
    for query in 0 1 2; do
        for ((seed = 0; seed < seeds; seed++)); do
            "$work/ompl_baseline" "$planner" "$query" "$seed" "$budget_ms" >> "$work/all.csv"
        done
    done
done
if [[ -n "${OMPL_PYTHON:-}" ]]; then
    g++ -O3 -march=native -std=c++17 -shared -fPIC "$here/city.cpp" -o "$work/libcity.so"
    for planner in RRTstar InformedRRTstar BITstar AORRTC; do
        for query in 0 1 2; do
            for ((seed = 0; seed < seeds; seed++)); do
                "$OMPL_PYTHON" "$here/newest.py" "$work/libcity.so" "$planner" "$query" "$seed" "$budget_ms" >> "$work/all.csv"
            done
        done
    done
fi
awk -f "$here/table.awk" "$work/all.csv"
