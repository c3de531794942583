#!/usr/bin/env bash
# The demo's report in a headless Chromium: no message on the console, opened and with its viewer at work, at 390 and 1400 pixels; at most
# 3 MB. Screenshots to look at are left in out/screens. Apart from test.sh, because it needs a browser (apt-get install chromium).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/prepare.sh

browser=${BROWSER:-$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)}
[ -n "$browser" ] || fail "no browser; install one by: apt-get install chromium"
out=out/screens
mkdir -p "$out"
if [ $# -gt 0 ]; then
    report=$1
else
    say "edof demo"
    cargo build --release --locked --package edof-cli
    "${CARGO_TARGET_DIR:-target}/release/edof" demo --design none --out "$out/demo" >/dev/null
    report=$out/demo/report.html
fi
bytes=$(stat -c %s "$report")
[ "$bytes" -le 3000000 ] || fail "$report: $bytes bytes, expected 3,000,000 at most"

# The same page, which then opens its viewer on the last picture, magnifies it and asks for differences.
cp "$report" "$out/viewer.html"
cat >>"$out/viewer.html" <<'JS'
<script>
  [...document.querySelectorAll(".row:not(.enlarged) .shown")].pop().click();
  for (const key of ["ArrowLeft", "ArrowRight", "+", "e"]) {
    document.getElementById("viewer").dispatchEvent(new KeyboardEvent("keydown", { key }));
  }
  if (!document.getElementById("viewer").open) console.error("the viewer did not open");
</script>
JS
for width in 390 1400; do
    for page in "$report" "$out/viewer.html"; do
        name=$(basename "$page" .html)
        height=$([ "$name" = viewer ] && echo 900 || echo 6000)
        log=$out/$name-$width.log
        "$browser" --headless=new --no-sandbox --disable-gpu --hide-scrollbars --enable-logging=stderr --virtual-time-budget=5000 \
            --window-size="$width,$height" --screenshot="$out/$name-$width.png" "file://$(realpath "$page")" 2>"$log" >&2 || fail "$browser failed: $log"
        if grep -q CONSOLE "$log"; then
            grep CONSOLE "$log" >&2
            fail "$page: messages on the console at $width pixels"
        fi
        say "$out/$name-$width.png: no message"
    done
done
