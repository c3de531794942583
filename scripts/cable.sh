#!/usr/bin/env bash
# What the cable costs, whose words have 14 bits (docs/contract.md, 1.1): the eight test photographs, encoded, through it and past it, PSNR in dB of
# the network for the frame with the cable minus without. EDOF names the program [default: target/release/edof], EDOF_KODAK the photographs.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
edof=$(realpath "${EDOF:-target/release/edof}")
photos=$(realpath "${EDOF_KODAK:-../shared/data/kodak}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

psnr() { "$edof" compare sharp.png "$1" --json | sed -n 's/.*"psnr_db": \([0-9.]*\),/\1/p'; }

echo "| bits | noise | mean | worst |"
echo "|---|---|---|---|"
for noise in none sensor; do
    for depth in 12 14 16; do
        for number in 03 06 09 12 15 18 21 24; do
            for psi in 0 4 8; do
                "$edof" capture "$photos/kodim$number.png" --camera ring-outer --psi "$psi" --bit-depth "$depth" --noise "$noise" --no-measure \
                    --out raw.png --video frame.2vuy --values srgb --sharp sharp.png > /dev/null
                "$edof" reconstruct raw.png --weights edof-t4w12-outer-light --bits 16 --out past.png > /dev/null
                "$edof" reconstruct --video frame.2vuy --weights edof-t4w12-outer-light --bits 16 --out through.png > /dev/null
                echo "$(psnr through.png) $(psnr past.png)"
            done
        done | awk -v row="| $depth | $noise |" '{ d = $1 - $2; sum += d; if (NR == 1 || d < worst) worst = d }
            END { printf "%s %+.4f | %+.4f |\n", row, sum / NR, worst }'
    done
done
