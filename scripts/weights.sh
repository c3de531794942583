#!/usr/bin/env bash
# Makes the networks that come with the program again by the recipe (docs/decisions/0005-training.md) that `edof train` follows without
# options, then quantizes them. Photographs: the study's and those in shared/data/more (EDOF_KODAK, EDOF_MORE), less those that
# scripts/held-back.sh names. No accelerator is needed; the time is printed network by network. With names as arguments, only these.
# A run that was stopped goes on where it stood. The bytes depend on the processor's kind, not on how many threads it has.
#
# The networks low, mid and high are classes of noise (0005): one round of 32,000 steps each, by the same recipe for both lenses.
# A network of two rounds is the best of three seeds, which goes on with a schedule of its own in which all windows weigh alike. The files in
# weights/ whose tone is linear are from before the recipe changed (0005) and before photographs were held back; those for light are of this
# script.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
source scripts/held-back.sh

# Name, form, camera, rounds, tone (the paper's convention is linear; srgb are pictures that are looked at encoded), further options.
networks=(
    "paper-t4 paper-t4 ring-2018 2 linear"
    "edof-t4w12 edof-t4w12 ring-2018 2 linear"
    "edof-t4w12-outer edof-t4w12 ring-outer 2 linear"
    "edof-t4w12-clear edof-t4w12 clear-mid 2 linear"
    "edof-t4w12-light edof-t4w12 ring-2018 1 srgb"
    "edof-t4w12-outer-light edof-t4w12 ring-outer 1 srgb"
    "edof-t4w12-clear-light edof-t4w12 clear-mid 1 srgb"
)
# Classes of noise. Half of the windows of the lowest have none.
for lens in outer:ring-outer clear:clear-mid; do
    name=edof-t4w12-${lens%:*} form="edof-t4w12 ${lens#*:} 1 linear --steps 32000"
    networks+=(
        "$name-low $form --noise 0:0.006 --noiseless 2"
        "$name-mid $form --noise 0.006:0.014"
        "$name-high $form --noise 0.014:0.03"
    )
done
# Ranges of all codes are measured on the study's training photographs.
calibration=${EDOF_KODAK:-../shared/data/kodak}

cargo build --release --locked --package edof-cli
edof="${CARGO_TARGET_DIR:-target}/release/edof"
# Networks after their first round, none of whose photographs is held back.
first="${CARGO_TARGET_DIR:-target}/first-round-held-back"
mkdir -p "$first"

wanted() {
    local name=$1
    shift
    [ $# -eq 0 ] || [[ " $* " == *" $name "* ]]
}

for line in "${networks[@]}"; do
    read -r name form camera rounds tone options <<<"$line"
    wanted "$name" "$@" || continue
    begun=$SECONDS
    out=weights/$name.safetensors seeds=1
    [ "$rounds" = 1 ] || out=$first/$name.safetensors seeds=1,2,3
    say "$name: training"
    # shellcheck disable=SC2046,SC2086 # options are several words
    [ "$rounds" = 2 ] && [ -e "$out" ] || "$edof" train --form "$form" --camera "$camera" --tone "$tone" --leave-out "$held_back" --seed "$seeds" \
        $options --out "$out" $(resume "$out") --force
    # shellcheck disable=SC2046
    [ "$rounds" = 1 ] || "$edof" train --from "$out" --camera "$camera" --tone "$tone" --leave-out "$held_back" --weighting mse \
        --out "weights/$name.safetensors" $(resume "weights/$name.safetensors") --force
    say "$name: quantizing"
    "$edof" quantize "weights/$name.safetensors" --images "$calibration" --out "weights/$name.fixed.safetensors" --force
    say "$name: $((SECONDS - begun)) seconds"
done
say "all of it: $SECONDS seconds"
