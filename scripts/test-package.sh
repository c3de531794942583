#!/usr/bin/env bash
# What others would download of the Verilog backend: its three crates as packages, their own tests, and a stranger's UART that stands on the
# packages alone and runs in three simulations. Nothing is downloaded that is not at hand.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh

target=$(realpath -m "${CARGO_TARGET_DIR:-target}")
cargo package -q --offline --allow-dirty --no-verify -p edof-verilog -p edof-verilog-derive -p edof-verilog-diff
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for crate in edof-verilog edof-verilog-derive edof-verilog-diff; do
    tar -xzf "$target/package/$crate-0.1.0.crate" -C "$work"
    if grep -rlE 'edof-hdl|edof_hdl|\.\./\.\.' "$work/$crate-0.1.0" --include='*.rs' --include='*.md'; then
        fail "$crate: its package names what is not in it"
    fi
done
cp -r tests/stranger "$work/stranger"
sed "s|@packages@|$work|" tests/stranger/Cargo.toml.in >"$work/stranger/Cargo.toml"
cp Cargo.lock "$work/stranger/Cargo.lock"
say "the stranger's crate"
(cd "$work/stranger" && CARGO_TARGET_DIR="$target" cargo test -q --offline)
say "the packages' own tests"
for crate in edof-verilog edof-verilog-diff; do
    sed -n '/^\[patch/,$p' "$work/stranger/Cargo.toml" >>"$work/$crate-0.1.0/Cargo.toml"
    cp Cargo.lock "$work/$crate-0.1.0/Cargo.lock"
    (cd "$work/$crate-0.1.0" && CARGO_TARGET_DIR="$target" cargo test -q --offline --lib --tests --examples)
done
say "three packages, and a stranger's UART on them"
