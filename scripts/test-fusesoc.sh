#!/usr/bin/env bash
# The FuseSoC core of a generated directory: its targets lint, sim and sim_core by the real FuseSoC, and a wrong word must be found. The
# program is built if it is not given as EDOF.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
need_simulators

need_edof
need_environment fusesoc tests/fusesoc/requirements.txt

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# A drawn network of 12 bits has sums that fit the design.
sed 's/"code_bits": 16/"code_bits": 12/' designs/tiny.json >"$work/tiny.json"
"$EDOF" random-network -q --form one-sided,w8,t4,c16,r --bits 12 --out "$work/drawn.fixed.safetensors"
"$EDOF" generate -q --design "$work/tiny.json" --weights "$work/drawn.fixed.safetensors" --out "$work/edof"
touch "$work/fusesoc.conf"
run() {
    (cd "$work" && "$environment/bin/fusesoc" --config fusesoc.conf --cores-root edof run --target "$1" edof_kc705 2>&1)
}
for target in lint sim sim_core; do
    said=$(run "$target") || { echo "$said"; fail "fusesoc run --target $target failed"; }
    case $target in
        lint) ;;
        *) grep -q '^PASS' <<<"$said" || { echo "$said"; fail "$target said nothing of PASS"; } ;;
    esac
done
sed -i '41s/.*/00000000/' "$work/edof/sim/patches.hex"
if run sim >/dev/null; then fail "sim did not find a wrong word"; fi
say "FuseSoC: lint, sim and sim_core pass"
