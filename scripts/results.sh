#!/usr/bin/env bash
# Remakes every table and figure of docs/results, docs/figures and README.md: scripts/results.sh [PART]...; without arguments all parts.
#   linear srgb   docs/results/kodak-TONE.*, some rows of each into README.md or docs/results.md (5 and 20 minutes on two cores)
#   closed        docs/results/closed.*: the clear lens closed by half a stop, in the light of srgb  (3 minutes)
#   held-back     docs/results/held-back.*: coded and clear lens on the eight photographs that scripts/held-back.sh names (3 minutes)
#   held-back-colourful   the same on the four of them whose colours differ most (2 minutes)
#   speed         docs/results/single-depth.*, docs/figures/speed.svg                   (25 minutes)
#   overlap       docs/results/overlap.*: all methods of patches at stride 4            (10 minutes)
#   depths        docs/results/multi-depth.*                                            (5 minutes)
#   blind         docs/results/blind.* (test photographs) and blind-train.* (others)    (15 minutes)
#                 fails where blind deconvolution loses more than 1 dB of any photograph
#   knobs design  docs/results/knobs.*, design.md, on three training photographs        (10 minutes, 1 minute)
#   bits stability docs/results/bits.md, stability.md                                   (10 minutes)
#   aperture      docs/results/aperture.*: the coded lens against smaller apertures     (1 minute)
#   aperture-networks  docs/results/aperture-networks.*: the same by networks; 24 short trainings, 2 minutes each, which target/trained keeps
#   depth-known   docs/results/depth-known.*: what knowing the depth is worth; 13 short trainings besides, which target/trained keeps
#   depth-known-16   docs/results/depth-known-16.*: the same from ψ 0 to 16; 13 short trainings
#   two-exposures docs/results/two-exposures.*: what two exposures of half the time are worth; 6 short trainings, which target/trained keeps
#   masks         docs/results/masks.*: cubic masks against the clear lens at its best stop; 9 short trainings, which target/trained keeps
#   colour        docs/results/colour.md: gain of the coded lens against the correlation of colours, of rows that are there  (1 minute)
#   colour-scenes      the same with synthetic scenes of known saturation               (3 minutes)
#   colour-training    the same with training photographs, and copies of random saturation in training  (20 minutes)
#   tolerances    docs/results/tolerances.*: errors of the coded lens that cost 0.1 dB, its networks by noise  (10 minutes)
#   codes         docs/results/codes.md: codes that programs read behind the coded lens and clear ones; one training  (25 minutes)
#   forms layers  docs/results/forms.md, layers.md: short trainings of other forms, and of T = 3 to 10  (30 minutes)
#   ablations     docs/results/ablations.md: short trainings by the recipe with one change each  (25 minutes)
#   classes       docs/results/classes.md: short trainings for classes of noise, of all weights and of the thresholds alone  (10 minutes)
#   joint         docs/results/joint.md: lenses searched together with a network, and short trainings for each  (25 minutes)
#   one-noise     docs/results/one-noise.*: networks for one noise alone, of the default's form and of one with twice its cost  (25 minutes)
#   bound         docs/results/bound.md, docs/figures/bound: what no lens passes, and how near lenses come  (1 minute)
#   figures       docs/figures: the paper's figure 1, pictures of the demo               (2 minutes)
# Full rows are files of JSON lines in out/rows: a page states the SHA-256 of its file, and docs/results keeps a compact table (scripts/table.py).
# A release carries out/rows. From a clean tree: every page states its revision. A run that was stopped goes on: rows and pages of this revision stay, those of another
# one are made anew (git has the old ones). A test says which pages are of weights that no longer ship. Reports are in out/. Photographs: $EDOF_KODAK, else ../shared/data/kodak; $EDOF_MORE, else
# ../shared/data/more. Nothing is trained on the photographs that scripts/held-back.sh names.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh
source scripts/held-back.sh

