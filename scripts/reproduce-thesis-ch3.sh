#!/bin/sh
# Tables 3.1 and 3.2 of the thesis beside ours, for random point sets and for real ones, and a figure like Figure 3.6.
# Usage: scripts/reproduce-thesis-ch3.sh [LAS or LAZ file ...]; takes some minutes. Without files the clouds of
# ../shared/data/quickstart are used where they exist. RUNS=200 and OUT=out/chapter3 may be set.
set -eu
cd "$(dirname "$0")/.."

scripts/install-deps.sh
cmake --preset release >&2
cmake --build --preset release --target reproduce_ch3 -j "$(scripts/jobs.sh)" >&2

out=${OUT:-out/chapter3}
mkdir -p "$out"
if [ "$#" -eq 0 ]; then
  for cloud in ../shared/data/quickstart/*.laz; do
    [ -e "$cloud" ] && set -- "$@" "$cloud"
  done
fi
build/release/tests/reproduce_ch3 --runs "${RUNS:-200}" --figures "$out" "$@" > "$out/tables.txt.part"
mv "$out/tables.txt.part" "$out/tables.txt"
cat "$out/tables.txt"
echo "reproduce-thesis-ch3: tables in $out/tables.txt, figures in $out/fixed-edges-*.svg" >&2
