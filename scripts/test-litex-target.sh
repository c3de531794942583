#!/usr/bin/env bash
# The LiteX target of `tiny` (docs/litex.md) from nothing: its sources for Vivado, elaborated by Yosys; the training of the DRAM against a model;
# the system in Verilator with LiteX's model of a DRAM, where LiteX's client reads id and every picture must be golden, and a wrong word must be
# found. LiteX, LiteDRAM and litex-boards come from PyPI. The program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators
need_litex
repository=$PWD

need_edof
work=$(mktemp -d)
board=
trap 'kill $board 2>/dev/null || true; rm -rf "$work"' EXIT
export PYTHONDONTWRITEBYTECODE=1

# A random network of 12 bits has sums that fit the design.
sed 's/"code_bits": 16/"code_bits": 12/' designs/tiny.json >"$work/tiny.json"
"$EDOF" random-network -q --form one-sided,w8,t4,c16,r --bits 12 --out "$work/random.fixed.safetensors"
"$EDOF" generate -q --shell litex --design "$work/tiny.json" --weights "$work/random.fixed.safetensors" --out "$work/edof"
cd "$work/edof"

"$litex/bin/python" litex/kc705.py >target.log 2>&1 || { tail -20 target.log; fail "the target for the KC705 does not elaborate"; }
gateware=build/litex_kc705/gateware
modules=$(sed -n 's/^read_verilog.*{\(.*\)}$/\1/p' $gateware/edof_kc705.tcl | tr '\n' ' ')
for word in 'read_mem' 'EDOF_IMAGES_BY_NAME' 'read_xdc .*crossings.xdc' 'synth_design .*-part xc7k325t-ffg900-2'; do
    grep -q "^[^#]*$word" $gateware/edof_kc705.tcl || fail "edof_kc705.tcl lacks '$word'"
done
# Every crossing has its instance in the top, and all that is registered in a pad, or clocked, is there.
instances=$(sed -n 's|^# \([a-z_0-9]*\)[/:].*|\1|p' build/litex_kc705/crossings.xdc | sort -u)
[ "$(echo $instances)" = "chips_0 chips_1 core reset_of_core reset_of_input" ] || fail "crossings.xdc is of other instances: $instances"
selected=$(for name in $instances calculator_mmcm screen_mmcm screen_clock_out; do echo "select -assert-count 1 edof_kc705/c:$name;"; done)
# shellcheck disable=SC2086
yosys -q -l yosys.log -p "read_verilog -lib +/xilinx/cells_sim.v +/xilinx/cells_xtra.v; read_verilog -defer $modules; \
    hierarchy -check -top edof_kc705; $selected proc; check -assert" >/dev/null 2>&1 || { tail -5 yosys.log; fail "Yosys does not elaborate the target"; }
say "the target elaborates"

python3 "$repository/tests/litex/dram_model.py" litex build/litex_kc705/dram.json

timeout 3000 "$litex/bin/python" litex/sim.py >sim.log 2>&1 || { tail -20 sim.log; fail "the simulated system gives other pictures"; }
grep -q '^id and scratch over UARTBone' sim.log && grep -q '^PASS: 5 pictures' sim.log || { tail -5 sim.log; fail "the simulation ended early"; }
sed -i '41s/.*/0000/' sim/pictures.hex
if timeout 3000 "$litex/bin/python" litex/sim.py >sim.log 2>&1; then fail "a wrong word was not found"; fi
grep -q '^FAIL: a frame of' sim.log || { tail -5 sim.log; fail "the simulation failed for another reason than the wrong word"; }
say "pictures through LiteDRAM are golden"

# `edof board` at the simulated line.
"$litex/bin/python" litex/sim.py --serve >serve.log 2>&1 &
board=$!
for _ in $(seq 1200); do
    grep -q '^line: ' serve.log && break
    kill -0 $board 2>/dev/null || { tail -5 serve.log; fail "the simulated system ended"; }
    sleep 0.1
done
port=$(sed -n 's/^line: //p' serve.log)
"$EDOF" board get id --timeout 30 --port "$port" >id.txt || fail "edof board fails at LiteX's bus"
grep -q 0x45444f46 id.txt || fail "edof board reads $(cat id.txt) as id at LiteX's bus"
say "edof board works at LiteX's UARTBone"
