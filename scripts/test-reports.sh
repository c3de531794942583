#!/usr/bin/env bash
# Opens reports in headless Chromium, clicks and keys through them, and takes pictures of them at the width of a desk and of a phone:
# scripts/test-reports.sh REPORT.html…; pictures go to target/reports/. Fails on any error in the console, on what does not answer, on a page that
# is wider than a phone, and on reports beyond 5 MB. Not part of scripts/test.sh: Chromium is large.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
fail() { echo "test-reports.sh: $*" >&2; exit 1; }
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || fail "no Chromium here"
[ $# -gt 0 ] || fail "name reports, as in: edof study knobs … --report knobs.html; scripts/test-reports.sh knobs.html"
shots=${CARGO_TARGET_DIR:-target}/reports
mkdir -p "$shots"
shots=$(cd "$shots" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat > "$work/clicks.html" <<'EOF'
<script>
"use strict";
const told = [], check = (what, holds) => { if (!holds) told.push(what); };
window.addEventListener("error", (event) => told.push(event.message));
window.addEventListener("load", () => {
  const key = (name) => document.getElementById("viewer").dispatchEvent(new KeyboardEvent("keydown", { key: name, bubbles: true }));
  document.querySelectorAll(".sort").forEach((button) => {
    const head = button.parentElement;
    const cells = () => [...head.closest("table").tBodies[0].rows].map((row) => row.cells[head.cellIndex].textContent);
    const before = cells();
    button.click();
    check("a click sorts: " + button.textContent, head.getAttribute("aria-sort") === "descending");
    const first = cells();
    button.click();
    check("a second click turns it: " + button.textContent, head.getAttribute("aria-sort") === "ascending");
    check("no row is lost: " + button.textContent, [...before].sort().join("|") === [...first].sort().join("|"));
    const numbers = cells().map(Number.parseFloat);
    if (numbers.every(Number.isFinite)) check("numbers ascend: " + button.textContent, numbers.every((v, i) => i === 0 || numbers[i - 1] <= v));
  });
  const shown = document.querySelector(".shown");
  if (shown) {
    const viewer = document.getElementById("viewer"), name = () => viewer.querySelector(".name").textContent;
    shown.click();
    check("a picture opens", viewer.open && /\(1 of/.test(name()));
    key("ArrowRight");
    check("the arrow flips", /\(2 of/.test(name()));
    const zoom = viewer.querySelector(".zoom").textContent;
    key("+");
    check("+ enlarges", viewer.querySelector(".zoom").textContent !== zoom);
    key("e");
    check("E shows the difference", viewer.querySelector(".error").checked);
    viewer.querySelector(".close").click();
    check("the viewer closes", !viewer.open);
  }
  document.querySelectorAll("svg circle").forEach((dot) => {
    check("a dot tells its numbers", dot.closest("g[clip-path]") === null || dot.querySelector("title") !== null);
  });
  check("the page fits its window: " + document.documentElement.scrollWidth, document.documentElement.scrollWidth <= window.innerWidth);
  document.title = told.length ? "WRONG " + told.join("; ") : "ALL WELL";
});
</script>
EOF
open() { "$browser" --headless --no-sandbox --disable-gpu --hide-scrollbars --enable-logging=stderr --virtual-time-budget=20000 "$@"; }
for report in "$@"; do
    [ -r "$report" ] || fail "$report: cannot be read"
    name=$(basename "$report" .html)
    [ "$(stat -c %s "$report")" -lt 5000000 ] || fail "$report: 5 MB or more"
    cat "$report" "$work/clicks.html" > "$work/page.html"
    for size in 1280,900 500,900; do
        open --window-size=$size --dump-dom "file://$work/page.html" > "$work/dom" 2> "$work/said"
        ! grep -E 'CONSOLE' "$work/said" || fail "$report: the console of a window of $size is not empty"
        title=$(grep -o '<title>[^<]*' "$work/dom" | head -n 1)
        [ "$title" = "<title>ALL WELL" ] || fail "$report: window of $size: $title"
        for scheme in light dark; do
            features=(); [ $scheme = light ] || features=(--blink-settings=preferredColorScheme=0)
            open "${features[@]}" --window-size=$size --screenshot="$shots/$name-${size%,*}-$scheme.png" "file://$(realpath "$report")" 2> /dev/null
        done
    done
    echo "$report: well; pictures in $shots"
done
