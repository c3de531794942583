#!/usr/bin/env bash
# Places, routes and packs the calculator of a design for an ECP5: scripts/route.sh DESIGN WEIGHTS MHZ FOLDER [SEED…]. FOLDER gets, for each seed, a
# bitstream, nextpnr's report and its log. Fails where a clock is below MHZ. Yosys is the one on the path, or `YOSYS`.
set -euo pipefail
design=$(realpath "$1") weights=$(realpath "$2") mhz=$3
mkdir -p "$4"
folder=$(realpath "$4")
shift 4
[ $# -gt 0 ] || set -- 1
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators
need_router

cargo build -q --workspace --locked --example chain
"${CARGO_TARGET_DIR:-target}/debug/examples/chain" "$design" "$weights" "$folder"
cp project/ecp5/* "$folder"
cd "$folder"
begin=$SECONDS
${YOSYS:-yosys} -q -l yosys.log -p "
    read_verilog -lib -specify +/ecp5/cells_sim.v +/ecp5/cells_bb.v
    read_verilog -defer rtl/*.v chain_top.v
    hierarchy -top chain_top
    script synth.ys
    tee -o cells.txt stat
    write_json chain.json"
${YOSYS:-yosys} -V | tee versions.txt
say "mapped in $((SECONDS - begin)) s"
missed=
for seed in "$@"; do
    begin=$SECONDS
    "$router" --85k --package CABGA381 --speed 6 --json chain.json --lpf-allow-unconstrained --freq "$mhz" --seed "$seed" \
        --textcfg "$seed.config" --report "$seed.json" --timing-allow-fail >"$seed.log" 2>&1 || fail "nextpnr failed: $folder/$seed.log"
    "$packer" "$seed.config" "$seed.bit"
    say "seed $seed is placed, routed and packed in $((SECONDS - begin)) s"
    python3 report.py "$seed.json" "$mhz" || missed=1
done
"$router" --version 2>&1 | tee -a versions.txt
[ -z "$missed" ] || fail "a clock is below $mhz MHz"
