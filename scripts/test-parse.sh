#!/usr/bin/env bash
# Benches and modules of a generated directory by a strict front end (slang, by way of PyPI's pyslang), and two mistakes that it must find.
# Leaves with their own parameters, without a memory image, by the system's Yosys and by the newest one.
# The program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators
need_newest_yosys

need_edof
need_environment parsing tests/parsing/requirements.txt

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$EDOF" random-network -q --design tiny --out "$work/drawn.fixed.safetensors"
"$EDOF" generate -q --design tiny --weights "$work/drawn.fixed.safetensors" --out "$work/edof"
parse() { "$environment/bin/python" -B tests/parsing/parse.py "$work/edof" 2>&1; }

parse || fail "the directory is refused"
bench=$work/edof/sim/core_bench.sv
cp "$bench" "$work/kept.sv"
sed '1i `timescale 1ns / 1ps' "$work/kept.sv" >"$bench"
if parse >/dev/null; then fail "a time scale beside modules without one was not found"; fi
sed 's/integer cycle = 0;/integer cycle = later;\n    integer later = 0;/' "$work/kept.sv" >"$bench"
if parse >/dev/null; then fail "a name that is used before it is declared was not found"; fi
say "slang reads all of it, and finds both mistakes"

# A leaf of two start values always has an image.
leaves=$(printf '%s\n' rtl/edof_*.v rtl/ecp5/*.v | grep -v edof_start)
for yosys in yosys "$newest_yosys"; do
    for leaf in $leaves; do
        "$yosys" -q -p "read_verilog $leaf" || fail "$yosys does not read $leaf"
    done
done
say "both Yosys read every leaf by itself"
