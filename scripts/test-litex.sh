#!/usr/bin/env bash
# LiteX's clients against both kinds of a simulated board: the lines of docs/host.md, then registers, weights and their CRC, and the map by
# name. LiteX comes from PyPI. The program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators
need_litex

need_edof
work=$(mktemp -d)
board=
trap 'kill $board 2>/dev/null || true; rm -rf "$work"' EXIT
"$EDOF" board map --format csr-csv >"$work/csr.csv"

# try KIND BAUD OPTION...: a board of that kind, and the clients at its line.
try() {
    local kind=$1 baud=$2 python=$litex/bin/python
    shift 2
    "$EDOF" board sim -q --design tiny --baud "$baud" --link "$work/$kind" "$@" >"$work/said.txt" 2>&1 &
    board=$!
    # The circuit is compiled first, which takes minutes.
    for _ in $(seq 6000); do
        [ -e "$work/$kind" ] && break
        kill -0 $board 2>/dev/null || fail "the simulated board ended: $(tail -1 "$work/said.txt")"
        sleep 0.1
    done
    local port
    port=$(realpath "$work/$kind")
    awk '/^```python$/ { on = 1; next } /^```$/ { on = 0 } on' docs/host.md >"$work/page.py"
    sed -i "s|/dev/ttyUSB0|$port|; s|921600|$baud|" "$work/page.py"
    [ "$("$python" "$work/page.py")" = 0x45444f46 ] || fail "$kind: the lines of docs/host.md do not read id"
    "$python" tests/litex/client.py "$port" "$work/csr.csv" "$baud" 32
    kill $board
    wait $board 2>/dev/null || true
    say "LiteX's clients work with the board in $kind"
}
try rust 921600
try verilog 12500000 --rtl --size 64x64
