#!/usr/bin/env bash
# Pursuits, dictionaries and demosaicing against other people's programs (tests/oracles/peers.py): scikit-learn, dictlearn, ksvd and
# colour-demosaicing from PyPI, in an environment of their own under target/.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_python

# Optimised, because one of the comparisons is of speed.
cargo build -q --release --locked -p edof-sparse --example pursue
cargo build -q --release --locked -p edof-deblur --example demosaic
environment=${CARGO_TARGET_DIR:-target}/peers
if ! "$environment/bin/python" -c 'import sklearn, colour_demosaicing, dictlearn, ksvd' 2>/dev/null; then
    say "installing scikit-learn, colour-demosaicing, dictlearn and ksvd under $environment"
    python3 -m venv --clear "$environment"
    "$environment/bin/pip" install -q -r tests/oracles/peers.txt
fi
OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 RAYON_NUM_THREADS=1 \
    "$environment/bin/python" -B tests/oracles/peers.py "${CARGO_TARGET_DIR:-target}/release/examples"
