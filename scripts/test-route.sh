#!/usr/bin/env bash
# `edof timing --route` with a real nextpnr and its packer: stage M1 of a small design mapped, placed, routed and packed for an ECP5. M1 alone, because a
# stage takes a minute and a half of CPU time; I and F go the same way. nextpnr comes from PyPI (YoWASP) where none is on the path. The program is built
# if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators

need_edof
need_router
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$EDOF" timing -q --design tests/route/small.json --stages M1 --route ecp5 --json "$work/timing.json" >"$work/said.txt" || {
    cat "$work/said.txt"
    fail "edof timing --route failed"
}

# A report is right if it has the stage with its multipliers, its registers and names of the source on its worst path.
check() {
    python3 - "$1" <<'PYTHON'
import json
import sys

report = json.load(open(sys.argv[1]))
assert [stage["stage"] for stage in report["routed"]] == ["M1"] and report["router"], report["router"]
found, mapped = report["routed"][0]["routed"], report["stages"][0]["timing"]
assert 40 < found["mhz"] < 400 and found["logic_ns"] > 0 and found["wires_ns"] > 0, found["mhz"]
period = found["logic_ns"] + found["wires_ns"]
assert abs(period * found["mhz"] - 1000) < 10, f"{period} ns are not {found['mhz']} MHz"
# A multiplier of 25 x 18 bits is two of the ECP5's.
used = {kind: count for kind, (count, _) in found["used"].items()}
assert used["MULT18X18D"] == 2 * mapped["dsps"], used
wires = [step for step in found["path"] if step["kind"] == "routing"]
assert any(part in step["name"] for step in wires for part in ("_q", "_d")), "no name of the source"
# The device's configuration is as long whatever is in it.
assert found["bitstream_bytes"] > 1_900_000, found["bitstream_bytes"]
print(f"M1: {found['mhz']:.1f} MHz, {found['logic_ns']:.2f} ns of cells, {found['wires_ns']:.2f} ns of wires, {used['TRELLIS_FF']} registers, {found['bitstream_bytes']} bytes of bitstream")
PYTHON
}
check "$work/timing.json"

# What is wrong is found: a multiplier less, a path without wires, no bitstream.
for fault in 's/"MULT18X18D": *\[ *[0-9]*/"MULT18X18D": [7/' 's/"routing"/"logic"/g' 's/"bitstream_bytes": *[0-9]*/"bitstream_bytes": 0/'; do
    tr -d '\n' <"$work/timing.json" | sed "$fault" >"$work/wrong.json"
    ! check "$work/wrong.json" 2>/dev/null || fail "a wrong report passes: $fault"
done
say "stage M1 is placed, routed and packed"
