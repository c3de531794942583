#!/usr/bin/env bash
# What takes minutes a test and is therefore not in test.sh, in parts: soak.sh [PART]..., all parts where none is named.
#
# A part that has passed on this revision is not run again, so an interrupted soak is resumed by the same command. Each part's
# output is kept as target/soak/REVISION/PART.log and its time and result as PART.result there. A tree with changes has the revision
# "REVISION-changed", whose parts are always run. A part that fails does not stop the others; the exit status is then 1.
#
#   soak.sh --list   prints the parts with their commands
#   soak.sh --log    prints the latest result of every part as the table of docs/verification.md
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
target=${CARGO_TARGET_DIR:-target}

# A row a part: its name, and its command. Ignored tests without a part of their own are in `rest`.
parts() {
    cat <<'PARTS'
simulated-board tests circuits simulated_board::
faulty-boards   tests circuits faulty_boards::
pins            tests circuits pins:: cables:: top:: stream_core:: planted_faults::
verilog-frames  tests circuits checking::a_hundred_frames_are_exact_in_verilog checking::a_hundred_frames_of_a_photograph_are_exact_in_verilog checking::a_tile_comes_back_in_verilog
icarus-frames   tests circuits checking::a_hundred_frames_are_exact_in_icarus checking::a_hundred_frames_of_a_photograph_are_exact_in_icarus
full-frame      tests circuits full_frame::
chains          tests circuits chain:: edof_core::
full-width      tests circuits full_width:: expressions::
netlists        tests circuits netlists::
timing          tests circuits timing::
resources       tests circuits resources::
vivado          tests circuits vivado::
printed         tests circuits printed::
line-faults     released edof-board it faults::
host            tests program board::
demo            tests program hardware::the_demo hardware::the_whole_core
photographs     tests program photograph::
hard-cases      tests program hardware::every_hard_case
all-photographs tests all_photos every_boundary
random-circuits released edof-verilog-diff random ten_thousand
random-designs-1 tests program random_designs::fifty_of_seed_101
random-designs-2 tests program random_designs::fifty_of_seed_102
random-designs-3 tests program random_designs::fifty_of_seed_103
random-designs-4 tests program random_designs::fifty_of_seed_104
random-designs-5 tests program random_designs::fifty_of_seed_105
random-designs-6 tests program random_designs::fifty_of_seed_106
results         results
package         scripts/test-package.sh
axiram          scripts/test-axiram.sh
fusesoc         scripts/test-fusesoc.sh
parse           scripts/test-parse.sh
ulx3s           scripts/test-ulx3s.sh
first-light     tests circuits first_light::
litex           scripts/test-litex.sh
litex-target    scripts/test-litex-target.sh
peers           scripts/test-peers.sh
stream          scripts/test-stream.sh
play            scripts/test-play.sh
python          env EDOF_PYTHON_PROFILE=release scripts/test-python.sh
dng             scripts/test-dng.sh --random 5000 --seed 1000
gpu             scripts/test-gpu.sh
proofs          scripts/prove.sh --all
mutants-1       scripts/mutants.sh --draw 100 --seed 2018 --core
mutants-2       scripts/mutants.sh --draw 100 --seed 2019 --core
mutants-3       scripts/mutants.sh --draw 100 --seed 2020 --core
mutants-4       scripts/mutants.sh --draw 100 --seed 2021 --core
mutants-5       scripts/mutants.sh --draw 100 --seed 2022 --core
mutants-6       scripts/mutants.sh --draw 100 --seed 2023 --core
mutants-golden  scripts/rust-mutants.sh edof-golden 200
mutants-quantize scripts/rust-mutants.sh edof-quantize 200
fuzz-1          scripts/fuzz.sh 5 design camera pnm picture
fuzz-2          scripts/fuzz.sh 5 dng tags raw arrays bank
fuzz-3          scripts/fuzz.sh 5 record weights replies scene
fuzz-4          scripts/fuzz.sh 5 dictionary rows
serial-line     tests circuits host::
rest            rest
sanitizer       scripts/sanitize.sh
coverage        scripts/coverage.sh
words-1         scripts/words.sh 1
words-2         scripts/words.sh 2
words-3         scripts/words.sh 3
words-4         scripts/words.sh 4
words-5         scripts/words.sh 5
words-6         scripts/words.sh 6
PARTS
}

