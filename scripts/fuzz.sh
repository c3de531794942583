#!/usr/bin/env bash
# Fuzzes the parsers of files and of the board's answers (fuzz/) by libFuzzer: fuzz.sh MINUTES [TARGET...], so many minutes for each target, all of
# them where none is named. A finding ends its target; its input lies in target/fuzz/TARGET and its message is in the log there. The corpus is kept
# in target/fuzz/TARGET/corpus, so that the next run goes on with it.
#
#   fuzz.sh --log     prints how many inputs each target has had on this revision, in all runs together
#
# Findings are panics, more memory at one time than the target allows (fuzz/src/main.rs), and more than ten seconds for
# one input.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
out=$(realpath -m "${CARGO_TARGET_DIR:-target}")/fuzz
revision=$(git rev-parse --short=12 HEAD)
[ -z "$(git status --porcelain)" ] || revision=$revision-changed
mapfile -t all < <(sed -n 's/.*Target { name: "\([a-z]*\)".*/\1/p' fuzz/src/main.rs)
if [ "${1:-}" = --log ]; then
    sum=0
    for target in "${all[@]}"; do
        runs=$(awk -v revision="$revision" '$1 == revision { sum += $2 } END { print sum + 0 }' "$out/$target/runs" 2>/dev/null || echo 0)
        echo "$target $runs"
        sum=$((sum + runs))
    done
    echo "$sum inputs on $revision"
    exit
fi
minutes=${1:-}
[[ $minutes =~ ^[0-9]+$ ]] || fail "how many minutes for each target? fuzz.sh MINUTES [TARGET...]"
shift
command -v g++ >/dev/null || install_packages g++
host=$(rustc -vV | sed -n 's/^host: //p')
# Coverage for libFuzzer, as cargo-fuzz asks for it; no option that only a nightly compiler has.
flags="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters"
flags+=" -Cllvm-args=-sanitizer-coverage-pc-table -Cllvm-args=-sanitizer-coverage-trace-compares"
# Only what runs on the target is built so, not the programs of the build.
RUSTFLAGS=$flags cargo build --release --locked --manifest-path fuzz/Cargo.toml --target "$host" --target-dir "$out/build"
fuzzer=$out/build/$host/release/edof-fuzz
targets=("$@")
[ "${#targets[@]}" -gt 0 ] || targets=("${all[@]}")
# Inputs as files, in memory where the system has such a folder.
TMPDIR=$(mktemp -d -p /dev/shm 2>/dev/null || mktemp -d)
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT
failed=()
for target in "${targets[@]}"; do
    folder=$out/$target
    mkdir -p "$folder/corpus"
    EDOF_FUZZ=$target EDOF_SEEDS=$folder/corpus "$fuzzer" -runs=0 >"$folder/log" 2>&1 || fail "no target of the name '$target': see $folder/log"
    EDOF_FUZZ=$target "$fuzzer" -max_total_time=$((60 * minutes)) -max_len=16384 -timeout=10 -rss_limit_mb=4096 -print_final_stats=1 \
        -artifact_prefix="$folder/" "$folder/corpus" >>"$folder/log" 2>&1 || failed+=("$target")
    runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$folder/log" | tail -1)
    echo "$revision ${runs:-0}" >>"$folder/runs"
    say "$target: ${runs:-0} inputs"
done
[ "${#failed[@]}" = 0 ] || fail "findings in ${failed[*]}: inputs and logs in $out"
say "no finding"
