#!/usr/bin/env bash
# Pursuits, dictionaries, demosaicing, metrics, optics and the float network against other people's programs and NumPy
# (tests/oracles/peers.py): scikit-learn, scikit-image, dictlearn, ksvd and colour-demosaicing from PyPI, in an environment under target/.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_python

# Optimised, because one of the comparisons is of speed.
cargo build -q --release --locked -p edof-numerics --example pursue
cargo build -q --release --locked -p edof-deblur --example demosaic
cargo build -q --release --locked -p edof-cli
environment=${CARGO_TARGET_DIR:-target}/peers
if ! "$environment/bin/python" -c 'import sklearn, skimage, PIL, colour_demosaicing, dictlearn, ksvd' 2>/dev/null; then
    say "installing what is compared with under $environment"
    python3 -m venv --clear "$environment"
    "$environment/bin/pip" install -q -r tests/oracles/peers.txt
fi
OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 RAYON_NUM_THREADS=1 \
    "$environment/bin/python" -B tests/oracles/peers.py "${CARGO_TARGET_DIR:-target}/release"
