#!/usr/bin/env bash
# CPU time of a 1080p frame: edof.reconstruct and the program's pipeline in turn, in release builds. Prints least and median seconds of each round.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_python
CARGO_TARGET_DIR=$(realpath -m "${CARGO_TARGET_DIR:-target}")
export CARGO_TARGET_DIR
environment=$CARGO_TARGET_DIR/python-bench
if [ ! -x "$environment/bin/python" ]; then
    python3 -m venv "$environment"
fi
"$environment/bin/python" -m pip install -q --disable-pip-version-check ./python
cargo build -q --release --locked -p edof-python --example frame
frames=${1:-10}
for round in 1 2 3 4; do
    printf 'round %s, program: ' "$round"
    "$CARGO_TARGET_DIR/release/examples/frame" "$frames"
    printf 'round %s, Python:  ' "$round"
    "$environment/bin/python" python/benches/frame.py "$frames"
done
