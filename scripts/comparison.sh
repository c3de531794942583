#!/usr/bin/env bash
# Remakes the comparison with other methods: scripts/comparison.sh [speed] [overlap] [depths] [blind] [knobs] [design], without arguments all six.
#   speed   docs/results/single-depth.*, docs/figures/speed.svg and the report out/single-depth.html   (25 minutes on two busy cores)
#   overlap docs/results/overlap.*, the report out/overlap.html: all methods of patches at stride 4       (10 minutes)
#   depths  docs/results/multi-depth.*, the report out/multi-depth.html                                 (5 minutes)
#           (its rows hold the pictures and stay in out/multi-depth.jsonl)
#   blind   docs/results/blind.* (test photographs) and blind-train.* (the others), reports in out      (15 minutes)
#           fails where blind deconvolution loses more than 1 dB of any photograph
#   knobs   docs/results/knobs.*, the report out/knobs.html, on three training photographs              (10 minutes)
#   design  docs/results/design.md, the report out/design.html, on the same                             (1 minute)
# Rows that are there (of the same contents, on the same CPU) are kept, and only told again: remove a file of rows to measure it anew.
# Nothing is chosen on what is measured here. Photographs: $EDOF_KODAK, else ../shared/data/kodak.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh

[ $# -gt 0 ] || set -- speed knobs design blind depths overlap
for part in "$@"; do
    [[ $part =~ ^(speed|overlap|depths|blind|knobs|design)$ ]] || fail "'$part': must be speed, overlap, depths, blind, knobs or design"
done
say "building"
cargo build --release --locked --package edof-cli
edof=${CARGO_TARGET_DIR:-target}/release/edof
photographs=${EDOF_KODAK:-../shared/data/kodak}
mkdir -p out

# Outputs of a study, by its name.
pages() { echo --markdown "docs/results/$1.md" --report "out/$1.html"; }
told() { echo --json "docs/results/$1.json" "$(pages "$1")"; }
# shellcheck disable=SC2046 # outputs are several words
for part in "$@"; do
    say "$part"
    case $part in
        speed)
            # Everything where each patch is seen once; at the paper's stride and half-way what its claims need: OMP takes 16 times as long there.
            "$edof" study single-depth --rows docs/results/single-depth.jsonl --noise none,0.01 --stride 8 > /dev/null
            "$edof" study single-depth --rows docs/results/single-depth.jsonl $(told single-depth) --noise none --stride 4,2 --methods omp,omp-known \
                --plot docs/figures/speed.svg
            ;;
        overlap)
            "$edof" study single-depth --rows docs/results/overlap.jsonl $(pages overlap) --noise none --stride 4 \
                --methods omp,omp-known,fista,fista-known,untrained,untrained-dc-removed
            ;;
        depths)
            "$edof" study multi-depth --rows out/multi-depth.jsonl $(told multi-depth) --csv docs/results/multi-depth.csv
            ;;
        blind)
            for set in test train; do
                page=blind${set/test/}
                page=${page/train/-train}
                "$edof" study blind --rows "docs/results/$page.jsonl" $(pages "$page") --photos "$set" --side 15
                grep -q "Lost more than 1 dB: none" "docs/results/$page.md" || fail "docs/results/$page.md: blind deconvolution diverges on a photograph"
            done
            ;;
        knobs)
            "$edof" study knobs --rows docs/results/knobs.jsonl $(pages knobs) --photos 1,13,20
            ;;
        design)
            shots=()
            for number in 01 13 20; do shots+=(--photo "$photographs/kodim$number.png"); done
            "$edof" study design --weights paper-t4,edof-t4w12,edof-t4w12-outer "${shots[@]}" --psi 0,4,8 $(pages design)
            ;;
    esac
done