parts="linear srgb closed held-back held-back-colourful speed overlap depths blind knobs design bits stability aperture aperture-networks depth-known depth-known-16 two-exposures masks colour-scenes colour-training colour tolerances codes forms ablations classes joint one-noise bound layers figures"
# shellcheck disable=SC2086 # parts are several words
[ $# -gt 0 ] || set -- $parts
for part in "$@"; do
    [[ " $parts " == *" $part "* ]] || fail "'$part': must be one of $parts"
done
# What the script itself writes may differ.
changed=$(git status --porcelain -- . ':!docs/results' ':!docs/results.md' ':!docs/figures' ':!README.md')
[ -z "$changed" ] || fail "the tree has changes, so that no page could say what made it; commit them first: $changed"
revision=$(git rev-parse HEAD)

say "building"
cargo build --release --locked --package edof-cli
target=${CARGO_TARGET_DIR:-target}
edof=$target/release/edof
photographs=${EDOF_KODAK:-../shared/data/kodak}
made=$target/results/$revision
more=${EDOF_MORE:-../shared/data/more}
# Networks of aperture and colour stay from one revision to the next; rows hold the hashes of their weights.
trained=$target/trained
mkdir -p out/rows "$made" "$trained"

# Whether a file of rows or a page is of this revision.
is_made() { grep -qs -e "\"revision\":\"$revision\"" -e "revision \`$revision\`" "$1"; }
# The file of rows of a study, without rows of another revision.
rows() {
    local file=out/rows/$1.jsonl
    is_made "$file" || rm -f "$file"
    echo "--rows $file"
}
# Outputs of a study, by its name.
pages() { echo "--markdown docs/results/$1.md --report out/$1.html"; }
# The compact table of a file of rows, from which a test makes the page again.
table() { python3 scripts/table.py "out/rows/$1.jsonl" > "docs/results/$1.csv"; }

# Those trained for the paper's convention; of real light also those trained for it.
declare -A nets
nets[linear]="paper-t4,edof-t4w12,edof-t4w12-outer,edof-t4w12-clear"
nets[srgb]=${nets[linear]},edof-t4w12-light,edof-t4w12-outer-light,edof-t4w12-clear-light
# The coded and the clear lens with three networks each, of which every frame meets the one for its noise.
by_noise() { echo "edof-t4w12-$1-low+edof-t4w12-$1-mid+edof-t4w12-$1-high"; }
classes=$(by_noise outer),$(by_noise clear)
nets[linear]+=,$classes
# Of light by the sensor's gain: low below 4, dark from 24.
by_gain() { echo "edof-t4w12-$1-light-low+edof-t4w12-$1-light-high+edof-t4w12-$1-light-dark"; }
nets[srgb]+=,$(by_gain outer),$(by_gain clear)

# Quotes a page's first table between a document's marks, without SSIM and standard errors: demosaicing and the networks in fixed point, for each of the two lenses; those
# by noise alone, where the page has them.
quote() {
    local kinds='(-light)?'
    ! grep -q -e '-by-noise\.fixed' "$2" || kinds='(-light)?-by-noise'
    awk -v page="$2" -v start="<!-- rows: $2 -->" -v kept_methods="^ (demosaic-malvar|edof-t4w12-(outer|clear)$kinds[.]fixed) \$" '
        $0 == start {
            print
            while ((getline line < page) > 0) {
                if (line !~ /^\|/) { if (count) break; else continue }
                split(line, cell, "|")
                kept = cell[2] ~ kept_methods && cell[3] ~ /^ (ring-outer|clear-mid) $/
                gsub(/ ± [0-9.]+/, "", line)
                gsub(" / ", "/", line)
                split(line, cell, "|")
                if (++count <= 2 || kept) print "|" cell[2] "|" cell[3] "|" cell[4] "|" cell[6] "|" cell[8] "|"
            }
            skip = 1
            next
        }
        skip && /^<!-- end -->$/ { skip = 0 }
        !skip { print }' "$1" > "$1.new"
    mv "$1.new" "$1"
}

# Quotes the verdict of a page between a document's marks, without what its rows do not state: quote_verdict DOCUMENT NAME.
quote_verdict() {
    local verdict page=docs/results/$2.md
    verdict=$(sed -n 's/^\*\*Verdict\.\*\* \(.*\) The rows do not state.*/\1/p' "$page")
    [ -n "$verdict" ] || fail "$page: no verdict"
    awk -v verdict="$verdict ([$2.md](${page#"$(dirname "$1")/"}))" -v start="<!-- verdict: $2 -->" '
        $0 == start { print; print verdict; skip = 1; next }
        skip && /^<!-- end -->$/ { skip = 0 }
        !skip { print }' "$1" > "$1.new"
    mv "$1.new" "$1"
}

# shellcheck disable=SC2046 # outputs are several words
photographs_of() {
    local page=docs/results/kodak-$1.md
    "$edof" study kodak --tone "$1" --nets "${nets[$1]}" --psi 0,2,4,6,8 --stride 8 $(rows "kodak-$1") $(pages "kodak-$1")
    table "kodak-$1"
    quote docs/results.md "$page"
    if [ "$1" = srgb ]; then quote README.md "$page"; else quote_verdict docs/results.md kodak-linear; fi
}

# The clear lens closed by half a stop sees what the lenses of `srgb` see for the same time: depths and gains are those behind its aperture.
# shellcheck disable=SC2046
closed() {
    "$edof" study kodak --tone srgb --nets edof-t4w12-closed-light-low+edof-t4w12-closed-light-high --psi 0,1.4142,2.8284,4.2426,5.6569 --noise none,sensor:gain=1.4142,sensor:gain=11.314 \
        --stride 8 $(rows closed) $(pages closed)
    table closed
}

# Photographs that no class of noise was trained on: unseen PAGE NAME,NAME...
# shellcheck disable=SC2046
unseen() {
    "$edof" study kodak --images "$more" --photos "${2//more/}" --tone linear --nets "$classes" --psi 0,2,4,6,8 \
        --stride 8 $(rows "$1") $(pages "$1")
    table "$1"
    quote_verdict docs/results.md "$1"
}

# Everything where each patch is seen once; at the paper's stride and half-way what its claims need: OMP takes 16 times as long there.
# shellcheck disable=SC2046
speed() {
    "$edof" study single-depth $(rows single-depth) --noise none,0.01 --stride 8 > /dev/null
    "$edof" study single-depth $(rows single-depth) --noise none --stride 4,2 --methods omp,omp-known $(pages single-depth) \
        --plot docs/figures/speed.svg
    table single-depth
}

# shellcheck disable=SC2046
overlap() {
    "$edof" study single-depth $(rows overlap) --noise none --stride 4 \
        --methods omp,omp-known,fista,fista-known,untrained,untrained-dc-removed $(pages overlap)
    table overlap
}

# Its rows hold the pictures.
# shellcheck disable=SC2046
depths() {
    "$edof" study multi-depth --rows "$made/multi-depth.jsonl" $(pages multi-depth) --csv docs/results/multi-depth.csv
}

# shellcheck disable=SC2046
blind() {
    local set page
    for set in test train; do
        page=blind${set/test/}
        page=${page/train/-train}
        "$edof" study blind --photos "$set" --side 15 $(rows "$page") $(pages "$page")
        table "$page"
        grep -q "Lost more than 1 dB: none" "docs/results/$page.md" || fail "docs/results/$page.md: blind deconvolution diverges on a photograph"
    done
}

# shellcheck disable=SC2046
knobs() {
    "$edof" study knobs --photos 1,13,20 $(rows knobs) $(pages knobs)
    table knobs
}

# shellcheck disable=SC2046
design() {
    local shots=() number
    for number in 01 13 20; do shots+=(--photo "$photographs/kodim$number.png"); done
    is_made docs/results/design.md ||
        "$edof" study design --weights paper-t4,edof-t4w12,edof-t4w12-outer "${shots[@]}" --psi 0,4,8 $(pages design) --force
}

# shellcheck disable=SC2046
bits() { is_made docs/results/bits.md || "$edof" study bits $(pages bits) --force; }
# shellcheck disable=SC2046
stability() { is_made docs/results/stability.md || "$edof" study stability $(pages stability) --force; }

# A network of the default form by the short recipe (8,000 steps, seed 1 or that of "seed"), unless it is there. Besides the photographs that are held back it may
# leave out others, as in ",more05": short_network FILE OTHERS OPTIONS...
short_network() {
    local file=$1 part=${1%.safetensors}.part.safetensors others=$2
    shift 2
    [ ! -e "$file" ] || return 0
    say "$file"
    # shellcheck disable=SC2046
    "$edof" train --form "${form:-edof-t4w12}" --steps 8000 --seed "${seed:-1}" --leave-out "$held_back""$others" "$@" --name "$(basename "$file" .safetensors)" \
        --out "$part" $(resume "$part") --force
    mv "$part" "$file"
}

# shellcheck disable=SC2046
aperture() {
    "$edof" study aperture $(rows aperture) $(pages aperture)
    table aperture
}

# Networks for two classes of light behind each lens: gain 1 to 10 and 10.5 to 105 behind the open aperture, more behind a smaller one. So each gain
# that is compared (1, 3.3, 10, 33, 100) is of one class, at every aperture the same. No window is without noise. Those with most to say come first. A
# stopped run goes on; EDOF_APERTURES states fewer networks.
apertures=""
for range in 8 4 12; do
    for least in 1 10; do
        for lens in coded clear-0 clear-0.5 clear-1; do apertures+=" $lens-$range-from-$least"; done
    done
done
# shellcheck disable=SC2046
aperture_networks() {
    local folder=$trained/aperture name lens gain
    mkdir -p "$folder"
    "$edof" study aperture --stops 0,0.5,1 --electrons 10000 --cameras "$folder/cameras" --force > /dev/null
    for name in ${EDOF_APERTURES:-$apertures}; do
        lens=${name%-from-*}
        gain=$(awk -v lens="$lens" -v least="${name##*-from-}" 'BEGIN {
            parts = split(lens, part, "-")
            gain = least * (parts == 3 ? 2 ^ part[2] : 1)
            printf "%.9g:%.9g", (least > 1 ? 1.05 : 1) * gain, (least > 1 ? 10.5 : 10) * gain
        }')
        short_network "$folder/$name.safetensors" "" --camera "$folder/cameras/$lens.json" --tone srgb --gain "$gain" --noiseless 1000000 --no-cache
    done
    "$edof" study aperture-networks --networks "$folder" $(rows aperture-networks) $(pages aperture-networks)
    table aperture-networks
}

# Lenses are chosen by these photographs, so none of their networks is trained on them.
validation=2,5,8,11,14,17,20,23

# A page of lenses with networks of their own: lens_networks PAGE PSI,... ELECTRONS LINE..., each line LENS SEED [PSI | FOCUS,FOCUS] one short training, for all
# depths from ψ 0 to "range" (8), for one, or for all with an exposure at each focus. A lens is one of scripts/lens.py. Pages share their networks.
lens_networks() {
    local page=$1 psis=$2 electrons=$3 range=${range:-8} folder line lens seed psi foci stops name form gain depths own
    folder=$trained/lenses
    [ "$range" = 8 ] || folder+=-$range
    own=$folder/$page
    shift 3
    rm -rf "$own"
    mkdir -p "$own"
    for line in "$@"; do
        read -r lens seed psi <<<"$line"
        foci=
        [[ $psi != *,* ]] || { foci=$psi; psi=; }
        name=$lens${psi:+-psi-$psi}${foci:+-foci-${foci//,/-}}-seed-$seed
        form=edof-t4w12${foci:+,e2}
        python3 -B scripts/lens.py "$lens" "$range" > "$folder/$lens.json"
        stops=${lens##*-}
        [[ $stops == [0-9]* ]] || stops=0
        gain=$(awk -v stops="$stops" -v exposures="${foci:+2}" 'BEGIN { least = 2 ^ stops * (exposures ? exposures : 1); printf "%.9g:%.9g", least, 10 * least }')
        depths=$(awk -v stops="$stops" -v psi="${psi:-0}" 'BEGIN { printf "--psi %.9g:%.9g --depths 1", psi / 2 ^ stops, psi / 2 ^ stops }')
        # shellcheck disable=SC2086 # depths are several words
        seed=$seed form=$form short_network "$folder/$name.safetensors" "$(printf ',kodim%02d' ${validation//,/ })" --camera "$folder/$lens.json" --tone srgb \
            --gain "$gain" --noiseless 1000000 --no-cache ${psi:+$depths} ${foci:+--focus $foci}
        ln "$folder/$name.safetensors" "$own"
    done
    # shellcheck disable=SC2046
    "$edof" study lens-networks --networks "$own" --psi "$psis" --electrons "$electrons" --photos "$validation" $(rows "$page") $(pages "$page")
    table "$page"
}

# Behind a clear lens and an odd mask, focused at the middle, ψ 0 and 8 have the same kernels.
depth_known() {
    lens_networks depth-known 0,4,8 10000,1000 \
        "clear-0.5 1" "clear-0.5 1 4" "clear-0.5 1 8" \
        "clear-0.5 2" "clear-0.5 2 4" "clear-0.5 2 8" \
        "clear-0.5 3" "clear-0.5 3 4" "clear-0.5 3 8" \
        "cubic-2.3-0 1" "cubic-2.3-0 1 4" "cubic-2.3-0 1 8" \
        "ring-outer 1" "ring-outer 1 0" "ring-outer 1 4" "ring-outer 1 8"
}

# Stops and strength are those that edof optics advise names for this range.
depth_known_16() {
    range=16 lens_networks depth-known-16 0,8,16 10000,1000 \
        "clear-1 1" "clear-1 1 0" "clear-1 1 8" "clear-1.5 1" "clear-1.5 1 0" "clear-1.5 1 8" \
        "cubic-0.95-1 1" "cubic-0.95-1 1 0" "cubic-0.95-1 1 8" "ring-outer 1" "ring-outer 1 0" "ring-outer 1 8" "ring-outer 1 16"
}

# Two exposures of half the time behind the open lens, with foci at a quarter and three quarters of the range, against the clear lens closed by half a stop.
two_exposures() {
    local seed lines=()
    for seed in 1 2 3; do lines+=("clear-0.5 $seed" "clear-0 $seed 2,6"); done
    lens_networks two-exposures 0,2,4,6,8 10000,2500,1000 "${lines[@]}"
}

# Strength and stop were chosen by edof optics bound.
masks() {
    local lens seed lines=()
    for lens in clear-0 clear-0.5 cubic-2.3-0; do
        for seed in 1 2 3; do lines+=("$lens $seed"); done
    done
    lens_networks masks 0,2,4,6,8 10000,2500,1000 "${lines[@]}"
}

# Gains by the correlation of colours, of what has rows; photographs that the networks were not trained on have theirs in docs/results.
colour() { python3 -B scripts/colour.py page "$made/colour" "$revision" "$photographs" "$more" "${folds[@]}" > docs/results/colour.md; }

plain_study=(study kodak --tone linear --psi 0,2,4,6,8 --stride 8)
colour_scenes() {
    python3 -B scripts/colour.py scenes "$made/colour/scenes"
    "$edof" "${plain_study[@]}" --nets "$classes" --images "$made/colour/scenes" --photos all --rows "$made/colour/scenes.jsonl" > /dev/null
    colour
}

# The same of training photographs; then networks with and without copies of random saturation, tested on whole training photographs that are
# left out in turn, some colourful ones each.
folds=(more05,more08,more20,more03 more06,more11,more14,more13)
colour_training() {
    local folder=$made/colour fold nets seen=1,3,5,6,7,8,11,12,13,14,17,18,20,22
    mkdir -p "$folder"
    "$edof" "${plain_study[@]}" --nets "$classes" --images "$photographs" --photos train --rows "$folder/train-kodak.jsonl" > /dev/null
    "$edof" "${plain_study[@]}" --nets "$classes" --images "$more" --photos "$seen" --rows "$folder/train-more.jsonl" > /dev/null
    for fold in "${folds[@]}"; do
        nets=$trained/colour/${fold//,/+}
        mkdir -p "$nets"
        short_network "$nets/plain.safetensors" ",$fold" --camera ring-outer --tone linear
        short_network "$nets/copies.safetensors" ",$fold" --camera ring-outer --tone linear --variants 2
        "$edof" "${plain_study[@]}" --nets "$nets/plain.safetensors,$nets/copies.safetensors" --images "$more" --photos "${fold//more/}" \
            --rows "$folder/fold-$fold.jsonl" > /dev/null
    done
    colour
}

# shellcheck disable=SC2046
tolerances() {
    "$edof" study tolerances --net "$(by_noise outer)" --psi 0,2,4,6,8 --noise none,0.01 $(rows tolerances) $(pages tolerances)
    table tolerances
}

# The clear lens open, closed by half a stop, and at the stop that is advised for codes, with a network by the recipe of edof-t4w12-closed-light
# (scripts/weights.sh).
# shellcheck disable=SC2046
codes() {
    local folder=$trained/codes
    local first=$folder/first.safetensors network=$folder/clear-for-codes.safetensors camera=$folder/clear-for-codes.json flat="--tone srgb --flat 64"
    mkdir -p "$folder"
    "$edof" optics advise --task codes --electrons 10000 --out "$camera" > /dev/null
    if [ ! -e "$network" ]; then
        # shellcheck disable=SC2086 # options are several words
        [ -e "$first" ] || "$edof" train --form edof-t4w12 --seed 1 --camera "$camera" $flat --leave-out "$held_back" --out "$first" $(resume "$first") --force
        # shellcheck disable=SC2086
        "$edof" train --from "$first" --camera "$camera" $flat --leave-out "$held_back" --weighting mse --steps 6000 --rate 5e-4 \
            --non-zeros 60,60,40 --lambda 2e-4,4e-4,1e-1 --out "$network.part" --name clear-for-codes --force
        mv "$network.part" "$network"
    fi
    "$edof" study codes --nets "edof-t4w12-clear-light,edof-t4w12-closed-light,$network,edof-t4w12-outer-light" --module-px 1.5,2,3 --psi 0,2,4,6,8 \
        --zbarimg $(rows codes) $(pages codes)
}

# One short training for each line of NAME OPTIONS (8,000 steps, seed 1, the default's camera; else the recipe of scripts/weights.sh), and a
# page with a row for each: short_trainings PAGE LINE...
short_trainings() {
    local page=$1 line name options folder=$made/$1
    shift
    mkdir -p "$folder"
    for line in "$@"; do
        read -r name options <<<"$line"
        [ -e "$folder/$name.json" ] && continue
        say "$name"
        [[ " $options " == *" --seed "* ]] || options+=" --seed 1"
        [[ " $options " == *" --steps "* ]] || options+=" --steps 8000"
        # shellcheck disable=SC2046,SC2086 # options are several words
        "$edof" train --camera ring-outer --tone linear $options --leave-out "$held_back" --out "$folder/$name.safetensors" \
            --json "$folder/$name.json" $(resume "$folder/$name.safetensors") --force
    done
    python3 scripts/short_trainings.py "$page" "$folder" "$@" > "docs/results/$page.md"
}

forms() {
    short_trainings forms \
        "t4w12 --form one-sided,w12,t4,c192,r" \
        "t3w12 --form one-sided,w12,t3,c192,r" \
        "t5w12 --form one-sided,w12,t5,c192,r" \
        "t4w8 --form one-sided,w8,t4,c192,r" \
        "t4w16 --form one-sided,w16,t4,c192,r" \
        "t4w12c256 --form one-sided,w12,t4,c256,r --non-zeros 62,62,54" \
        "t4w12c128 --form one-sided,w12,t4,c128,r --non-zeros 62,62,54" \
        "t4w12half --form one-sided,w12,t4,c192,r --non-zeros 40,40,36" \
        "t4w12free --form one-sided,w12,t4,c192,r --non-zeros none --lambda 3e-5" \
        "t4w12sym --form one-sided,w12,t4,c192,r --structure symmetric" \
        "t4w16sym --form one-sided,w16,t4,c192,r --structure symmetric" \
        "t4w12on --from $made/forms/t4w12.safetensors" \
        "t4w12blocks --from $made/forms/t4w12.safetensors --structure blocks:0.5" \
        "t4w16sym-on --from $made/forms/t4w16sym.safetensors --structure symmetric"
}

# The recipe with one change each, and its spread over seeds.
ablations() {
    local form="--form edof-t4w12"
    short_trainings ablations \
        "recipe $form" \
        "seed-2 $form --seed 2" \
        "seed-3 $form --seed 3" \
        "noise-15 $form --noise 0.015" \
        "class-low $form --noise 0:0.006" \
        "class-high $form --noise 0.006:0.03" \
        "no-budget $form --non-zeros none --lambda 3e-5" \
        "averaged $form --averaging 0.999" \
        "mse $form --weighting mse" \
        "psnr $form --weighting psnr" \
        "batch-1024 $form --batch 1024" \
        "rate-3 $form --rate 3e-3" \
        "rate-5 $form --rate 5e-3" \
        "output-rate $form --output-rate 0.5" \
        "threshold-rate $form --threshold-rate 0.5" \
        "steps-40000 $form --steps 40000"
}

# Three classes of noise: networks of their own, and copies of one network for all noise whose thresholds alone differ (600 numbers).
classes() {
    local form="--form edof-t4w12" all="--from $made/classes/all.safetensors --only thresholds"
    local low="--noise 0:0.006 --noiseless 2" mid="--noise 0.006:0.014" high="--noise 0.014:0.03"
    short_trainings classes \
        "all $form" \
        "all-on --from $made/classes/all.safetensors" \
        "low $form $low" \
        "low-thresholds $all $low" \
        "mid $form $mid" \
        "mid-thresholds $all $mid" \
        "high $form $high" \
        "high-thresholds $all $high"
}

# Lenses found together with a network, from several starts; then networks from scratch for each and for the lenses of the comparisons. The
# searches use eight training photographs, the trainings all but the test photographs and those held back.
joint() {
    local line name options file seed folder=$made/joint
    local lenses=(ring-outer=cameras/ring-outer.json clear-mid=cameras/clear-mid.json)
    mkdir -p "$folder"
    for line in \
        "outer --camera ring-outer" \
        "2018 --camera ring-2018" \
        "clear-focus --camera clear-mid" \
        "random-1 --camera ring-outer --random --rings 1 --seed 1" \
        "random-2 --camera ring-outer --random --rings 2 --seed 2" \
        "random-3 --camera ring-outer --random --rings 3 --seed 3"; do
        read -r name options <<<"$line"
        lenses+=("$name=$folder/$name.json")
        [ -e "$folder/$name.search.json" ] && continue
        say "$name"
        # shellcheck disable=SC2046,SC2086 # options are several words
        "$edof" optics design --through edof-t4w12-outer-mid $options --images "$photographs" --photos 1,2,4,5,7,8,10,11 --rounds 8 --steps 200 \
            --out "$folder/$name.json" --json "$folder/$name.search.json" $([ -e "$folder/$name.json.search" ] && echo --resume) --force
    done
    # Further seeds of one lens show what differences mean nothing.
    for line in "${lenses[@]/%/=1}" "${lenses[0]}=2" "${lenses[0]}=3"; do
        IFS== read -r name file seed <<<"$line"
        [ -e "$folder/$name-$seed.json" ] && continue
        say "$name, seed $seed"
        # shellcheck disable=SC2046
        "$edof" train --form edof-t4w12 --camera "$file" --tone linear --depths 5 --steps 2000 --seed "$seed" --validate-every 2000 \
            --leave-out "$held_back" --out "$folder/$name-$seed.safetensors" --json "$folder/$name-$seed.json" \
            $(resume "$folder/$name-$seed.safetensors") --force
    done
    python3 scripts/joint.py "$folder" "${lenses[@]}" > docs/results/joint.md
}

# A long training behind the coded lens for sigma = 0.01 alone, unless it is there: alone FILE OPTIONS...
alone() {
    local file=$1
    shift
    [ ! -e "$file" ] || return 0
    say "$file"
    # shellcheck disable=SC2046
    "$edof" train --camera ring-outer --tone linear --noise 0.0099:0.0101 --seed 1 --leave-out "$held_back" "$@" --out "$file.part.safetensors" \
        --name "$(basename "$file" .safetensors)" $(resume "$file.part.safetensors") --force
    mv "$file.part.safetensors" "$file"
}

# What a network for one noise alone gains over that of its class, and what one with more layers and codes does.
one_noise() {
    local folder=$trained/bound free="--non-zeros none --lambda 3e-5"
    mkdir -p "$folder"
    alone "$folder/one-noise.safetensors" --from edof-t4w12-outer-mid --weighting mse --steps 80000
    # shellcheck disable=SC2086 # options are several words
    alone "$folder/larger-first-round.safetensors" --form one-sided,w12,t5,c256,r $free --steps 32000
    # shellcheck disable=SC2086
    alone "$folder/larger.safetensors" --from "$folder/larger-first-round.safetensors" $free --weighting mse --steps 80000
    # shellcheck disable=SC2046
    "$edof" study kodak --tone linear --psi 0,2,4,6,8 --noise 0.01 --stride 8 \
        --nets "edof-t4w12-outer-mid,$folder/one-noise.safetensors,$folder/larger.safetensors" $(rows one-noise) $(pages one-noise)
    table one-noise
}

# Linear, so that nothing is trained and no photograph is read.
# shellcheck disable=SC2046
bound() {
    is_made docs/results/bound.md ||
        "$edof" optics bound ring-outer --range 8:0,12:0,16:0,24:0 --electrons 100,1000,10000 --out docs/figures/bound $(pages bound)
}

# The paper's form with T = 3 to 10, one short training each (half the usual rate, at which T = 10 does not converge), quantized on drawn
# scenes, then measured on the test photographs.
layers() {
    local layers name nets=() folder=$made/layers
    mkdir -p "$folder"
    for layers in 3 4 5 6 8 10; do
        name=$folder/paper-t$layers-short
        nets+=("$name.safetensors")
        [ -e "$name.fixed.safetensors" ] && continue
        say "T = $layers"
        # shellcheck disable=SC2046
        "$edof" train --form "paper-t4,t$layers" --camera ring-2018 --tone linear --leave-out "$held_back" --steps 8000 --rate 1e-3 --seed 1 \
            --out "$name.safetensors" --json "$name.json" $(resume "$name.safetensors") --force
        "$edof" quantize "$name.safetensors" --out "$name.fixed.safetensors" --force
    done
    "$edof" study single-depth --nets "$(IFS=,; echo "${nets[*]}")" --methods malvar --psi 8 --noise none --stride 8 \
        --rows "$folder/rows.jsonl" > /dev/null
    python3 scripts/layers.py "$folder" > docs/results/layers.md
}

figures() {
    local lens
    for lens in ring-2018 ring-outer; do
        "$edof" optics "$lens" --psi 0,2,4,6,8 --out "$made/$lens"
        cp "$made/$lens"/{figure1.svg,mtf.svg,psf.png} "docs/figures/$lens/"
    done
    "$edof" demo --scene chart --tone linear --height 320 --width 480 --design none --out "$made/demo-chart"
    cp "$made/demo-chart/overview.png" docs/figures/demo/
    "$edof" demo --design none --out "$made/demo"
    cp "$made/demo/depths.png" docs/figures/demo/
}

for part in "$@"; do
    say "$part"
    case $part in
        linear | srgb) photographs_of "$part" ;;
        held-back) unseen "$part" "$held_back" ;;
        held-back-colourful) unseen "$part" "$colourful" ;;
        *) "${part//-/_}" ;;
    esac
done
say "made of revision $revision: $*"
