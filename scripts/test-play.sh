#!/usr/bin/env bash
# The page of `edof play` in Debian's Chromium, driven over its DevTools protocol: sliders, figures against the commands, keyboard and screen reader, two widths,
# light and dark, tokens. Screens are kept in a folder if one is given. The program is built if it is not given as EDOF.
#
#   test-play.sh [FOLDER]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_chromium

need_edof
need_environment play tests/play/requirements.txt
[ -z "${1:-}" ] || mkdir -p "$1"
"$environment/bin/python" -B tests/play/check.py "$(realpath "$EDOF")" ${1:+"$1"}
say "play: all passed, $SECONDS seconds"
