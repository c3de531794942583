#!/usr/bin/env bash
# The contract on paper against the program: tests/oracles (NumPy, written from docs/contract.md) runs the real `edof` and compares
# every word and code, PSFs of polynomial masks with a plain FFT, corrections of sensors (docs/sensor.md), and docs/results/bound.md with `edof optics bound`. Arguments go on to check.py; the
# program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_python

if [ -z "${EDOF:-}" ]; then
    cargo build -q -p edof-cli --locked
    EDOF=${CARGO_TARGET_DIR:-target}/debug/edof
fi
environment=$(realpath -m "${CARGO_TARGET_DIR:-target}")/oracles
if ! "$environment/bin/python" -c 'import numpy, PIL' 2>/dev/null; then
    say "installing NumPy and Pillow under $environment"
    python3 -m venv --clear "$environment"
    "$environment/bin/pip" install -q -r tests/oracles/requirements.txt
fi
"$environment/bin/python" -B tests/oracles/optics.py "$EDOF"
"$environment/bin/python" -B tests/oracles/check.py "$EDOF" "$@"
"$environment/bin/python" -B tests/oracles/sensor.py "$EDOF"
"$environment/bin/python" -B tests/oracles/bound.py "$EDOF"
# Banks of PSFs as NumPy writes them.
EDOF_PYTHON=$environment/bin/python cargo test --workspace --locked --test program -- --ignored a_bank_of_any_of_numpys_kinds
