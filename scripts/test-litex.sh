#!/usr/bin/env bash
# LiteX's clients against a simulated board in Rust: its registers, weights and their CRC, and the map by name. LiteX comes from PyPI. The program is
# built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_python

if [ -z "${EDOF:-}" ]; then
    cargo build -q -p edof-cli --locked
    EDOF=${CARGO_TARGET_DIR:-target}/debug/edof
fi
EDOF=$(realpath "$EDOF")
environment=$(realpath -m "${CARGO_TARGET_DIR:-target}/litex")
if ! [ -x "$environment/bin/litex_server" ]; then
    say "installing LiteX under $environment"
    python3 -m venv --clear "$environment"
    "$environment/bin/pip" install -q -r tests/litex/requirements.txt
fi
work=$(mktemp -d)
"$EDOF" board sim -q --design tiny --link "$work/board" >"$work/said.txt" 2>&1 &
board=$!
trap 'kill $board 2>/dev/null || true; rm -rf "$work"' EXIT
for _ in $(seq 100); do [ -e "$work/board" ] && break; sleep 0.1; done
"$EDOF" board map --format csr-csv >"$work/csr.csv"
"$environment/bin/python" tests/litex/client.py "$(realpath "$work/board")" "$work/csr.csv" 921600 32
say "LiteX's clients work"
