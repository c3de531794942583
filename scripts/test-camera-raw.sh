#!/usr/bin/env bash
# Tests of the optional feature camera-raw; apart from test.sh, because its decoder takes minutes to build.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
cargo test --package edof-io --features camera-raw --locked
say "all passed"
