#!/usr/bin/env bash
# Remakes the comparison with other methods: scripts/comparison.sh [speed] [depths] [blind], without arguments all three.
#   speed   docs/results/single-depth.*, docs/figures/speed.svg and the report out/single-depth.html   (25 minutes on two busy cores)
#   depths  docs/results/multi-depth.*, the report out/multi-depth.html                                 (5 minutes)
#           (its rows hold the pictures and stay in out/multi-depth.jsonl)
#   blind   docs/results/blind.* (test photographs) and blind-train.* (the others), reports in out      (15 minutes)
# Rows that are there (of the same contents, on the same CPU) are kept, and only told again: remove a file of rows to measure it anew.
# Nothing is chosen on what is measured here. Photographs: $EDOF_KODAK, else ../shared/data/kodak.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh

[ $# -gt 0 ] || set -- speed depths blind
for part in "$@"; do
    [[ $part =~ ^(speed|depths|blind)$ ]] || fail "'$part': must be speed, depths or blind"
done
say "building"
cargo build --release --locked --package edof-cli
edof=${CARGO_TARGET_DIR:-target}/release/edof
mkdir -p out

# Outputs of a study, by its name.
told() { echo --json "docs/results/$1.json" --markdown "docs/results/$1.md" --report "out/$1.html"; }
for part in "$@"; do
    say "$part"
    case $part in
        speed)
            # Everything where each patch is seen once; at the paper's stride and half-way what its claims need: OMP takes 16 times as long there.
            "$edof" study single-depth --rows docs/results/single-depth.jsonl --noise none,0.01 --stride 8 > /dev/null
            # shellcheck disable=SC2046
            "$edof" study single-depth --rows docs/results/single-depth.jsonl $(told single-depth) --noise none --stride 4,2 --methods omp,omp-known --plot docs/figures/speed.svg
            ;;
        depths)
            # shellcheck disable=SC2046
            "$edof" study multi-depth --rows out/multi-depth.jsonl $(told multi-depth)
            ;;
        blind)
            for set in test train; do
                page=blind${set/test/}
                page=${page/train/-train}
                "$edof" study blind --rows "docs/results/$page.jsonl" --markdown "docs/results/$page.md" --report "out/$page.html" \
                    --photos "$set" --side 15
            done
            ;;
    esac
done
