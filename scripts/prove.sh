#!/usr/bin/env bash
# Proves blocks of the circuit (proofs/): prove.sh [--all] [BLOCK...]. Without options what takes minutes; with --all the long proofs, too.
# The Verilog is that of a generated directory of `tiny`, and of blocks of `ulx3s`; the program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_provers
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
generate_tiny "$work"
# Memory and screen of a board that `tiny` is not for.
"$EDOF" generate -q --design ulx3s --weights edof-t3w12c96-clear-light --out "$work/ulx3s"
cp "$work"/ulx3s/rtl/{axi_sdram,bit_count,tmds_encoder}.v "$work/tiny/rtl"
python3 -B proofs/prove.py --sources "$work/tiny/rtl" --out "$(realpath -m "${CARGO_TARGET_DIR:-target}")/proofs" "$@"
