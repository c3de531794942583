#!/usr/bin/env bash
# Mutants of Rust code, of which a crate's own tests must see nine in ten: rust-mutants.sh CRATE N [SEED] draws N of the crate's mutants
# (cargo-mutants) and tests each. A run that was stopped goes on: mutants that were seen on this revision are not tested again. The score, with
# those that nothing saw, is target/rust-mutants/CRATE/score.md; equivalent ones are listed with reasons in proofs/rust-mutants.json and do not count.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
[ $# -ge 2 ] || fail "of which crate, and how many? rust-mutants.sh CRATE N [SEED]"
[ -d "crates/$1" ] || fail "'$1': must be the name of a crate, one of $(cd crates && echo *)"
[[ $2 =~ ^[1-9][0-9]*$ ]] || fail "'$2': must be a number of mutants"
crate=$1
version=27.1.0
need_python
tools=$(realpath -m "${CARGO_TARGET_DIR:-target}")/rust-mutants
out=$tools/$crate
mkdir -p "$out"
if ! "$tools/bin/cargo-mutants" mutants --version 2>/dev/null | grep -qF "$version"; then
    say "installing cargo-mutants $version under $tools"
    cargo install -q --locked --root "$tools" --version "$version" cargo-mutants
fi
PATH=$tools/bin:$PATH
# What was seen of another revision says nothing of this one.
revision=$(git rev-parse HEAD)
if [ "$(cat "$out/revision" 2>/dev/null)" != "$revision" ]; then
    rm -rf "$out/mutants.out" "$out/mutants.out.old"
    echo "$revision" >"$out/revision"
fi
cargo mutants --package "$crate" --list --json >"$out/all.json"
python3 -B proofs/rust_mutants.py draw "$out" "$2" "${3:-2018}"
# A mutant changes one function: compiled incrementally and without line numbers it takes three seconds in place of forty.
export CARGO_INCREMENTAL=1 CARGO_PROFILE_DEV_DEBUG=false
# Its exit status says whether any was missed; the score says how many. Examples and benches would be compiled for each mutant and test nothing.
cargo mutants --package "$crate" --config "$out/drawn.toml" --output "$out" --iterate --no-shuffle --colors never --jobs 2 --minimum-test-timeout 60 --cargo-arg=--tests ||
    [ -e "$out/mutants.out/outcomes.json" ] || fail "cargo-mutants did not run; see above"
python3 -B proofs/rust_mutants.py score "$out"
