#!/usr/bin/env bash
# Makes the networks that come with the program again by the recipe (docs/decisions/0005-training.md) that `edof train` follows without
# options, then quantizes them. Photographs: the study's and those in shared/data/more (EDOF_KODAK, EDOF_MORE), less those that
# scripts/held-back.sh names. No accelerator is needed; the time is printed network by network. With names as arguments, only these; classes of light need the first
# round of the network for all light of their lens.
# A run that was stopped goes on where it stood. The bytes depend on the processor's kind, not on how many threads it has.
#
# A network with several seeds is the best of them, which goes on with a schedule of its own in which all windows weigh alike. Classes of noise (0005) go
# on from their own first round, or, for light, from the first round of the network for all light; the recipe is that of all lenses. Light's networks see
# windows of a single colour. Short rounds leave fewer codes where a network exceeds its budget. The files in weights/ whose tone is linear and which are
# no class are from before the recipe changed (0005) and before photographs were held back. The others are of this script, round by round and not in one run.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
source scripts/held-back.sh

# Networks after all rounds but their last, none of whose photographs is held back.
before="${CARGO_TARGET_DIR:-target}/rounds-held-back"
mkdir -p "$before"

# Name, form, camera, tone (the paper's convention is linear; srgb are pictures that are looked at encoded) and seeds of the first round, or a network
# to go on from | options of each round.
fewer="--steps 6000 --rate 5e-4 --lambda 5e-5,5e-4,9e-3"
short="--flat 64 --weighting mse --steps 6000 --rate 5e-4"
all="$short --non-zeros 60,60,40 --lambda 2e-4,4e-4,1e-1"
networks=(
    "paper-t4 paper-t4 ring-2018 linear 1,2,3 | | --weighting mse"
    "edof-t4w12 edof-t4w12 ring-2018 linear 1,2,3 | | --weighting mse"
    "edof-t4w12-outer edof-t4w12 ring-outer linear 1,2,3 | | --weighting mse"
    "edof-t4w12-clear edof-t4w12 clear-mid linear 1,2,3 | | --weighting mse"
    "edof-t4w12-light edof-t4w12 ring-2018 srgb 1 | --flat 64 | $all"
    "edof-t4w12-outer-light edof-t4w12 ring-outer srgb 1 | --flat 64 | $all"
    "edof-t4w12-clear-light edof-t4w12 clear-mid srgb 1 | --flat 64 | $all"
    "edof-t4w12-closed-light edof-t4w12 clear-closed srgb 1 | --flat 64 | $all"
    "edof-t3w12c96-clear-light one-sided,w12,t3,c96,r clear-mid srgb 1 | --flat 64 --steps 24000 | $short --non-zeros 31,24 --lambda 5e-5,2e-2"
)
# Classes of noise. Half of the windows of the lowest have none; of the lowest of light a quarter.
low="--noise 0:0.006 --noiseless 2" mid="--noise 0.006:0.014" high="--noise 0.014:0.03" lowest="--gain 1:4 --noiseless 4"
long="--weighting mse --steps 100000" second="--flat 64 --weighting mse --steps 60000"
for lens in outer:ring-outer clear:clear-mid closed:clear-closed; do
    name=edof-t4w12-${lens%:*} form="edof-t4w12 ${lens#*:}"
    light="$form srgb $before/$name-light-1.safetensors"
    # The closed lens is for a sensor's light alone.
    [ "$name" = edof-t4w12-closed ] || networks+=(
        "$name-low $form linear 1 | --steps 32000 $low | $low $fewer"
        "$name-mid $form linear 1 | --steps 32000 $mid | $mid --weighting mse --steps 80000 | $mid $long | $mid --weighting mse --steps 6000 --rate 5e-4 --lambda 5e-5,3e-4,2e-2"
        "$name-high $form linear 1 | --steps 32000 $high | $high $fewer"
    )
    networks+=(
        "$name-light-low $light | $lowest $second | $lowest $short --non-zeros 60,60,42 --lambda 2e-4,1e-4,6e-2"
        "$name-light-high $light | --gain 4:24 --flat 64 $long | --gain 4:24 $short --non-zeros 60,60,52 --lambda 4e-4,4e-4,5e-5"
    )
    # In so little light the closed lens is opened.
    [ "$name" = edof-t4w12-closed ] || networks+=("$name-light-dark $light | --gain 24:4096 $second")
done
# Ranges of all codes are measured on the study's training photographs.
calibration=${EDOF_KODAK:-../shared/data/kodak}

cargo build --release --locked --package edof-cli
edof="${CARGO_TARGET_DIR:-target}/release/edof"

wanted() {
    local name=$1
    shift
    [ $# -eq 0 ] || [[ " $* " == *" $name "* ]]
}

for line in "${networks[@]}"; do
    IFS='|' read -ra rounds <<<"$line"
    read -r name form camera tone start <<<"${rounds[0]}"
    wanted "$name" "$@" || continue
    begun=$SECONDS
    say "$name: training"
    for ((round = 1; round < ${#rounds[@]}; round++)); do
        out=weights/$name.safetensors
        [ $((round + 1)) = ${#rounds[@]} ] || out=$before/$name-$round.safetensors
        from=(--from "$start")
        [[ ! $start =~ ^[0-9,]+$ ]] || from=(--form "$form" --seed "$start")
        start=$out
        [ "${out%/*}" = weights ] || [ ! -e "$out" ] || continue
        # shellcheck disable=SC2046,SC2086 # options are several words
        "$edof" train "${from[@]}" --camera "$camera" --tone "$tone" --leave-out "$held_back" ${rounds[round]} --out "$out" $(resume "$out") --force
    done
    say "$name: quantizing"
    "$edof" quantize "weights/$name.safetensors" --images "$calibration" --frames all --out "weights/$name.fixed.safetensors" --force
    say "$name: $((SECONDS - begun)) seconds"
done
say "all of it: $SECONDS seconds"
