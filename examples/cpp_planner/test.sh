#!/bin/sh
# Runs the mission twice: the robot reaches its goal, and both digests are the one in README.md. The variable PROTEAN
# names another program than the `protean` in PATH.
set -eu
cd "$(dirname "$0")"
digest() {
    "${PROTEAN:-protean}" run hall.toml --seed 1 --allow-external --json --out "build/$1.mcap" --force >"build/$1.json"
    grep -q '"goal_reached"' "build/$1.json" || { echo "the robot has not reached its goal: build/$1.json" >&2; exit 1; }
    sed -n 's/.*"digest": *"\([0-9a-f]*\)".*/\1/p' "build/$1.json"
}
first=$(digest first)
second=$(digest second)
[ "$first" = "$second" ] || { echo "two runs differ: $first, $second" >&2; exit 1; }
grep -q "$first" README.md || { echo "the digest is $first, not that of README.md" >&2; exit 1; }
echo "ok: $first"
