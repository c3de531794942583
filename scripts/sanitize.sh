#!/usr/bin/env bash
# AddressSanitizer over the SIMD kernels of integers and floats: their crates' tests, each kernel beside its scalar twin. A finding ends the test that met it.
# The sanitizer is no part of stable Rust: RUSTC_BOOTSTRAP lets this build alone use it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
host=$(rustc -vV | sed -n 's/^host: //p')
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")/sanitize
# What lives until the end of the process is no fault.
export ASAN_OPTIONS=detect_leaks=0 RUSTC_BOOTSTRAP=1 RUSTFLAGS=-Zsanitizer=address
cargo test --locked --lib --tests --target "$host" --target-dir "$target" -p edof-golden -p edof-float
say "no finding"
