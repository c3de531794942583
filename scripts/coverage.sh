#!/usr/bin/env bash
# Lines and bits of each Verilog module that the simulations of the tests cover, as a table in Markdown: coverage.sh [MODULE...], the test modules of
# `circuits`, those of the blocks, the calculator and the core where none is named. Models that count are compiled for it, and run at a twentieth of the usual speed. A run that was
# stopped goes on with the modules that are left. It fails where a module has less than 95 % of its lines or 90 % of its bits; proofs/coverage.json says
# which cannot be covered, and why.
#
#   coverage.sh --missing VERILOG-MODULE    prints what was not covered of a module
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
revision=$(git rev-parse --short=12 HEAD)
[ -z "$(git status --porcelain -- crates rtl sim)" ] || revision=$revision-changed
export EDOF_COVERAGE=$target/coverage/$revision
mkdir -p "$EDOF_COVERAGE/done"
if [ "${1:-}" = --missing ]; then
    exec python3 -B proofs/coverage.py "$EDOF_COVERAGE" --missing "$2"
fi
need_simulators
tests() { cargo test -q --locked -p edof-cosim --test circuits -- "$@"; }
mapfile -t all < <(tests --list | sed -n 's/^\([a-z_0-9]*\)::.*: test$/\1/p' | sort -u)
modules=("$@")
# Whole boards and the calculator at its full width would take hours. Netlists have other lines. The others here simulate nothing of the
# circuit.
left_out='full_width|checking|faulty_boards|simulated_board|netlists|board|emitted|generated|kernels|lint|lint_designs|printed|resources|timing|verilator|vivado|yosys'
[ $# -gt 0 ] || mapfile -t modules < <(printf '%s\n' "${all[@]}" | grep -vxE "$left_out")
failed=()
for module in "${modules[@]}"; do
    [ ! -e "$EDOF_COVERAGE/done/$module" ] || continue
    # What a run that was stopped has left belongs to tests that run again.
    rm -f "$EDOF_COVERAGE"/*.dat
    say "$module"
    # A filter of tests is a part of their names: those of modules whose names end alike run for themselves.
    alike=()
    for other in "${all[@]}"; do [[ $other != *_"$module" ]] || alike+=(--skip "$other::"); done
    tests "$module::" "${alike[@]}" || { failed+=("$module"); continue; }
    python3 -B proofs/coverage.py "$EDOF_COVERAGE" --quiet
    touch "$EDOF_COVERAGE/done/$module"
done
[ "${#failed[@]}" = 0 ] || fail "tests failed: ${failed[*]}"
python3 -B proofs/coverage.py "$EDOF_COVERAGE"
