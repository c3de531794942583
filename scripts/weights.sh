#!/usr/bin/env bash
# Makes the networks that come with the program again by the recipe (docs/decisions/0005-training.md) that `edof train` follows without
# options, then quantizes them. Photographs: the study's and those in shared/data/more (EDOF_KODAK, EDOF_MORE), less those that
# scripts/held-back.sh names. No accelerator is needed; the time is printed network by network. With names as arguments, only these.
# A run that was stopped goes on where it stood. The bytes depend on the processor's kind, not on how many threads it has.
#
# A network of two rounds is the best of its seeds, which goes on with a schedule of its own in which all windows weigh alike. Classes of noise (0005) go on from
# their own first round, or, for light, from the network for all light; the recipe is that of both lenses. The files in weights/ whose tone
# is linear and which are no class are from before the recipe changed (0005) and before photographs were held back; the others are of this
# script.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
source scripts/held-back.sh

# Name, form, camera, tone (the paper's convention is linear; srgb are pictures that are looked at encoded) and seeds of the first round, or a network
# to go on from | options of the first round | options of the second, where there is one.
networks=(
    "paper-t4 paper-t4 ring-2018 linear 1,2,3 | | --weighting mse"
    "edof-t4w12 edof-t4w12 ring-2018 linear 1,2,3 | | --weighting mse"
    "edof-t4w12-outer edof-t4w12 ring-outer linear 1,2,3 | | --weighting mse"
    "edof-t4w12-clear edof-t4w12 clear-mid linear 1,2,3 | | --weighting mse"
    "edof-t4w12-light edof-t4w12 ring-2018 srgb 1 | |"
    "edof-t4w12-outer-light edof-t4w12 ring-outer srgb 1 | |"
    "edof-t4w12-clear-light edof-t4w12 clear-mid srgb 1 | |"
)
# Classes of noise. Half of the windows of the lowest have none; of the lowest of light a quarter.
for lens in outer:ring-outer clear:clear-mid; do
    name=edof-t4w12-${lens%:*} form="edof-t4w12 ${lens#*:}" mid="--noise 0.006:0.014"
    light="$form srgb $name-light" second="--weighting mse --steps 60000"
    networks+=(
        "$name-low $form linear 1 | --steps 32000 --noise 0:0.006 --noiseless 2 |"
        "$name-mid $form linear 1 | --steps 32000 $mid | $mid --weighting mse --steps 80000"
        "$name-high $form linear 1 | --steps 32000 --noise 0.014:0.03 |"
        "$name-light-low $light | | --gain 1:4 --noiseless 4 $second"
        "$name-light-high $light | | --gain 4:24 $second"
        "$name-light-dark $light | | --gain 24:4096 $second"
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
    IFS='|' read -r what first_options second_options <<<"$line"
    read -r name form camera tone start <<<"$what"
    wanted "$name" "$@" || continue
    begun=$SECONDS
    # What both rounds have in common, after their start.
    common="--camera $camera --tone $tone"
    out=weights/$name.safetensors
    say "$name: training"
    if [[ $start =~ ^[0-9,]+$ ]]; then
        [ -z "${second_options// /}" ] || out=$first/$name.safetensors
        # shellcheck disable=SC2046,SC2086 # options are several words
        [ "$out" != "weights/$name.safetensors" ] && [ -e "$out" ] ||
            "$edof" train --form "$form" $common --leave-out "$held_back" --seed "$start" $first_options --out "$out" $(resume "$out") --force
        start=$out
    fi
    # shellcheck disable=SC2046,SC2086
    [ -z "${second_options// /}" ] || "$edof" train --from "$start" $common --leave-out "$held_back" $second_options \
        --out "weights/$name.safetensors" $(resume "weights/$name.safetensors") --force
    say "$name: quantizing"
    "$edof" quantize "weights/$name.safetensors" --images "$calibration" --out "weights/$name.fixed.safetensors" --force
    say "$name: $((SECONDS - begun)) seconds"
done
say "all of it: $SECONDS seconds"
