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

build_as_tests
say "format"
cargo fmt --all --check

trap stop_jobs EXIT
failed=()

# What only reads the source has a folder of its own, so that nobody waits for a lock. The folder above both is there before: of two
# cargos that make it at once, one may replace it under the other.
mkdir -p "${CARGO_TARGET_DIR:-target}"
lint() {
    local -x CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-target}/lints RUSTDOCFLAGS=--deny=warnings
    cargo clippy --workspace --all-targets --locked -- --deny warnings
    cargo doc --workspace --no-deps --document-private-items --locked
}
beside "lints and documentation" lint

# The same cases each time: a red run can be repeated, and nobody's change is blamed for another's case. Random cases are for
# a soak, which looks for what these miss: PROPTEST_RNG_SEED=$RANDOM ./scripts/test.sh
export PROPTEST_RNG_SEED=${PROPTEST_RNG_SEED:-2018}
# Benchmarks are compiled by the lints; running them is no test.
say "building"
cargo test --workspace --lib --bins --tests --examples --locked --no-run
wait_for "lints and documentation"
[ "${#failed[@]}" = 0 ] || fail "failed: ${failed[*]}"

# Circuits in simulation beside all else, whose programs come one after another. Programs are named of the whole workspace: for a
# package alone cargo would choose other features and build everything again.
others=(--lib --bins --examples)
programs=$(cargo metadata --no-deps --format-version 1 --locked | python3 -c '
import json, sys
targets = [target for package in json.load(sys.stdin)["packages"] for target in package["targets"]]
print(*[target["name"] for target in targets if target["kind"] == ["test"] and target["name"] != "circuits"])')
for program in $programs; do others+=(--test "$program"); done
tests() { cargo test --workspace --no-fail-fast --locked "$@"; }
# They wait for each other's compilers now and then: one more at a time than there are cores.
beside "tests of circuits" tests --test circuits -- --test-threads=$(($(nproc) + 1))
EDOF=${CARGO_TARGET_DIR:-target}/debug/edof beside "the contract on paper" ./scripts/test-oracle.sh
# Whoever runs this waits for minutes, and is told everything that failed.
say "tests of all else"
tests "${others[@]}" || failed+=("tests of all else")
[ "$(id -u)" != 0 ] || tests --test modes -- --ignored owner_and_group || failed+=("tests of root")
./scripts/test-photographs.sh || failed+=("tests on photographs")
say "examples in the documentation"
cargo test --workspace --exclude edof-python --doc --locked || failed+=("examples in the documentation")
wait_for "the contract on paper"
wait_for "tests of circuits"
[ "${#failed[@]}" = 0 ] || fail "failed: $(printf '%s; ' "${failed[@]}")"
say "all passed, $SECONDS seconds"
