#!/usr/bin/env bash
# What more layers are worth: the paper's form with T = 3 to 10, one short training each (8,000 steps, seed 1, the paper's camera, half the usual rate, at which
# T = 10 does not converge; else the recipe of scripts/weights.sh), quantized on drawn scenes, then measured on the test photographs (psi = 8, no noise,
# stride 8): docs/results/layers.md. Nothing is chosen by a test photograph. One to three minutes of processor time a network; networks and rows that are
# there already are kept.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh

cargo build --release --locked --package edof-cli
edof="${CARGO_TARGET_DIR:-target}/release/edof"
made="${EDOF_LAYERS:-${CARGO_TARGET_DIR:-target}/layers}"
mkdir -p "$made"

nets=()
for layers in 3 4 5 6 8 10; do
    name="$made/paper-t$layers-short"
    nets+=("$name.safetensors")
    [ -e "$name.fixed.safetensors" ] && continue
    say "T = $layers"
    "$edof" train --form "paper-t4,t$layers" --camera ring-2018 --steps 8000 --rate 1e-3 --seed 1 --out "$name.safetensors" --resume --json "$name.json"
    "$edof" quantize "$name.safetensors" --out "$name.fixed.safetensors"
done
all=$(IFS=,; echo "${nets[*]}")
"$edof" study single-depth --nets "$all" --methods malvar --psi 8 --noise none --stride 8 --rows "$made/rows.jsonl" >/dev/null
python3 scripts/layers.py "$made" >docs/results/layers.md
say "docs/results/layers.md"
