#!/usr/bin/env bash
# Tests on photographs, which are not in the repository: the folder is $EDOF_KODAK, else ../shared/data/kodak. Where there is none, this says so.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
folder=${EDOF_KODAK:-../shared/data/kodak}
if ! [ -e "$folder/kodim24.png" ]; then
    say "NOT RUN: no photographs in $folder; set EDOF_KODAK to a folder with kodim01.png ... kodim24.png"
    exit
fi
cargo test --workspace --locked --test program -- --ignored the_crop_of_a_photograph on_a_busy_photograph saturations::
cargo test --workspace --locked --test all_photos -- --ignored networks_in_turn
