#!/usr/bin/env bash
# A recorded round trip of `edof stream` with Debian's ffmpeg: raw frames are recorded losslessly, played into `edof stream`, and its pictures recorded and
# played back as y4m and as rawvideo. Every byte must be that of the stream of the frames themselves. The program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_ffmpeg

need_edof
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

size=96x64
play() { ffmpeg -nostdin -v error "$@"; }
for seed in 1 2 3 4; do
    "$EDOF" capture leaves -q --no-measure --size "$size" --seed "$seed" --noise sensor:gain=2 --bit-depth 12 --out "$seed.raw" >log
done
cat [1-4].raw >frames.raw
stream=(stream - --size "$size" --bit-depth 12 --fps 25 --quiet --out -)
"$EDOF" stream frames.raw --size "$size" --bit-depth 12 --quiet --format yuv422p --out expected.planes
[ "$(stat -c %s expected.planes)" -eq $((4 * 2 * 96 * 64)) ] || fail "expected.planes: not four pictures"

say "frames: recorded as grey video, played into edof stream"
play -f rawvideo -pix_fmt gray16le -s "$size" -r 25 -i frames.raw -c:v ffv1 frames.mkv
play -i frames.mkv -f rawvideo -pix_fmt gray16le played.raw
cmp frames.raw played.raw
say "pictures: y4m into a recording and back"
play -i frames.mkv -f rawvideo -pix_fmt gray16le - | "$EDOF" "${stream[@]}" | ffmpeg -v error -i - -c:v ffv1 pictures.mkv
play -i pictures.mkv -f rawvideo -pix_fmt yuv422p pictures.planes
cmp expected.planes pictures.planes
found=$(ffprobe -v error -select_streams v -show_entries stream=width,height,pix_fmt,r_frame_rate,color_range -of csv=p=0 pictures.mkv)
[ "$found" = 96,64,yuv422p,tv,25/1 ] || fail "pictures.mkv: $found, expected 96,64,yuv422p,tv,25/1"
say "pictures: rawvideo"
"$EDOF" stream frames.raw --size "$size" --bit-depth 12 --quiet --format yuyv422 --out - |
    ffmpeg -v error -f rawvideo -pix_fmt yuyv422 -s "$size" -r 25 -i - -f rawvideo -pix_fmt yuv422p packed.planes
cmp expected.planes packed.planes
say "a recording that ends inside of a frame is rejected"
if head -c 30000 frames.raw | "$EDOF" stream - --size "$size" --bit-depth 12 --quiet --out - 2>told | ffmpeg -v error -i - -f null -; then
    fail "a cut recording was accepted"
fi
grep -q 'standard input: frame 3: ends after 5424 of 12288 bytes' told || fail "$(cat told)"
say "stream: round trips are exact"
