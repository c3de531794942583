#!/usr/bin/env bash
# Makes the networks that come with the program again by the recipe (docs/decisions/0005-training.md) that `edof train` follows without
# options, then quantizes them. Photographs: the study's and those in shared/data/more (EDOF_KODAK, EDOF_MORE), less those that
# scripts/held-back.sh names. No accelerator is needed; the time is printed network by network. With names as arguments, only these.
# A run that was stopped goes on where it stood. The bytes depend on the processor's kind, not on how many threads it has.
#
# Each network is trained in two rounds: the best seed of the first goes on with a schedule of its own. The files in weights/ whose tone is
# linear are from before the recipe changed (0005) and before photographs were held back; those for light are of this script.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
source scripts/held-back.sh

# Name, form, camera, tone (the paper's convention is linear; srgb are pictures that are looked at encoded), seeds of the first round, and what
# differs from the recipe in the second.
networks=(
    "paper-t4 paper-t4 ring-2018 linear 1,2,3 --weighting mse"
    "edof-t4w12 edof-t4w12 ring-2018 linear 1,2,3 --weighting mse"
    "edof-t4w12-outer edof-t4w12 ring-outer linear 1,2,3 --weighting mse"
    "edof-t4w12-clear edof-t4w12 clear-mid linear 1,2,3 --weighting mse"
    "edof-t4w12-light edof-t4w12 ring-2018 srgb 1 --rate 1e-3"
    "edof-t4w12-outer-light edof-t4w12 ring-outer srgb 1 --rate 1e-3"
    "edof-t4w12-clear-light edof-t4w12 clear-mid srgb 1 --rate 1e-3"
)
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
    read -r name form camera tone seeds second <<<"$line"
    wanted "$name" "$@" || continue
    begun=$SECONDS
    say "$name: training"
    # shellcheck disable=SC2046
    [ -e "$first/$name.safetensors" ] || "$edof" train --form "$form" --camera "$camera" --tone "$tone" --leave-out "$held_back" --seed "$seeds" \
        --out "$first/$name.safetensors" $(resume "$first/$name.safetensors")
    # shellcheck disable=SC2046,SC2086 # options are several words
    "$edof" train --from "$first/$name.safetensors" --camera "$camera" --tone "$tone" --leave-out "$held_back" --seed 1 $second \
        --out "weights/$name.safetensors" $(resume "weights/$name.safetensors") --force
    say "$name: quantizing"
    "$edof" quantize "weights/$name.safetensors" --images "$calibration" --out "weights/$name.fixed.safetensors" --force
    say "$name: $((SECONDS - begun)) seconds"
done
say "all of it: $SECONDS seconds"
