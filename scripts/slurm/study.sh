#!/usr/bin/env bash
# Shares a study out among the nodes of a Slurm cluster: scripts/slurm/study.sh PARTS DIR STUDY [OPTION…], as in
#   scripts/slurm/study.sh 16 /shared/speed single-depth --nets edof-t4w12 --stride 8,4,2
# One job of an array measures each part (--shard) into DIR/part-N.jsonl; a last one merges them into DIR/rows.jsonl with report.html,
# rows.csv and tables.md beside it. Jobs that are killed or run out of time go on where they were: submit the same command again.
# The program: $EDOF, else target/release/edof. Options for sbatch: $SBATCH_OPTIONS (as in "--partition=long --time=8:00:00").
set -euo pipefail
fail() { echo "slurm/study.sh: $*" >&2; exit 1; }
[ $# -ge 3 ] || fail "needs PARTS, DIR and a study: single-depth, multi-depth, blind or knobs"
parts=$1 folder=$2 study=$3
shift 3
[[ $parts =~ ^[1-9][0-9]*$ ]] || fail "PARTS '$parts': must be a number above 0"
[[ $study =~ ^(single-depth|multi-depth|blind|knobs)$ ]] || fail "study '$study': must be single-depth, multi-depth, blind or knobs, whose rows can be shared out"
command -v sbatch > /dev/null || fail "no sbatch here: this is no node of a Slurm cluster"
edof=${EDOF:-$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)/target/release/edof}
[ -x "$edof" ] || fail "$edof: not there; cargo build --release, or name it in EDOF"
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
read -ra more <<< "${SBATCH_OPTIONS:-}"

printf -v command '%q ' "$edof" study "$study" "$@" --quiet
array=$(sbatch --parsable "${more[@]}" --array="1-$parts" --job-name="edof-$study" --output="$folder/part-%a.log" --requeue \
    --wrap "$command --rows '$folder/part-'\$SLURM_ARRAY_TASK_ID.jsonl --shard \$SLURM_ARRAY_TASK_ID/$parts")
files=$(seq -f "'$folder/part-%.0f.jsonl'" -s ' ' 1 "$parts")
merge=$(sbatch --parsable "${more[@]}" --dependency="afterok:${array%%;*}" --job-name="edof-merge" --output="$folder/merge.log" \
    --wrap "'$edof' study merge $files --out '$folder/rows.jsonl' --force --any-machine --report '$folder/report.html' --csv '$folder/rows.csv' \
--markdown '$folder/tables.md'")
echo "parts: job ${array%%;*}, merge: job ${merge%%;*}; rows and report will be in $folder"