# The ignored tests of a test program whose names contain one of the words: each word must be that of a test.
tests() {
    local program=$1
    shift
    ignored cargo test --workspace --locked --test "$program" -- "$@"
}

# The same of a package, optimised.
released() {
    local package=$1 program=$2
    shift 2
    ignored cargo test -p "$package" --locked --release --test "$program" -- "$@"
}

ignored() {
    local list words=("$@") word
    while [ "${words[0]}" != -- ]; do words=("${words[@]:1}"); done
    list=$("$@" --ignored --list) || return
    for word in "${words[@]:1}"; do
        grep -q "$word.*: test$" <<<"$list" || { echo "no ignored test is called $word"; return 1; }
    done
    "$@" --ignored --nocapture --test-threads 2
}

# Every ignored test that no row names, but for those that other scripts or tests run.
rest() {
    local words
    words=$(parts | sed -n 's/^[^ ]* *tests [^ ]* //p; s/^[^ ]* *released [^ ]* [^ ]* //p')
    # shellcheck disable=SC2086
    cargo test --workspace --locked --lib --bins --tests -- --ignored --test-threads 2 \
        $(printf -- '--skip %s ' $words sleep_alone modes_under_one_umask numpys_kinds saturations:: networks_in_turn) \
        $(sed -n 's/^fn \([a-z_]*\).*/--skip \1/p' crates/edof-gpu/tests/device.rs)
}

# One row of each page of docs/results, measured again: every digit of its table is the same.
results() {
    cargo build -q --release --locked -p edof-cli && python3 -B scripts/soak-rows.py "$target/release/edof"
}

# A number with a comma before each three digits.
grouped() { sed ':again; s/\B[0-9]\{3\}\>/,&/; t again' <<<"$1"; }

names() { parts | cut -d' ' -f1; }

run() {
    local name=$1 command folder=$target/soak/$revision begin result=passed
    command=$(parts | sed -n "s/^$name  *//p")
    mkdir -p "$folder"
    begin=$(date +%s)
    say "$name: $command"
    $command >"$folder/$name.log" 2>&1 </dev/null || result=FAILED
    # One line: revision, seconds, result, moment.
    echo "$revision $(($(date +%s) - begin)) $result $begin" >"$folder/$name.result"
    say "$name: $result in $(cut -d' ' -f2 "$folder/$name.result") s, $folder/$name.log"
    [ "$result" = passed ]
}

passed() { grep -qs ' passed ' "$target/soak/$revision/$1.result"; }

# The latest result of each part, of whatever revision. Below the table, the words that the latest parts words-… compared, by revision.
log() {
    local name latest commit words
    declare -A compared=()
    echo "| part | revision | seconds | result |"
    echo "|---|---|---|---|"
    for name in $(names); do
        latest=$(cat "$target"/soak/*/"$name".result 2>/dev/null | sort -n -k4 | tail -n 1) || true
        read -r commit seconds result _ <<<"${latest:-– – not-run –}"
        words=$(sed -n 's/^\([0-9]*\) words compared in .*/\1/p' "$target/soak/$commit/$name.log" 2>/dev/null) || true
        [ "$result" != passed ] || [ -z "$words" ] || compared[$commit]=$((${compared[$commit]:-0} + words))
        echo "| \`$name\` | $commit | $seconds | ${result//-/ }${words:+, $(grouped "$words") words} |"
    done
    for commit in "${!compared[@]}"; do
        printf '\nWords compared between circuit and model on %s: %s.\n' "$commit" "$(grouped "${compared[$commit]}")"
    done
}

revision=$(git rev-parse --short=12 HEAD)
[ -z "$(git status --porcelain)" ] || revision=$revision-changed

case ${1:-} in
    --list) parts; exit ;;
    --log) log; exit ;;
esac
for name in "$@"; do
    names | grep -qx -- "$name" || fail "no part $name; expected one of: $(names | tr '\n' ' ')"
done
need_simulators
failed=()
for name in ${*:-$(names)}; do
    if [ "${revision%-changed}" = "$revision" ] && passed "$name"; then
        say "$name has passed on $revision"
    else
        run "$name" || failed+=("$name")
    fi
done
log
[ "${#failed[@]}" -eq 0 ] || fail "failed: ${failed[*]}"
say "all passed"
