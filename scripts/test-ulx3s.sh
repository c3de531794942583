#!/usr/bin/env bash
# The bitstream of the ULX3S by the commands of docs/ulx3s.md: generated, mapped, placed, routed and packed, with each of three seeds; its report names every
# clock and passes; reports of clocks that are missed or missing do not. 25 minutes of CPU time for the first seed, and about 22 for each other. nextpnr comes
# from PyPI (YoWASP) where none is on the path. The program is built if it is not given as EDOF. With a folder all stays there, and the reports as
# seed-N.txt: scripts/test-ulx3s.sh [FOLDER [SEED…]].
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators
need_router

need_edof
if [ $# -gt 0 ]; then
    mkdir -p "$1"
    work=$(realpath "$1")
    shift
else
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT
fi
[ $# -gt 0 ] || set -- 1 2 3
folder=$work/ulx3s
"$EDOF" generate -q --force --design ulx3s --weights edof-t3w12c96-clear-light --out "$folder"

# The PLLs' divisions are those of prjtrellis' own tool, where that is beside the packer.
if command -v "${packer%ecppack}ecppll" >/dev/null; then
    line=0
    for clock in core calculator bits; do
        line=$((line + 1))
        mhz=$(sed -n "s/.*MHz \/ .* = \([0-9.]*\) MHz;.*/\1/p" "$folder/rtl/ulx3s_top.v" | sed -n "${line}p")
        theirs=$("${packer%ecppack}ecppll" -i 25 -o "$mhz" 2>/dev/null | sed -n 's/^\(Refclk\|Feedback\) divisor: //p' | paste -sd' ')
        ours=$(tr -d '\n' <"$folder/rtl/ulx3s_top.v" | sed -n "s/.*\.CLKI_DIV(\([0-9]*\)), \.CLKFB_DIV(\([0-9]*\)).* ${clock}_pll (.*/\1 \2/p")
        [ "$theirs" = "$ours" ] || fail "$clock: divisions $ours, ecppll has $theirs"
    done
fi

missed=()
for seed in "$@"; do
    # What was mapped stays.
    rm -f "$folder/build/edof.config" "$folder/build/edof.bit"
    make -C "$folder" bitstream NEXTPNR="$router" ECPPACK="$packer" SEED="$seed" || missed+=("$seed")
    cp "$folder/build/report.txt" "$work/seed-$seed.txt"
done
[ "${#missed[@]}" = 0 ] || fail "clocks are missed with the seeds ${missed[*]}"
head -c 200 "$folder/build/edof.bit" | grep -a 'Part: LFE5U-85F' >/dev/null || fail "the bitstream is for another part"
grep -q '^MULT18X18D: 83 of 156$' "$folder/build/report.txt" || fail "the report has other multipliers"

# A report that must not pass.
wrong() {
    ! (cd "$folder" && python3 report.py "$work/wrong.json" core_clock="$core" calculator_clock="$calculator" clk_25mhz=25 bit_clock=125 camera_pclk=12.5) >/dev/null 2>&1 ||
        fail "a wrong report passes: $1"
}
core=$(sed -n 's/.*core_clock=\([0-9.]*\).*/\1/p' "$folder/Makefile") calculator=$(sed -n 's/.*calculator_clock=\([0-9.]*\).*/\1/p' "$folder/Makefile")
python3 - "$folder/build/timing.json" "$work" "$core" <<'PYTHON'
import json
import sys

path, work, core = sys.argv[1:]
for name in ("slow", "gone"):
    report = json.load(open(path))
    clock = next(clock for clock in report["fmax"] if clock.endswith("core_clock"))
    if name == "slow":
        report["fmax"][clock]["achieved"] = 1.04 * float(core)
    else:
        del report["fmax"][clock]
    json.dump(report, open(f"{work}/{name}.json", "w"))
PYTHON
for name in slow gone; do
    mv "$work/$name.json" "$work/wrong.json"
    wrong "$name"
done
say "the bitstream of the ULX3S is made"
