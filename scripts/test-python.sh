#!/usr/bin/env bash
# The Python package in a fresh virtual environment: its wheel is built and installed, pytest holds every result to the program's (and runs the examples for cocotb in
# Icarus), the notebooks run, mypy --strict and stubtest check the types. The program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators
need_python

# Optimised as for the workspace's tests, and beside them: what both need is built once.
CARGO_TARGET_DIR=$(realpath -m "${CARGO_TARGET_DIR:-target}")
export CARGO_TARGET_DIR
need_edof
export EDOF

environment=$CARGO_TARGET_DIR/python
python=$environment/bin/python
work=$(mktemp -d)
trap 'stop_jobs; rm -rf "$work"' EXIT
failed=()
good() { [ "${#failed[@]}" = 0 ] || fail "failed: ${failed[*]}"; }

# What the workspace's tests have built is used as it is if each crate has the features that it has there. One more, and all that stands on it is built again.
features() { cargo tree --locked --prefix none -e normal,build,dev -f '{p} {f}' "$@" | sed 's/ (\*)$//' | sort -u; }
features --workspace >"$work/there"
features -p edof-python --features extension >"$work/here"
again=$(awk 'NR == FNR { has[$1]; seen[$0]; next } $1 in has && !($0 in seen) && $1 != "edof-python"' "$work/there" "$work/here")
[ -z "$again" ] || fail "built again for Python alone; give python/Cargo.toml and the workspace the same features: $again"

lint() { CARGO_TARGET_DIR=$CARGO_TARGET_DIR/lints cargo clippy -q -p edof-python --features extension --locked -- --deny warnings; }
beside "lints of the extension" lint
say "installing the package under $environment"
python3 -m venv --clear "$environment"
EDOF_PYTHON_PROFILE=${EDOF_PYTHON_PROFILE:-dev} scripts/wheel.sh "$work"
"$python" -m pip install -q --disable-pip-version-check "$work"/edof-*.whl -r python/tests/requirements.txt
wait_for "lints of the extension"
good

# From elsewhere, so that the installed package is found and not its source.
source=$PWD/python
cd "$work"
types_and_notebooks() {
    "$python" -m mypy --strict --cache-dir "$work/mypy" --config-file "$source/pyproject.toml" -p edof
    "$python" -m mypy.stubtest --concise --mypy-config-file "$source/pyproject.toml" --allowlist "$source/tests/stubtest.txt" --ignore-unused-allowlist edof
    for notebook in lens speed board; do
        MPLBACKEND=Agg "$python" "$source/notebooks/$notebook.py"
    done
}
beside "types and notebooks" types_and_notebooks
say "tests"
"$python" -m pytest -q -p no:cacheprovider -c "$source/pyproject.toml" "$source/tests" "$@" || failed+=(tests)
wait_for "types and notebooks"
good
if [ -n "${EDOF_FIGURES:-}" ]; then
    mkdir -p "$EDOF_FIGURES"
    cp ./*.png "$EDOF_FIGURES"
fi
say "Python: all passed, $SECONDS seconds"
