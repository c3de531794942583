#!/usr/bin/env bash
# Reports in a headless Chromium at 390 and 1400 pixels: no message on the console, no wider than the window, tables that sort, and where there are
# pictures the viewer at work: scripts/test-report.sh [REPORT.html…]. Without a report the demo's, of at most 3 MB; others may have 5.
# Screenshots to look at are left in out/screens. Apart from test.sh, because it needs a browser (apt-get install chromium).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh

browser=${BROWSER:-$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)}
[ -n "$browser" ] || fail "no browser; install one by: apt-get install chromium"
out=out/screens
mkdir -p "$out"
if [ $# -gt 0 ]; then
    reports=("$@")
    most=5000000
else
    say "edof demo"
    cargo build --release --locked --package edof-cli
    "${CARGO_TARGET_DIR:-target}/release/edof" demo --design none --out "$out/demo" >/dev/null
    reports=("$out/demo/report.html")
    most=3000000
fi

# The same page, which then sorts its tables, opens its viewer on the last picture, magnifies it and asks for differences.
cat >"$out/clicks.html" <<'JS'
<script>
"use strict";
const check = (what, holds) => { if (!holds) console.error(what); };
addEventListener("load", () => {
  document.querySelectorAll(".sort").forEach((button) => {
    const head = button.parentElement;
    const cells = () => [...head.closest("table").tBodies[0].rows].map((row) => row.cells[head.cellIndex].textContent);
    const before = cells();
    button.click();
    check("a click does not sort " + button.textContent, head.getAttribute("aria-sort") === "descending");
    const first = cells();
    button.click();
    check("a second click does not turn " + button.textContent, head.getAttribute("aria-sort") === "ascending");
    check("rows are lost: " + button.textContent, [...before].sort().join("|") === [...first].sort().join("|"));
    const numbers = cells().map(Number);
    if (numbers.every(Number.isFinite)) check("numbers do not ascend: " + button.textContent, numbers.every((v, i) => i === 0 || numbers[i - 1] <= v));
  });
  document.querySelectorAll("svg g[clip-path] circle").forEach((dot) => check("a dot tells nothing", dot.querySelector("title") !== null));
  const width = document.documentElement.scrollWidth;
  check("the page is wider than its window: " + width, width <= innerWidth);
  const shown = [...document.querySelectorAll(".row:not(.enlarged) .shown")].pop();
  if (!shown) return;
  shown.click();
  const viewer = document.getElementById("viewer");
  check("the viewer did not open", viewer.open);
  for (const key of ["ArrowLeft", "ArrowRight", "+", "e"]) viewer.dispatchEvent(new KeyboardEvent("keydown", { key }));
  check("E shows no differences", viewer.querySelector(".error").checked);
});
</script>
JS
for report in "${reports[@]}"; do
    [ -r "$report" ] || fail "$report: cannot be read"
    bytes=$(stat -c %s "$report")
    [ "$bytes" -le "$most" ] || fail "$report: $bytes bytes, expected $most at most"
    name=$(basename "$report" .html)
    cat "$report" "$out/clicks.html" >"$out/$name-clicked.html"
    for width in 390 1400; do
        for page in "$report" "$out/$name-clicked.html"; do
            shot=$out/$(basename "$page" .html)-$width
            height=$([ "$page" = "$report" ] && echo 6000 || echo 900)
            # Chromium makes no window narrower than 500 pixels: a phone is a frame in a wider one.
            shown=$page
            if [ "$width" -lt 500 ]; then
                shown=$out/phone.html
                printf '<!doctype html><body style="margin:0"><iframe style="border:0" width=%s height=%s src="file://%s"></iframe>' \
                    "$width" "$height" "$(realpath "$page")" >"$shown"
            fi
            "$browser" --headless=new --no-sandbox --disable-gpu --hide-scrollbars --enable-logging=stderr --virtual-time-budget=10000 \
                --window-size="$width,$height" --screenshot="$shot.png" "file://$(realpath "$shown")" 2>"$shot.log" >&2 || fail "$browser failed: $shot.log"
            if grep -q CONSOLE "$shot.log"; then
                grep CONSOLE "$shot.log" >&2
                fail "$page: messages on the console at $width pixels"
            fi
            say "$shot.png: no message"
        done
    done
done
