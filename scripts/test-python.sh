#!/usr/bin/env bash
# The Python package in a fresh virtual environment: its wheel is built and installed, pytest holds every result to the program's (and runs the examples for cocotb in
# Icarus), the notebooks run, mypy --strict and stubtest check the types. The program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators
need_python

# Optimised as for the workspace's tests, and beside them: what both need is built once.
export CARGO_INCREMENTAL=${CARGO_INCREMENTAL:-0} CARGO_PROFILE_DEV_DEBUG=${CARGO_PROFILE_DEV_DEBUG:-false}
CARGO_TARGET_DIR=$(realpath -m "${CARGO_TARGET_DIR:-target}")
export CARGO_TARGET_DIR
need_edof
export EDOF

environment=$CARGO_TARGET_DIR/python
say "lints of the extension"
(cd python && cargo fmt --check && CARGO_TARGET_DIR=$CARGO_TARGET_DIR/lints cargo clippy -q --locked -- --deny warnings)
say "installing the package under $environment"
python3 -m venv --clear "$environment"
python=$environment/bin/python
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
EDOF_PYTHON_PROFILE=${EDOF_PYTHON_PROFILE:-dev} scripts/wheel.sh "$work"
"$python" -m pip install -q --disable-pip-version-check "$work"/edof-*.whl -r python/tests/requirements.txt

# From elsewhere, so that the installed package is found and not its source.
source=$PWD/python
cd "$work"
say "types"
"$python" -m mypy --strict --cache-dir "$work/mypy" --config-file "$source/pyproject.toml" -p edof
"$python" -m mypy.stubtest --concise --mypy-config-file "$source/pyproject.toml" --allowlist "$source/tests/stubtest.txt" --ignore-unused-allowlist edof
say "tests"
"$python" -m pytest -q -p no:cacheprovider -c "$source/pyproject.toml" "$source/tests" "$@"
say "notebooks"
for notebook in lens speed board; do
    MPLBACKEND=Agg "$python" "$source/notebooks/$notebook.py"
done
if [ -n "${EDOF_FIGURES:-}" ]; then
    mkdir -p "$EDOF_FIGURES"
    cp ./*.png "$EDOF_FIGURES"
fi
say "Python: all passed, $SECONDS seconds"
