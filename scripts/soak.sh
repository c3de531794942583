#!/usr/bin/env bash
# What takes minutes a test and is therefore not in test.sh: every photograph with every network, chains of many layers, more random expressions, `paper` at full width, the cells of more designs,
# the longest paths of logic of the big designs and of all blocks around them against their limits (docs/calculator.md), 20,000 random faults on the line to a board, networks into its circuit in Verilator, hosts that are killed, a generated
# directory under FuseSoC, the core with cocotbext-axi as its memory, stages routed by nextpnr, LiteX's clients at both simulated boards, the LiteX target with LiteDRAM in Verilator, netlists of chain, agents and receiver with models of the cells, the KC705's top between models of its primitives, a frame of 1080p
# through the bitstream's files around a small calculator, a hundred frames' CRCs in both simulators, the long proofs, 500 random mutants of the circuit, five minutes of fuzzing for each parser, one row of each page of docs/results measured again to the last bit. More than an hour on two cores.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators
cargo test --workspace --locked --no-fail-fast --test circuits --test program --test all_photos --test it -- --ignored --test-threads 2
cargo test -p edof-verilog-diff --locked --release --test random -- --ignored
./scripts/test-package.sh
./scripts/test-axiram.sh
./scripts/test-fusesoc.sh
./scripts/test-parse.sh
./scripts/test-route.sh
./scripts/test-litex.sh
./scripts/test-litex-target.sh
./scripts/test-peers.sh
./scripts/prove.sh --all
./scripts/mutants.sh --draw 500 --seed 2018 --core
./scripts/fuzz.sh 5
say "all passed"
