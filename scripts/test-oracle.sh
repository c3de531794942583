#!/usr/bin/env bash
# The contract on paper against the program: tests/oracles (NumPy, written from docs/contract.md) runs the real `edof` and compares
# every word and code, PSFs of polynomial masks with a plain FFT, corrections of sensors (docs/sensor.md), and docs/results/bound.md with `edof optics bound`. Arguments go on to check.py; the
# program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh

need_edof
need_environment oracles tests/oracles/requirements.txt
"$environment/bin/python" -B tests/oracles/optics.py "$EDOF"
"$environment/bin/python" -B tests/oracles/check.py "$EDOF" "$@"
"$environment/bin/python" -B tests/oracles/sensor.py "$EDOF"
"$environment/bin/python" -B tests/oracles/bound.py "$EDOF"
# Banks of PSFs as NumPy writes them.
EDOF_PYTHON=$environment/bin/python cargo test --workspace --locked --test program -- --ignored a_bank_of_any_of_numpys_kinds
