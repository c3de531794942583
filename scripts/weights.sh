#!/usr/bin/env bash
# Makes all networks that come with the program again, by one recipe (docs/decisions/0005-training.md): the one that `edof train`
# follows without options, with three seeds; the best on validation windows goes on for a second round in which easy and hard
# windows weigh alike; then it is quantized. Photographs: the study's and those in shared/data/more (EDOF_KODAK, EDOF_MORE), less those that
# scripts/held-back.sh names: the networks in weights/ are from before those were held back. No
# accelerator is needed; the time is printed network by network. With names as arguments, only these. A run that was stopped goes on
# where it stood. The bytes depend on the processor's kind, not on how many threads it has.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
source scripts/held-back.sh

# Name, form, camera, what differs from the recipe otherwise: the tone of the paper's convention, or of pictures that are looked at encoded.
networks=(
    "paper-t4 paper-t4 ring-2018 --tone linear"
    "edof-t4w12 edof-t4w12 ring-2018 --tone linear"
    "edof-t4w12-outer edof-t4w12 ring-outer --tone linear"
    "edof-t4w12-clear edof-t4w12 clear-mid --tone linear"
    "edof-t4w12-outer-light edof-t4w12 ring-outer --tone srgb"
)
seeds=1,2,3
second_round=(--weighting mse --steps 40000)
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
    read -r name form camera options <<<"$line"
    wanted "$name" "$@" || continue
    begun=$SECONDS
    say "$name: training"
    # shellcheck disable=SC2046,SC2086 # options are several words
    [ -e "$first/$name.safetensors" ] || "$edof" train --form "$form" --camera "$camera" ${options:-} --leave-out "$held_back" --seed "$seeds" \
        --out "$first/$name.safetensors" $(resume "$first/$name.safetensors")
    # shellcheck disable=SC2046,SC2086
    "$edof" train --from "$first/$name.safetensors" --camera "$camera" ${options:-} --leave-out "$held_back" "${second_round[@]}" \
        --out "weights/$name.safetensors" $(resume "weights/$name.safetensors") --force
    say "$name: quantizing"
    "$edof" quantize "weights/$name.safetensors" --images "$calibration" --out "weights/$name.fixed.safetensors" --force
    say "$name: $((SECONDS - begun)) seconds"
done
say "all of it: $SECONDS seconds"
