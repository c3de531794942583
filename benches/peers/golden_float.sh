#!/usr/bin/env bash
# 1080p frames a second of the golden pipeline against the same float network in ONNX Runtime, PyTorch and NumPy: golden_float.sh [THREADS] [ROUNDS].
# Installs its peers from PyPI into a throw-away environment (EDOF_PEER_ENV keeps one); EDOF names a built program. Keeps the raw results
# under benches/runs.
set -euo pipefail
cd "$(dirname "$0")/../.."
threads=${1:-2} rounds=${2:-5} network=${EDOF_PEER_NETWORK:-edof-t4w12}
photo=${EDOF_KODAK:-../shared/data/kodak}/kodim01.png
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
env=${EDOF_PEER_ENV:-$work/env}
if [ ! -x "$env/bin/python" ]; then
  python3 -m venv "$env"
fi
"$env/bin/python" -c 'import numpy, onnx, onnxruntime, PIL, safetensors, torch' 2>/dev/null ||
  "$env/bin/pip" install --quiet numpy onnx onnxruntime pillow safetensors torch
cargo build --release --quiet --locked -p edof-golden --example throughput
target=$(cargo metadata --format-version 1 --no-deps | python3 -c 'import json,sys; print(json.load(sys.stdin)["target_directory"])')
if [ -z "${EDOF:-}" ]; then
  cargo build --release --quiet --locked -p edof-cli
  EDOF=$target/release/edof
fi
"$env/bin/python" - "$photo" "$work/sharp.png" <<'PY'
import sys
from PIL import Image
photo = Image.open(sys.argv[1]).convert("RGB")
photo.resize((1920, 1280), Image.Resampling.LANCZOS).crop((0, 100, 1920, 1180)).save(sys.argv[2])
PY
"$EDOF" capture "$work/sharp.png" --out "$work/raw.png" --camera ring-2018 --psi 4 --no-measure >"$work/log"
"$env/bin/python" benches/peers/golden_float.py "$target/release/examples/throughput" "weights/$network" "$work/raw.png" \
  "$work/sharp.png" "$threads" "$rounds" "benches/runs/golden-$network-$threads.json"
