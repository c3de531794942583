#!/usr/bin/env bash
# Makes the networks that come with the program again by the recipe (docs/decisions/0005-training.md) that `edof train` follows without
# options, then quantizes them. Photographs: the study's and those in shared/data/more (EDOF_KODAK, EDOF_MORE), less those that
# scripts/held-back.sh names. No accelerator is needed; the time is printed network by network. With names as arguments, only these.
# A run that was stopped goes on where it stood. The bytes depend on the processor's kind, not on how many threads it has.
#
# A network of two rounds is the best of its seeds, which goes on with a schedule of its own in which all windows weigh alike. Classes of noise (0005) go on from
# their own first round, or, for light, from the network for all light; the recipe is that of both lenses. A last short round teaches light's networks
# windows of a single colour. The files in weights/ whose tone is linear and which are no class are from before the recipe changed (0005) and before
# photographs were held back; the others are of this script, except that light's classes went on from networks without the last round.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
source scripts/held-back.sh

# Name, form, camera, tone (the paper's convention is linear; srgb are pictures that are looked at encoded) and seeds of the first round, or a network
# to go on from | options of each round, where there is one.
colours="--flat 64 --weighting mse --steps 6000 --rate 5e-4"
networks=(
    "paper-t4 paper-t4 ring-2018 linear 1,2,3 | | --weighting mse |"
    "edof-t4w12 edof-t4w12 ring-2018 linear 1,2,3 | | --weighting mse |"
    "edof-t4w12-outer edof-t4w12 ring-outer linear 1,2,3 | | --weighting mse |"
    "edof-t4w12-clear edof-t4w12 clear-mid linear 1,2,3 | | --weighting mse |"
    "edof-t4w12-light edof-t4w12 ring-2018 srgb 1 | | | $colours"
    "edof-t4w12-outer-light edof-t4w12 ring-outer srgb 1 | | | $colours"
    "edof-t4w12-clear-light edof-t4w12 clear-mid srgb 1 | | | $colours"
)
# Classes of noise. Half of the windows of the lowest have none; of the lowest of light a quarter.
for lens in outer:ring-outer clear:clear-mid; do
    name=edof-t4w12-${lens%:*} form="edof-t4w12 ${lens#*:}" mid="--noise 0.006:0.014"
    light="$form srgb $name-light" second="--weighting mse --steps 60000"
    networks+=(
        "$name-low $form linear 1 | --steps 32000 --noise 0:0.006 --noiseless 2 | |"
        "$name-mid $form linear 1 | --steps 32000 $mid | $mid --weighting mse --steps 80000 |"
        "$name-high $form linear 1 | --steps 32000 --noise 0.014:0.03 | |"
        "$name-light-low $light | | --gain 1:4 --noiseless 4 $second | --gain 1:4 --noiseless 4 $colours"
        "$name-light-high $light | | --gain 4:24 $second | --gain 4:24 $colours"
        "$name-light-dark $light | | --gain 24:4096 $second | --gain 24:4096 $colours"
    )
done
# Ranges of all codes are measured on the study's training photographs.
calibration=${EDOF_KODAK:-../shared/data/kodak}

cargo build --release --locked --package edof-cli
edof="${CARGO_TARGET_DIR:-target}/release/edof"
# Networks after all rounds but their last, none of whose photographs is held back.
rounds="${CARGO_TARGET_DIR:-target}/rounds-held-back"
mkdir -p "$rounds"

wanted() {
    local name=$1
    shift
    [ $# -eq 0 ] || [[ " $* " == *" $name "* ]]
}

for line in "${networks[@]}"; do
    IFS='|' read -r what first second third <<<"$line"
    read -r name form camera tone start <<<"$what"
    wanted "$name" "$@" || continue
    begun=$SECONDS
    options=("$first" "$second" "$third")
    # A network to go on from has had its first round.
    round=1 last=1
    [[ $start =~ ^[0-9,]+$ ]] && round=0
    [ -n "${second// /}" ] || last=0
    [ -z "${third// /}" ] || last=2
    say "$name: training"
    for ((; round <= last; round++)); do
        [ "$round" = 0 ] || [ -n "${options[round]// /}" ] || continue
        out=weights/$name.safetensors
        [ "$round" = "$last" ] || out=$rounds/$name-$round.safetensors
        from=(--from "$start")
        [ "$round" != 0 ] || from=(--form "$form" --seed "$start")
        start=$out
        [ "$round" = "$last" ] || [ ! -e "$out" ] || continue
        # shellcheck disable=SC2046,SC2086 # options are several words
        "$edof" train "${from[@]}" --camera "$camera" --tone "$tone" --leave-out "$held_back" ${options[round]} --out "$out" $(resume "$out") --force
    done
    say "$name: quantizing"
    "$edof" quantize "weights/$name.safetensors" --images "$calibration" --out "weights/$name.fixed.safetensors" --force
    say "$name: $((SECONDS - begun)) seconds"
done
say "all of it: $SECONDS seconds"
