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

# Runs a job beside others. What it says is kept until it is waited for, so that no two mix.
logs=$(mktemp -d)
declare -A jobs=()
beside() {
    local name=$1
    shift
    "$@" >"$logs/$name" 2>&1 &
    jobs[$name]=$!
}
wait_for() {
    local failed=0
    wait "${jobs[$1]}" || failed=1
    unset "jobs[$1]"
    say "$1"
    cat "$logs/$1"
    [ "$failed" = 0 ] || fail "$1: failed"
}
stop() {
    [ "${#jobs[@]}" = 0 ] || kill "${jobs[@]}" 2>/dev/null || true
    rm -rf "$logs"
}
trap stop EXIT

# The same cases each time: a red run can be repeated, and nobody's change is blamed for another's case. Random cases are for
# a soak, which looks for what these miss: PROPTEST_RNG_SEED=$RANDOM ./scripts/test.sh
export PROPTEST_RNG_SEED=${PROPTEST_RNG_SEED:-2018}
# Benchmarks are compiled by the lints above; running them is no test.
say "building"
cargo test --workspace --lib --bins --tests --examples --locked --no-run

# Three lists of programs, side by side: many programs keep only one core busy. All of them name programs of the whole workspace:
# for a package alone cargo would choose other features and build everything again.
circuits=(blocks board chain chain_in_rust edof_core full_width planted_faults stream_core video_blocks)
simulations=() tools=() others=(--lib --bins --examples)
for program in crates/*/tests/*.rs tests/*.rs; do
    name=$(basename "$program" .rs)
    case $program in
    crates/edof-cosim/*)
        if [[ " ${circuits[*]} " == *" $name "* ]]; then simulations+=(--test "$name"); else tools+=(--test "$name"); fi
        ;;
    *) others+=(--test "$name") ;;
    esac
done
tests() { cargo test --workspace --no-fail-fast --locked "$@"; }
beside "tests of circuits" tests "${simulations[@]}"
beside "tests of tools and parts" tests "${tools[@]}"
say "tests of all else"
tests "${others[@]}"
say "the contract on paper"
EDOF=${CARGO_TARGET_DIR:-target}/debug/edof ./scripts/test-oracle.sh
say "examples in the documentation"
cargo test --workspace --doc --locked
wait_for "tests of tools and parts"
wait_for "tests of circuits"
say "all passed, $SECONDS seconds"
