#!/usr/bin/env bash
# What other forms of the network would give: one short training each (8,000 steps, seed 1, the default's camera, else the recipe of
# scripts/weights.sh), then a table of dB, non-zeros and multiplications on validation windows, docs/results/forms.md. Nothing is chosen by a test
# photograph. About a minute a form on two cores; forms that are there already are not trained again.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh

cargo build --release --locked --package edof-cli
edof="${CARGO_TARGET_DIR:-target}/release/edof"
made="${EDOF_FORMS:-${CARGO_TARGET_DIR:-target}/forms}"
mkdir -p "$made"

# Name, then what differs from the default.
forms=(
    "t4w12 --form one-sided,w12,t4,c192,r"
    "t3w12 --form one-sided,w12,t3,c192,r"
    "t5w12 --form one-sided,w12,t5,c192,r"
    "t4w8 --form one-sided,w8,t4,c192,r"
    "t4w16 --form one-sided,w16,t4,c192,r"
    "t4w12c256 --form one-sided,w12,t4,c256,r --non-zeros 62,62,54"
    "t4w12c128 --form one-sided,w12,t4,c128,r --non-zeros 62,62,54"
    "t4w12half --form one-sided,w12,t4,c192,r --non-zeros 40,40,36"
    "t4w12free --form one-sided,w12,t4,c192,r --non-zeros none --lambda 3e-5"
)
for line in "${forms[@]}"; do
    read -r name options <<<"$line"
    [ -e "$made/$name.json" ] && continue
    say "$name"
    # shellcheck disable=SC2086 # options are several words
    "$edof" train --camera ring-outer $options --steps 8000 --seed 1 --out "$made/$name.safetensors" --resume \
        --json "$made/$name.json"
done
python3 scripts/forms.py "$made" "${forms[@]}" >docs/results/forms.md
say "docs/results/forms.md"
