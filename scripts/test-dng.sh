#!/usr/bin/env bash
# The page docs/dng.md against the program: tests/dng writes DNGs of every tag, computes their pictures in NumPy from the DNG
# specification, and compares them with those of the real `edof reconstruct`; LibRaw reads the same files. Arguments go on to check.py;
# the program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh

need_edof
need_environment dng tests/dng/requirements.txt
"$environment/bin/python" -B tests/dng/check.py "$EDOF" "$@"
