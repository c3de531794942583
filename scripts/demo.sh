#!/usr/bin/env bash
# The whole program in one go: builds it and runs `edof demo`, which leaves out/report.html. Arguments go to the demo.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh

say "building (a few minutes the first time)"
cargo build --release --locked --package edof-cli
edof="${CARGO_TARGET_DIR:-target}/release/edof"
say "edof demo ($edof, $(($(stat -c %s "$edof") / 1000000)) MB)"
"$edof" demo "$@"
