#!/usr/bin/env bash
# The whole of kc705 but its pins, mapped flat by Yosys: no latch, no loop of logic, no net with two drivers, and within the budgets of
# an XC7K325T: at most 840 DSP48E1, 445 RAMB36E1 (two RAMB18E1 count as one) and 60 % of the LUTs. Half an hour and 4 GB; other designs
# by name: map-core.sh tiny NETWORK. The program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators
design=${1:-kc705}
weights=${2:-edof-t4w12-outer}

if [ -z "${EDOF:-}" ]; then
    cargo build -q --release -p edof-cli --locked
    EDOF=${CARGO_TARGET_DIR:-target}/release/edof
fi
folder=${CARGO_TARGET_DIR:-target}/mapped/$design
rm -rf "$folder"
mkdir -p "$(dirname "$folder")"
"$EDOF" generate -q --design "$design" --weights "$weights" --out "$folder"
make -C "$folder" synth
# The totals of the last table: lines of a count behind a cell's type, or before it, as Yosys' version has it.
count() {
    awk -v cells="$1" '$1 ~ cells && $2 ~ /^[0-9]+$/ { sum += $2 } $2 ~ cells && $1 ~ /^[0-9]+$/ { sum += $1 } END { print sum + 0 }' \
        "$folder/build/cells.txt"
}
dsp=$(count '^DSP48E1$')
ram=$(($(count '^RAMB36E1$') + ($(count '^RAMB18E1$') + 1) / 2))
# LUT RAM and shift registers lie in LUTs, too: RAM32M, RAM64M four, others as wide as their depth in 64.
lut=$(($(count '^LUT[1-6]$') + $(count '^SRL') + 4 * $(count '^RAM(32|64)M$') + 2 * $(count '^RAM(32|64)X1D$') + 4 * $(count '^RAM128X1D$')))
say "$design: $dsp DSP48E1, $ram RAMB36E1, $lut LUTs"
[ "$dsp" -le 840 ] || fail "$dsp DSP48E1, at most 840"
[ "$ram" -le 445 ] || fail "$ram RAMB36E1, at most 445"
[ "$lut" -le $((203800 * 60 / 100)) ] || fail "$lut LUTs, at most 60 % of 203800"
[ "$lut" -gt 1000 ] || fail "no table of cells in $folder/build/cells.txt"
say "within the budgets"
