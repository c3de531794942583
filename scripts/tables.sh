#!/usr/bin/env bash
# Remakes the tables of README.md from the networks in weights/: scripts/tables.sh [linear] [srgb], without arguments both. Writes
# docs/results/kodak-TONE.json (every row) and .md (the tables), and puts the first table into README.md between its marks.
# Photographs: $EDOF_KODAK, else ../shared/data/kodak. A few minutes a tone on two cores.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh

# Those trained for the paper's convention; of real light also those trained for it.
declare -A nets
nets[linear]="paper-t4,edof-t4w12,edof-t4w12-outer,edof-t4w12-clear"
nets[srgb]=${nets[linear]},edof-t4w12-outer-light
[ $# -gt 0 ] || set -- linear srgb
for tone in "$@"; do
    [[ $tone =~ ^(linear|srgb)$ ]] || fail "tone '$tone': must be linear or srgb"
done

say "building"
cargo build --release --locked --package edof-cli
# Put in place together: a table that is there already would make the next one's revision a changed one.
target=${CARGO_TARGET_DIR:-target}
made=$target/tables
mkdir -p "$made"
for tone in "$@"; do
    say "edof study kodak --tone $tone"
    "$target/release/edof" study kodak --tone "$tone" --nets "${nets[$tone]}" --psi 0,2,4,6,8 --stride 8 \
        --json "$made/kodak-$tone.json" --markdown "$made/kodak-$tone.md"
done
for tone in "$@"; do
    page=docs/results/kodak-$tone.md
    mv "$made/kodak-$tone".{json,md} docs/results/
    awk -v page="$page" -v start="<!-- table: $page -->" '
        $0 == start { print; while ((getline line < page) > 0) { if (line ~ /^\|/) { print line; found = 1 } else if (found) break }
                      skip = 1; next }
        skip && /^<!-- end -->$/ { skip = 0 }
        !skip { print }' README.md > README.md.new
    mv README.md.new README.md
done
