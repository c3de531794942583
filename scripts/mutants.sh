#!/usr/bin/env bash
# Mutants of the circuit, each of which a test must see (proofs/mutants.py): mutants.sh for the table of proofs/mutants.json,
# mutants.sh --draw N [--seed S] [--core] [BLOCK...] for N random ones, with their score by block in target/mutants/score.md.
# The Verilog is that of a generated directory of `tiny`; the program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_provers
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
generate_tiny "$work"
python3 -B proofs/mutants.py --generated "$work/tiny" --edof "$EDOF" --weights "$work/moderate.fixed.safetensors" \
    --out "$(realpath -m "${CARGO_TARGET_DIR:-target}")/mutants" "$@"
