#!/bin/sh
# Tables 7.2 to 7.4 of the thesis for synthetic mountains, beside its figures; the whole linear program is solved as well.
# Usage: scripts/reproduce-thesis-ch7.sh [RIVER ...]: rivers of the thesis to be like (default: all six); a minute.
# OUT=out/chapter7 may be set.
set -eu
cd "$(dirname "$0")/.."

scripts/install-deps.sh
cmake --preset release >&2
cmake --build --preset release --target reproduce_ch7 -j "$(scripts/jobs.sh)" >&2

out=${OUT:-out/chapter7}
mkdir -p "$out"
[ "$#" -gt 0 ] || set -- Kowesas Khutze Kiltuish Goat Paril Triumph
: > "$out/tables.txt.part"
for river in "$@"; do
  echo "== like the $river River" >> "$out/tables.txt.part"
  build/release/tests/reproduce_ch7 --river "$river" >> "$out/tables.txt.part"
  echo >> "$out/tables.txt.part"
done
mv "$out/tables.txt.part" "$out/tables.txt"
cat "$out/tables.txt"
echo "reproduce-thesis-ch7: tables in $out/tables.txt" >&2
