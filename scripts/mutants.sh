#!/usr/bin/env bash
# Mutants of the circuit, each of which a test must see (proofs/mutants.py): mutants.sh for the table of proofs/mutants.json,
# mutants.sh --draw N [--seed S] [--core] [BLOCK...] for N random ones. Those of one revision are kept with their score by block (score.md) in
# target/mutants/REVISION; a run that was stopped goes on. The Verilog is that of a generated directory of `tiny`; the program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_provers
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
generate_tiny "$work"
revision=$(git rev-parse --short=12 HEAD)
kept=$(realpath -m "${CARGO_TARGET_DIR:-target}")/mutants/$revision
[ -z "$(git status --porcelain)" ] || { kept=$kept-changed && rm -rf "$kept"; }
python3 -B proofs/mutants.py --generated "$work/tiny" --edof "$EDOF" --weights "$work/moderate.fixed.safetensors" \
    --out "$kept" "$@"
