#!/usr/bin/env bash
# Proves blocks of the circuit (proofs/): prove.sh [--all] [BLOCK...]. Without options what takes minutes; with --all the long proofs, too.
# The Verilog is that of a generated directory of `tiny`; the program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators
need_python

if [ -z "${EDOF:-}" ]; then
    cargo build -q -p edof-cli --locked
    EDOF=${CARGO_TARGET_DIR:-target}/debug/edof
fi
EDOF=$(realpath "$EDOF")
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
environment=$target/provers
if ! cmp -s proofs/requirements.txt "$environment/requirements.txt"; then
    say "installing SymbiYosys and a solver under $environment"
    python3 -m venv --clear "$environment"
    "$environment/bin/pip" install -q -r proofs/requirements.txt
    cp proofs/requirements.txt "$environment/requirements.txt"
fi
PATH=$environment/bin:$PATH

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$EDOF" random-network -q --design tiny --out "$work/drawn.fixed.safetensors"
"$EDOF" generate -q --design tiny --weights "$work/drawn.fixed.safetensors" --out "$work/tiny"
python3 -B proofs/prove.py --sources "$work/tiny/rtl" --out "$target/proofs" "$@"
