#!/usr/bin/env bash
# Pursuits, dictionaries, demosaicing, metrics, optics and the float network against other people's programs and NumPy
# (tests/oracles/peers.py): scikit-learn, scikit-image, dictlearn, ksvd and colour-demosaicing from PyPI, in an environment under target/.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh

# Optimised, because one of the comparisons is of speed.
cargo build -q --release --locked -p edof-numerics --example pursue
cargo build -q --release --locked -p edof-deblur --example demosaic
cargo build -q --release --locked -p edof-cli
need_environment peers tests/oracles/peers.txt
OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 RAYON_NUM_THREADS=1 \
    "$environment/bin/python" -B tests/oracles/peers.py "${CARGO_TARGET_DIR:-target}/release"
