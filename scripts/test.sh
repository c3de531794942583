#!/usr/bin/env bash
# Every check there is: format, lints, documentation, tests, examples in the documentation. The optional feature
# that brings 130 crates has a script of its own, test-camera-raw.sh.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators
for component in fmt clippy; do
    if ! cargo "$component" --version >/dev/null 2>&1; then
        command -v rustup >/dev/null || fail "cargo $component is missing, and no rustup here to add it"
        rustup component add "${component/fmt/rustfmt}" >/dev/null
    fi
done

# What would make the next build faster costs this one a third, unless somebody builds here again and again (CARGO_INCREMENTAL=1).
export CARGO_INCREMENTAL=${CARGO_INCREMENTAL:-0}
say "format"
cargo fmt --all --check
say "lints"
cargo clippy --workspace --all-targets --locked -- --deny warnings
say "documentation"
RUSTDOCFLAGS=--deny=warnings cargo doc --workspace --no-deps --document-private-items --locked
say "tests"
# The same cases each time: a red run can be repeated, and nobody's change is blamed for another's case. Random cases are for
# a soak, which looks for what these miss: PROPTEST_RNG_SEED=$RANDOM ./scripts/test.sh
export PROPTEST_RNG_SEED=${PROPTEST_RNG_SEED:-2018}
# Benchmarks are compiled by the lints above; running them is no test.
cargo test --workspace --lib --bins --tests --examples --locked --no-run
# Simulations run beside all else: many programs keep only one core busy. Both halves name programs of the whole workspace: for a
# package alone cargo would choose other features and build everything again.
simulations=() others=(--lib --bins --examples)
for program in crates/*/tests/*.rs tests/*.rs; do
    name=$(basename "$program" .rs)
    case $program in
    crates/edof-cosim/*) simulations+=(--test "$name") ;;
    *) others+=(--test "$name") ;;
    esac
done
said=$(mktemp)
cargo test --workspace --no-fail-fast --locked "${simulations[@]}" >"$said" 2>&1 &
# shellcheck disable=SC2064 # this process, this file
trap "kill $! 2>/dev/null || true; rm -f '$said'" EXIT
cargo test --workspace --no-fail-fast --locked "${others[@]}"
wait $! || { cat "$said"; fail "simulations differ or did not run"; }
cat "$said"
say "the contract on paper"
./scripts/test-oracle.sh
say "examples in the documentation"
cargo test --workspace --doc --locked
say "all passed, $SECONDS seconds"
