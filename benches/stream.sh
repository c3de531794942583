#!/usr/bin/env bash
# Frames a second of `edof stream` for 1920x1080 frames packed as 12p to y4m, through pipes, beside the same network in ONNX Runtime fed by the same pipe:
# stream.sh [THREADS] [FRAMES] [ROUNDS]. Each program has as many cores as threads; whoever feeds it may use all. EDOF names a built program,
# EDOF_PEER_ENV keeps the environment of the peer. The results are kept under benches/runs.
set -euo pipefail
cd "$(dirname "$0")/.."
threads=${1:-1} frames=${2:-100} rounds=${3:-5} network=edof-t4w12-outer-light
if [ -z "${EDOF:-}" ]; then
    cargo build --release --quiet --locked -p edof-cli
    EDOF=${CARGO_TARGET_DIR:-target}/release/edof
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
env=${EDOF_PEER_ENV:-$work/env}
[ -x "$env/bin/python" ] || python3 -m venv "$env"
"$env/bin/python" -c 'import numpy, onnx, onnxruntime, safetensors' 2>/dev/null || "$env/bin/pip" install --quiet numpy onnx onnxruntime safetensors
"$EDOF" capture leaves -q --no-measure --size 1920x1080 --psi 4 --noise sensor:gain=2 --bit-depth 12 --out "$work/frame.raw" >"$work/log"
"$env/bin/python" - "$work/frame.raw" "$work/frame.12p" <<'PY'
import numpy as np, sys
first, second = np.fromfile(sys.argv[1], "<u2").reshape(-1, 2).T
packed = np.stack([first & 255, first >> 8 | (second & 15) << 4, second >> 4], 1)
packed.astype(np.uint8).tofile(sys.argv[2])
PY
# The same frame again and again, from memory: no disk is measured.
feed() { for ((i = 0; i < $1; i++)); do cat "$work/frame.12p"; done; }
ours() {
    taskset -c "0-$((threads - 1))" env RAYON_NUM_THREADS="$threads" "$EDOF" stream - --size 1920x1080 --packing 12p --weights "$network" --quiet \
        --json "$work/ours.json" --out -
}
theirs() {
    taskset -c "0-$((threads - 1))" env OMP_NUM_THREADS="$threads" "$env/bin/python" benches/peers/stream_onnx.py \
        "weights/$network.safetensors" 1920 1080 "$threads" "$work/theirs.json"
}
# Both make the same picture.
feed 1 | ours >"$work/ours.y4m"
feed 1 | theirs >"$work/theirs.y4m"
for ((round = 0; round < rounds; round++)); do
    feed "$frames" | ours >/dev/null
    feed "$((frames / 5 + 1))" | theirs >/dev/null
    "$env/bin/python" -c 'import json, sys; print(json.dumps([json.load(open(path)) for path in sys.argv[1:]]))' \
        "$work/ours.json" "$work/theirs.json" >>"$work/rounds.jsonl"
done
"$env/bin/python" - "$work" "$threads" "benches/runs/stream-$network-$threads.json" <<'PY'
import json, sys
import numpy as np, onnxruntime
work, threads, out = sys.argv[1:]
luma = [np.frombuffer(open(f"{work}/{name}.y4m", "rb").read().split(b"FRAME\n", 1)[1], np.uint8)[: 1920 * 1080].astype(float) for name in ("ours", "theirs")]
difference = float(np.sqrt(np.mean((luma[0] - luma[1]) ** 2)))
if difference > 0.3:
    sys.exit(f"both make different pictures: luma differs by {difference:.2f} of 219 (rms), expected 0.3 at most")
rounds = [json.loads(line) for line in open(f"{work}/rounds.jsonl")]
cpu = next(line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name"))
json.dump({"threads": int(threads), "cpu": cpu, "onnxruntime": onnxruntime.__version__, "rms_difference_of_luma": difference, "rounds": rounds}, open(out, "w"), indent=1)
def spread(values, digits):
    low, middle, high = (f"{value:.{digits}f}" for value in (min(values), float(np.median(values)), max(values)))
    return f"{middle} ({low} to {high})"
ours, theirs = zip(*rounds)
rate = [one["per_second"] for one in ours]
print(f"edof stream, threads {threads}: {spread(rate, 1)} frames/s; latency {spread([one['latency_ms'] for one in ours], 0)} ms, at most {max(one['most_latency_ms'] for one in ours):.0f} ms")
for key, what in (("per_second", "the whole stream"), ("network_per_second", "its network alone")):
    print(f"ONNX Runtime, {what}: {spread([one[key] for one in theirs], 1)} frames/s; edof stream is {spread([a / b[key] for a, b in zip(rate, theirs)], 2)} times as fast")
print(f"luma differs by {difference:.2f} of 219 (rms)")
PY
