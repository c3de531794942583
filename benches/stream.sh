#!/usr/bin/env bash
# Frames a second of `edof stream` for 1920x1080 frames packed as 12p to y4m, through pipes: stream.sh [THREADS] [FRAMES]. EDOF names a built program.
set -euo pipefail
cd "$(dirname "$0")/.."
threads=${1:-1} frames=${2:-100}
if [ -z "${EDOF:-}" ]; then
    cargo build --release --quiet --locked -p edof-cli
    EDOF=${CARGO_TARGET_DIR:-target}/release/edof
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$EDOF" capture leaves -q --no-measure --size 1920x1080 --psi 4 --noise sensor:gain=2 --bit-depth 12 --out "$work/frame.raw" >"$work/log"
python3 - "$work/frame.raw" "$work/frame.12p" <<'PY'
import array, sys
values = array.array("H", open(sys.argv[1], "rb").read())
packed = bytearray()
for first, second in zip(values[::2], values[1::2]):
    packed += (first | second << 12).to_bytes(3, "little")
open(sys.argv[2], "wb").write(packed)
PY
# The same frame again and again, from memory: no disk is measured.
feed() { for ((i = 0; i < frames; i++)); do cat "$work/frame.12p"; done; }
feed | taskset -c "$(seq -s, 0 $((threads - 1)))" env RAYON_NUM_THREADS="$threads" "$EDOF" stream - --size 1920x1080 --packing 12p --quiet \
    --json "$work/pace.json" --out - >/dev/null
python3 - "$work/pace.json" "$threads" <<'PY'
import json, sys
pace = json.load(open(sys.argv[1]))
rate, median, most = pace["per_second"], pace["latency_ms"], pace["most_latency_ms"]
print(f"threads {sys.argv[2]}: {pace['frames']} frames, {rate:.1f} frames/s, latency {median:.0f} ms, at most {most:.0f} ms")
PY
