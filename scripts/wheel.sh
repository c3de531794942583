#!/usr/bin/env bash
# Builds the Python package as a wheel: wheel.sh [FOLDER], into dist/ where none is named. One wheel serves every Python from 3.9 on (abi3) and
# installs in seconds, on machines without Rust, too. EDOF_PYTHON_PROFILE=dev builds as for the tests.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_python
folder=${1:-dist}
CARGO_TARGET_DIR=$(realpath -m "${CARGO_TARGET_DIR:-target}")
export CARGO_TARGET_DIR

environment=$CARGO_TARGET_DIR/wheel
[ -x "$environment/bin/pip" ] || python3 -m venv --clear "$environment"
# An earlier wheel would be found beside the new one.
rm -f "$folder"/edof-*.whl
# Verbose: the crates that are compiled are the progress.
MATURIN_PEP517_ARGS="--profile ${EDOF_PYTHON_PROFILE:-release} --compatibility pypi" \
    "$environment/bin/pip" wheel -v --disable-pip-version-check --no-deps --wheel-dir "$folder" ./python
say "pip install $(ls "$folder"/edof-*.whl)"
