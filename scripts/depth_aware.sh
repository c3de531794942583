#!/usr/bin/env bash
# What a router between two or three sets of weights keeps of the gain of a known depth: scripts/depth_aware.sh, in the root, one thread. About 35 trainings of 90 s of CPU time.
# Networks, their errors on the frames, and routers are in target/depth. Needs Python with NumPy and SciPy. Tables: the commands at the end.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export RAYON_NUM_THREADS=1 OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
python=${PYTHON:-python3} d=target/depth frames=target/depth/frames
mkdir -p $d
python3 -B scripts/lens.py clear-0.5 8 > $d/clear-0.5.json
cargo build --release -p edof-train --example depth_aware
program=${CARGO_TARGET_DIR:-target}/release/examples/depth_aware

# λ with which a training ended.
lambdas() { "$python" -c "
import json
for line in open('$d/log.jsonl'):
    row = json.loads(line)
    if row['network'] == '$1': print(','.join(map(str, row['lambdas'])))" | tail -1; }
# go NAME OPTIONS: trains and measures, unless it is there.
go() {
    local name=$1
    shift
    [ -e $d/"$name".safetensors ] || "$program" train $d/"$name".safetensors "$@" >> $d/log.jsonl 2> $d/"$name".log
    [ -e $d/"$name".errors ] || "$program" errors $frames $d/"$name".safetensors
}
nets() { local name=$1 classes=$2 k all=(); for ((k = 0; k < classes; k++)); do all+=("$d/$name-$k.safetensors"); done; (IFS=,; echo "${all[*]}"); }
fit() { [ -e $d/"$1".json ] || "$python" scripts/depth_aware.py fit $frames $d/"$1".json "${@:2}"; }
# em NEXT BEFORE ROUTER CLASSES OPTIONS: trains each network on what the router sends to it.
em() { local k; for ((k = 0; k < $4; k++)); do go "$1-$k" from=$d/"$2-$k".safetensors lambdas="$l" router=$d/"$3".json class="$k" "${@:5}"; done; }

[ -e $frames/index.json ] || "$program" frames $frames
# Blind: the short recipe; three times as long; and on from the short one, in rounds as long as those of the experts. All but the first two have the λ of the long one.
go blind
go blind-24k steps=24000
l=$(lambdas blind-24k)
go blind-on from=$d/blind.safetensors lambdas="$l"
go blind-on2 from=$d/blind-on.safetensors lambdas="$l"
go blind-on3 from=$d/blind-on2.safetensors lambdas="$l"
# Depth known: three single depths, and classes of depths.
for depths in 4:4 8:0,8 6:2,6; do go "known-${depths%:*}" from=$d/blind.safetensors lambdas="$l" depths="${depths#*:}"; done
go k2d-0 from=$d/blind.safetensors lambdas="$l" depths=3,4,5
go k2d-1 from=$d/blind.safetensors lambdas="$l" depths=0,1,2,6,7,8
go k2w-0 from=$d/blind.safetensors lambdas="$l" depths=2,3,4,5,6
go k2w-1 from=$d/blind.safetensors lambdas="$l" depths=0,1,7,8
# Routers between these, without training for them.
for pair in k2d k2w; do fit $pair "$(nets $pair 2)"; fit $pair-3x3 "$(nets $pair 2)" patches=3; done
# Two rounds, all light of the recipe.
fit k2e0 "$(nets k2d 2)" balance=1
em k2e1 k2d k2e0 2
fit k2e1 "$(nets k2e1 2)"
em k2e2 k2e1 k2e1 2
fit k2e2 "$(nets k2e2 2)"
fit k2e2-3x3 "$(nets k2e2 2)" patches=3
# The same at 10,000 electrons alone, so that classes cannot become classes of noise; blind too.
one=(gain=1.41421354:1.45 steps=6000)
go mblind from=$d/blind-on3.safetensors lambdas="$l" "${one[@]}"
go mblindb from=$d/mblind.safetensors lambdas="$l" "${one[@]}"
fit m2e0 "$(nets k2w 2)" electrons=10000 balance=1
em m2e1 k2w m2e0 2 "${one[@]}"
fit m2e1 "$(nets m2e1 2)" electrons=10000
em m2e2 m2e1 m2e1 2 "${one[@]}"
fit m2e2 "$(nets m2e2 2)" electrons=10000
fit m2e2-3x3 "$(nets m2e2 2)" electrons=10000 patches=3
# Three classes: those two, and the blind one. (With a network of ψ 8 alone as the third, the router sends it nothing.)
for file in safetensors errors; do
    cp $d/m2e2-0.$file $d/m3d-0.$file; cp $d/m2e2-1.$file $d/m3d-1.$file; cp $d/mblindb.$file $d/m3d-2.$file
done
fit m3e0 "$(nets m3d 3)" electrons=10000
em m3e1 m3d m3e0 3 "${one[@]}"
fit m3e1 "$(nets m3e1 3)" electrons=10000

table() { "$python" scripts/depth_aware.py table $frames "$@"; }
table $d/blind-24k.safetensors $d/blind{,-on,-on2,-on3}.safetensors "depth:$(nets k2d 2)@4/6,8" "depth:$(nets k2w 2)@4,6/8" "best:$(nets k2d 2)" "best:$(nets k2w 2)" \
    $d/k2d.json:"$(nets k2d 2)" $d/k2w.json:"$(nets k2w 2)" $d/k2e1.json:"$(nets k2e1 2)" $d/k2e2.json:"$(nets k2e2 2)" "best:$(nets k2e2 2)" $d/k2e2-0.safetensors
table $d/mblindb.safetensors $d/mblind.safetensors $d/m2e1.json:"$(nets m2e1 2)" $d/m2e2.json:"$(nets m2e2 2)" $d/m2e2-3x3.json:"$(nets m2e2 2)" "best:$(nets m2e2 2)" \
    $d/m3e1.json:"$(nets m3e1 3)" "best:$(nets m3e1 3)"
