#!/usr/bin/env bash
# The page of `edof play` in Debian's Chromium, driven over its DevTools protocol: sliders, figures against the commands, keyboard and screen reader, two widths,
# light and dark, tokens. Screens are kept in a folder if one is given. The program is built if it is not given as EDOF.
#
#   test-play.sh [FOLDER]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_chromium
need_python

if [ -z "${EDOF:-}" ]; then
    cargo build -q -p edof-cli --locked
    EDOF=${CARGO_TARGET_DIR:-target}/debug/edof
fi
environment=$(realpath -m "${CARGO_TARGET_DIR:-target}/play")
if ! cmp -s tests/play/requirements.txt "$environment/requirements.txt"; then
    say "installing the driver under $environment"
    python3 -m venv --clear "$environment"
    "$environment/bin/pip" install -q --disable-pip-version-check -r tests/play/requirements.txt
    cp tests/play/requirements.txt "$environment/requirements.txt"
fi
[ -z "${1:-}" ] || mkdir -p "$1"
"$environment/bin/python" -B tests/play/check.py "$(realpath "$EDOF")" ${1:+"$1"}
say "play: all passed, $SECONDS seconds"
