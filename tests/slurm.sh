#!/usr/bin/env bash
# scripts/slurm/study.sh on a cluster of one machine, made of Debian's slurm-wlm and torn down again: a study in three parts, one of
# which is killed and submitted again, must merge to the rows of an uninterrupted one, times aside. Not part of scripts/test.sh: it
# needs root, and slurm-wlm and munge installed (apt-get install slurm-wlm munge). The program: $EDOF, else target/release/edof.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
fail() { echo "slurm.sh: $*" >&2; exit 1; }
[ "$(id -u)" -eq 0 ] || fail "must be root: it starts a Slurm controller"
for tool in slurmctld slurmd munged sbatch; do
    command -v $tool > /dev/null || fail "$tool is not installed: apt-get install slurm-wlm munge"
done
export EDOF=${EDOF:-$PWD/target/release/edof}
[ -x "$EDOF" ] || fail "$EDOF: not there; cargo build --release"

here=$(mktemp -d)
export SLURM_CONF=$here/slurm.conf
daemons=()
end() {
    status=$?
    [ ${#daemons[@]} -eq 0 ] || kill "${daemons[@]}" 2> /dev/null || true
    wait
    [ $status -eq 0 ] || tail -n 20 "$here"/*.log >&2
    rm -rf "$here"
    exit $status
}
trap end EXIT
chmod 755 "$here"
mkdir "$here/state" "$here/spool" "$here/munge"
dd if=/dev/urandom of="$here/munge/key" bs=1024 count=1 status=none
chmod 700 "$here/munge"; chmod 400 "$here/munge/key"
munged --foreground --force --key-file="$here/munge/key" --socket="$here/munge.socket" --pid-file="$here/munged.pid" \
    --seed-file="$here/munge/seed" > "$here/munged.log" 2>&1 & daemons+=($!)
host=$(hostname -s)
cat > "$SLURM_CONF" <<EOF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$here/munge.socket
CryptoType=crypto/munge
SlurmctldPort=26817
SlurmdPort=26818
StateSaveLocation=$here/state
SlurmdSpoolDir=$here/spool
SlurmctldPidFile=$here/slurmctld.pid
SlurmdPidFile=$here/slurmd.pid
ProctrackType=proctrack/pgid
TaskPlugin=task/none
MpiDefault=none
ReturnToService=2
SchedulerType=sched/backfill
SelectType=select/cons_tres
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
EOF
slurmctld -D > "$here/slurmctld.log" 2>&1 & daemons+=($!)
slurmd -D -N "$host" > "$here/slurmd.log" 2>&1 & daemons+=($!)
for ((i = 0; i < 60; i++)); do
    sinfo -h -o %T 2> /dev/null | grep -q idle && break
    sleep 1
done
sinfo -h -o %T | grep -q idle || fail "the node never became idle"

mkdir "$here/photos"
"$EDOF" scene leaves --size 192x128 --out "$here/drawn" --quiet > /dev/null
cp "$here/drawn/sharp.png" "$here/photos/p03.png"
study=(single-depth --nets paper-t4 --images "$here/photos" --photos all --psi 2,4,6,8 --noise none --stride 8 --methods malvar,wiener,omp)
"$EDOF" study "${study[@]}" --rows "$here/whole.jsonl" --quiet > /dev/null
submit() { ./scripts/slurm/study.sh 3 "$here/parts" "${study[@]}"; }
done_all() { [ -z "$(squeue -h)" ]; }
submit
for ((i = 0; i < 600; i++)); do
    [ -e "$here/parts/part-1.jsonl" ] && [ "$(wc -l < "$here/parts/part-1.jsonl")" -ge 3 ] && break
    sleep 0.1
done
scancel --signal=KILL --name=edof-single-depth; scancel --name=edof-merge
until done_all; do sleep 0.5; done
[ ! -e "$here/parts/rows.jsonl" ] || fail "the study was over before it was killed"
submit
until done_all; do sleep 0.5; done
[ -s "$here/parts/report.html" ] || { cat "$here"/parts/*.log >&2; fail "no report"; }
timeless() { sed -E 's/"((cpu_)?seconds_per_megapixel|prepare_seconds|repetitions|peak_memory_bytes)":[^,]*,//g' "$1"; }
cmp <(timeless "$here/parts/rows.jsonl") <(timeless "$here/whole.jsonl") || fail "the parts do not make the whole"
echo "slurm.sh: $(wc -l < "$here/whole.jsonl") lines, the same from three killed and resumed parts as from one run"
