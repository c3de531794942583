#!/usr/bin/env bash
# edof.torch against PyTorch: gradcheck of the blur, and the float network as a module equal within 1e-5. The wheel (CPU) is some 200 MB; so this is a script of its own.
# EDOF_TORCH_INDEX names another index for it, if the usual one has only larger wheels.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_python
CARGO_TARGET_DIR=$(realpath -m "${CARGO_TARGET_DIR:-target}")
export CARGO_TARGET_DIR
environment=$CARGO_TARGET_DIR/torch
if ! "$environment/bin/python" -c 'import torch, pytest' 2>/dev/null; then
    say "installing PyTorch under $environment"
    python3 -m venv --clear "$environment"
    "$environment/bin/python" -m pip install -q --disable-pip-version-check pytest numpy
    "$environment/bin/python" -m pip install -q --disable-pip-version-check ${EDOF_TORCH_INDEX:+--index-url "$EDOF_TORCH_INDEX"} torch
fi
MATURIN_PEP517_ARGS="--profile ${EDOF_PYTHON_PROFILE:-dev}" "$environment/bin/python" -m pip install -q --disable-pip-version-check --force-reinstall --no-deps ./python
source=$PWD/python
cd /
"$environment/bin/python" -m pytest -q -p no:cacheprovider -c "$source/pyproject.toml" "$source/tests/test_torch.py"
say "PyTorch: all passed, $SECONDS seconds"
