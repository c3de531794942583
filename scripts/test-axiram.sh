#!/usr/bin/env bash
# Frames through the core of `tiny` with somebody else's AXI4 memory: cocotbext-axi's AxiRam, which pauses on all channels at random, in Icarus. Every
# picture must be golden, and a wrong word must be found. cocotb and cocotbext-axi come from PyPI. The program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators

need_edof
need_environment axiram tests/axiram/requirements.txt
tests=$(realpath tests/axiram)

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# A drawn network of 12 bits has sums that fit the design.
sed 's/"code_bits": 16/"code_bits": 12/' designs/tiny.json >"$work/tiny.json"
"$EDOF" random-network -q --form one-sided,w8,t4,c16,r --bits 12 --out "$work/drawn.fixed.safetensors"
"$EDOF" generate -q --design "$work/tiny.json" --weights "$work/drawn.fixed.safetensors" --out "$work/edof"
cd "$work/edof"
python3 "$tests/bench.py" . bench.sv
sed 's#^sim/core_bench.sv#bench.sv#' sim/core_bench.f >bench.f
iverilog -g2012 -Wno-timescale -s edof_core_bench -o bench.vvp -c bench.f
library=$("$environment/bin/cocotb-config" --lib-name-path vpi icarus)
libpython=$("$environment/bin/cocotb-config" --libpython)
run() {
    rm -f results.xml
    AXIRAM_SEED=$1 PYTHONPATH=$tests:$("$environment/bin/python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))') PYTHONDONTWRITEBYTECODE=1 \
        LIBPYTHON_LOC=$libpython COCOTB_LOG_LEVEL=WARNING COCOTB_RESULTS_FILE=results.xml MODULE=axiram TOPLEVEL=edof_core_bench \
        TOPLEVEL_LANG=verilog vvp -M "$(dirname "$library")" -m "$(basename "$library" .vpl)" bench.vvp >said.txt 2>&1 || true
    # cocotb ends well whatever its tests say.
    grep -q '<testcase' results.xml && ! grep -q '<failure' results.xml && grep -q '^PASS: 5 pictures' said.txt
}
for seed in 1 2 3; do
    run "$seed" || { tail -40 said.txt; fail "seed $seed: not every picture is golden"; }
done
sed -i '41s/.*/0000/' sim/pictures.hex
if run 1; then fail "a wrong word was not found"; fi
say "AxiRam: every picture golden with pauses on all channels"
