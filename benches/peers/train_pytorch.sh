#!/usr/bin/env bash
# Patches a second of training edof-t4w12: edof-train against PyTorch on the same CPU, same data, three rounds in turn.
# Installs PyTorch from PyPI into a throw-away environment (EDOF_PEER_ENV keeps one for the next time).
set -euo pipefail
cd "$(dirname "$0")/../.."
threads=${1:-2}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
env=${EDOF_PEER_ENV:-$work/env}
if [ ! -x "$env/bin/python" ]; then
  python3 -m venv "$env"
fi
"$env/bin/python" -c 'import torch, safetensors' 2>/dev/null || "$env/bin/pip" install --quiet torch numpy safetensors
cargo build --release --quiet -p edof-train --example throughput
program=$(cargo metadata --format-version 1 --no-deps | python3 -c 'import json,sys; print(json.load(sys.stdin)["target_directory"])')/release/examples/throughput
for round in 1 2 3; do
  "$program" "$work/data.safetensors" "$threads" | tee "$work/ours.$round"
  batch=$(python3 -c 'import json,sys; print(json.load(open(sys.argv[1]))["batch"])' "$work/ours.$round")
  "$env/bin/python" benches/peers/train_pytorch.py "$work/data.safetensors" "$threads" "$batch" | tee "$work/peer.$round"
done
python3 - "$work" <<'PY'
import json, statistics, sys
rate = lambda who: statistics.median(json.load(open(f"{sys.argv[1]}/{who}.{i}"))["patches_per_second"] for i in (1, 2, 3))
ours, peer = rate("ours"), rate("peer")
print(f"median of 3: edof-train {ours:.0f}, PyTorch {peer:.0f} patches a second: {ours / peer:.2f} times as many")
PY
