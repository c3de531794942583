#!/usr/bin/env bash
# Makes the networks that come with the program again by the recipe (docs/decisions/0005-training.md) that `edof train` follows without
# options, then quantizes them. Photographs: the study's and those in shared/data/more (EDOF_KODAK, EDOF_MORE), less those that
# scripts/held-back.sh names. No accelerator is needed; the time is printed network by network. With names as arguments, only these.
# A run that was stopped goes on where it stood. The bytes depend on the processor's kind, not on how many threads it has.
#
# Networks of two rounds are those of the paper's lens: the best of three seeds goes on for a second round in which easy and hard windows
# weigh alike. The files of these two in weights/ are from before the recipe changed (0005) and before photographs were held back.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
source scripts/held-back.sh

# Name, form, camera, rounds, what differs from the recipe otherwise: the tone of the paper's convention, or of pictures that are looked at
# encoded.
networks=(
    "paper-t4 paper-t4 ring-2018 2 --tone linear"
    "edof-t4w12 edof-t4w12 ring-2018 2 --tone linear"
    "edof-t4w12-outer edof-t4w12 ring-outer 1 --tone linear"
    "edof-t4w12-clear edof-t4w12 clear-mid 1 --tone linear"
    "edof-t4w12-light edof-t4w12 ring-2018 1 --tone srgb"
    "edof-t4w12-outer-light edof-t4w12 ring-outer 1 --tone srgb"
    "edof-t4w12-clear-light edof-t4w12 clear-mid 1 --tone srgb"
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
    read -r name form camera rounds options <<<"$line"
    wanted "$name" "$@" || continue
    begun=$SECONDS
    out="weights/$name.safetensors"
    # shellcheck disable=SC2206 # options are several words
    train=("$edof" train --camera "$camera" ${options:-} --leave-out "$held_back")
    say "$name: training"
    # shellcheck disable=SC2046
    if [ "$rounds" = 1 ]; then
        "${train[@]}" --form "$form" --seed 1 --out "$out" $(resume "$out") --force
    else
        first_out="$first/$name.safetensors"
        [ -e "$first_out" ] || "${train[@]}" --form "$form" --seed 1,2,3 --out "$first_out" $(resume "$first_out")
        "${train[@]}" --from "$first_out" --weighting mse --out "$out" $(resume "$out") --force
    fi
    say "$name: quantizing"
    "$edof" quantize "$out" --images "$calibration" --out "weights/$name.fixed.safetensors" --force
    say "$name: $((SECONDS - begun)) seconds"
done
say "all of it: $SECONDS seconds"
