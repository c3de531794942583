#!/usr/bin/env bash
# Every check there is: format, lints, documentation, tests, examples in the documentation, the optional features.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
for component in fmt clippy; do
    if ! cargo "$component" --version >/dev/null 2>&1; then
        command -v rustup >/dev/null || fail "cargo $component is missing, and no rustup here to add it"
        rustup component add "${component/fmt/rustfmt}" >/dev/null
    fi
done

say "format"
cargo fmt --all --check
say "lints"
cargo clippy --workspace --all-targets --locked -- --deny warnings
say "documentation"
RUSTDOCFLAGS=--deny=warnings cargo doc --workspace --no-deps --document-private-items --locked
say "tests"
cargo test --workspace --all-targets --locked
say "examples in the documentation"
cargo test --workspace --doc --locked
say "camera raw (optional feature)"
cargo test --package edof-io --features camera-raw --locked
say "all passed"
