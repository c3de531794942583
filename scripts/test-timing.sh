#!/usr/bin/env bash
# Longest paths of logic of the big designs against their limits (docs/calculator.md); apart from test.sh, because Yosys takes
# minutes for each of their stages. `edof timing --design D` shows the same figures.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators
cargo test --package edof-cosim --test timing --locked -- --include-ignored --test-threads 1
say "all passed"
