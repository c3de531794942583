#!/usr/bin/env bash
# Trains several networks as one Slurm job array: scripts/slurm/train.sh DIR FILE, where each line of FILE holds the options of one
# edof train but --out, as in
#   --form edof-t4w12 --camera ring-outer --images /shared/kodak --seed 1
# Line N is written to DIR/net-N.safetensors; a job that was stopped goes on from its checkpoint: submit the same command again.
# The program: $EDOF, else target/release/edof. Options for sbatch: $SBATCH_OPTIONS.
set -euo pipefail
fail() { echo "slurm/train.sh: $*" >&2; exit 1; }
[ $# -eq 2 ] || fail "needs DIR and FILE"
folder=$1 list=$2
[ -r "$list" ] || fail "$list: cannot be read"
count=$(grep -c . "$list") || fail "$list: holds no line of options"
[ "$count" -eq "$(wc -l < "$list")" ] || fail "$list: holds empty lines, or its last line has no end"
command -v sbatch > /dev/null || fail "no sbatch here: this is no node of a Slurm cluster"
edof=${EDOF:-$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)/target/release/edof}
[ -x "$edof" ] || fail "$edof: not there; cargo build --release, or name it in EDOF"
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
cp "$list" "$folder/options.txt"
read -ra more <<< "${SBATCH_OPTIONS:-}"

# What is resumed needs a checkpoint that is there.
# shellcheck disable=SC2016
job=$(sbatch --parsable "${more[@]}" --array="1-$count" --job-name=edof-train --output="$folder/net-%a.log" --requeue --wrap '
out='"'$folder'"'/net-$SLURM_ARRAY_TASK_ID.safetensors
read -ra options <<< "$(sed -n "${SLURM_ARRAY_TASK_ID}p" '"'$folder/options.txt'"')"
resume=(); [ -e "$out.checkpoint" ] && resume=(--resume)
exec '"'$edof'"' train "${options[@]}" --out "$out" "${resume[@]}" --quiet')
echo "job ${job%%;*}: networks will be in $folder"
