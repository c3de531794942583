#!/usr/bin/env bash
# Proves blocks of the circuit (proofs/): prove.sh [--all] [BLOCK...]. Without options what takes minutes; with --all the long proofs, too.
# The Verilog is that of a generated directory of `tiny`, of a block of `ulx3s`, and of a block that no design has; the program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_provers
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
generate_tiny "$work"
# Memory and screen of a board that `tiny` is not for.
"$EDOF" random-network -q --design ulx3s --out "$work/ulx3s.fixed.safetensors"
"$EDOF" generate -q --design ulx3s --weights "$work/ulx3s.fixed.safetensors" --out "$work/ulx3s"
cp "$work"/ulx3s/rtl/{axi_sdram,bit_count,tmds_encoder}.v "$work/tiny/rtl"
# Of the whole workspace: for a package alone cargo would choose other features and build 69 crates again.
cargo build -q --locked --workspace --example stream_cut
"${CARGO_TARGET_DIR:-target}/debug/examples/stream_cut" >"$work/tiny/rtl/stream_cut_w2.v"
python3 -B proofs/prove.py --sources "$work/tiny/rtl" --out "$(realpath -m "${CARGO_TARGET_DIR:-target}")/proofs" "$@"
