#!/usr/bin/env bash
# Compares words between circuit (in Verilator) and golden model for minutes: words.sh PART, one of the six parts below, each 110 to 200 million words.
#
# A part is a list of runs of `edof cosim`, each with a seed of its own, which sets the network of extreme weights where none is named, the random
# windows, the contents that registers and memories start with, and the stalls. The first difference ends the part. The last line says how many
# words were compared; scripts/soak.sh --log adds them up. EDOF names the program [default: built, optimised]; photographs: $EDOF_KODAK, else
# ../shared/data/kodak.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
photographs=${EDOF_KODAK:-../shared/data/kodak}

# Rows: part, design, network (- for an extreme one), windows (random ones, or those of photographs), seeds, share of stalls.
runs() {
    cat <<'RUNS'
1 kc705 -                random:60000  1,2,3       0
1 kc705 -                random:30000  4,5         0.2
2 paper -                random:50000  11,12,13    0
2 paper -                random:40000  14,15       0.2
3 tiny  -                random:100000 21,22,23,24 0
3 tiny  -                random:100000 25,26,27,28 0.2
4 kc705 edof-t4w12-outer photos:01,02,03,04,05,06,07,08,09,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24 31 0
5 paper paper-t4         photos:01,02,03,04,05,06,07,08,09,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24 41 0
6 kc705 edof-t4w12       random:60000  51,52       0.1
6 paper paper-t4         random:60000  53,54       0.1
RUNS
}

part=${1:-}
[[ $part =~ ^[1-6]$ ]] || fail "which part, 1 to 6? words.sh PART"
need_simulators
if [ -z "${EDOF:-}" ]; then
    cargo build -q --release --locked -p edof-cli
    EDOF=${CARGO_TARGET_DIR:-target}/release/edof
fi
all=0
# One run: its options; prints what the program says and adds up its words.
compare() {
    local said beats
    say "edof cosim $*"
    said=$("$EDOF" cosim -q --waveform "${CARGO_TARGET_DIR:-target}/words-$part" --force "$@")
    echo "$said"
    # A beat has two words. The words that a beat adds to are compared, too, and not counted.
    beats=$(sed -n 's/.* \([0-9]*\) beats at .*: no difference.*/\1/p' <<<"$said")
    all=$((all + 2 * ${beats:?the program states no beats}))
}
begin=$SECONDS
while read -r _ design weights windows seeds stalls; do
    options=(--design "$design" --stalls "$stalls")
    [ "$weights" = - ] || options+=(--weights "$weights")
    for seed in ${seeds//,/ }; do
        case $windows in
            random:*) compare "${options[@]}" --random "${windows#random:}" --seed "$seed" ;;
            photos:*)
                # ψ 0, 2, 4, 6 and 8 by turns.
                depth=0
                for number in $(tr , ' ' <<<"${windows#photos:}"); do
                    compare "${options[@]}" --photo "$photographs/kodim$number.png" --psi "$depth" --patches 1000000 --seed "$((10#$number + 100 * seed))"
                    depth=$(((depth + 2) % 10))
                done
                ;;
        esac
    done
done < <(runs | grep "^$part ")
echo "$all words compared in $((SECONDS - begin)) s, none different"
