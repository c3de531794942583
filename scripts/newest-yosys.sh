#!/usr/bin/env bash
# Installs the Yosys of tests/yosys/requirements.txt under target/, where it is missing, and prints the path of the program.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_newest_yosys
printf '%s\n' "$newest_yosys"
