#!/usr/bin/env bash
# Reports in a headless Chromium at 390 and 1400 pixels, light and dark: no message on the console, no wider than the window, tables that sort,
# no text of a plot cut or drawn over another, text that can be told from its ground, and where there are pictures the viewer at work:
# scripts/test-report.sh [REPORT.html…]. Without a report the demo's, of at most 3 MB; others may have 5.
# Screenshots of whole pages to look at are left in out/screens as NAME-WIDTH-SCHEME.png. Apart from test.sh, because it needs a browser
# (apt-get install chromium).
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

# The same page, whose plots are looked at, which then sorts its tables, opens its viewer on the last picture, magnifies it and asks for
# differences. Its only message is its height.
cat >"$out/clicks.html" <<'JS'
<script>
"use strict";
const check = (what, holds) => { if (!holds) console.error(what); };
// Red, green and blue of any CSS colour, and from them how far two are apart (WCAG 2.2, contrast ratio: 1 to 21).
const pen = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
const rgb = (colour) => {
  pen.clearRect(0, 0, 1, 1);
  pen.fillStyle = colour;
  pen.fillRect(0, 0, 1, 1);
  return [...pen.getImageData(0, 0, 1, 1).data].slice(0, 3);
};
const light = (colour) => {
  const [r, g, b] = rgb(colour).map((v) => v / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const contrast = (a, b) => (Math.max(light(a), light(b)) + 0.05) / (Math.min(light(a), light(b)) + 0.05);
const style = (element, property) => getComputedStyle(element)[property];
const ground = (element) => {
  for (let at = element; at; at = at.parentElement) {
    const own = style(at, "backgroundColor");
    if (!/, 0\)$|transparent/.test(own)) return own;
  }
  return "#fff";
};
const looks = () => {
  document.querySelectorAll(".plot > svg").forEach((plot) => {
    const [paper, frame] = [style(plot.querySelector("rect"), "fill"), plot.getBoundingClientRect()];
    const title = plot.querySelector(".title").textContent;
    const texts = [...plot.querySelectorAll("text")].map((text) => ({ text, box: text.getBoundingClientRect() }));
    texts.forEach(({ text, box }, i) => {
      const inside = box.left >= frame.left - 1 && box.right <= frame.right + 1 && box.top >= frame.top - 1 && box.bottom <= frame.bottom + 1;
      check(`${title}: cut: ${text.textContent}`, inside);
      check(`${title}: pale: ${text.textContent} ${style(text, "fill")}`, contrast(style(text, "fill"), paper) >= 3);
      const over = texts.slice(i + 1).find(({ box: o }) =>
        Math.min(box.right, o.right) - Math.max(box.left, o.left) > 2 && Math.min(box.bottom, o.bottom) - Math.max(box.top, o.top) > 4);
      check(`${title}: ${text.textContent} over ${over?.text.textContent}`, !over);
    });
    plot.querySelectorAll(".line").forEach((line) => check(`${title}: a pale line ${style(line, "stroke")}`, contrast(style(line, "stroke"), paper) >= 1.9));
    // What is drawn beyond the axes is not seen.
    const area = plot.querySelector("clipPath rect").getBBox();
    plot.querySelectorAll("g[clip-path] [d], g[clip-path] circle, g[clip-path] rect").forEach((dot) => {
      if (dot.classList.contains("line")) return;
      const { x, y, width, height } = dot.getBBox();
      const seen = x + width / 2 >= area.x && x + width / 2 <= area.x + area.width && y + height / 2 >= area.y && y + height / 2 <= area.y + area.height;
      check(`${title}: a point beyond the axes: ${dot.textContent}`, seen);
    });
    const lines = plot.querySelectorAll("g[clip-path] > *").length;
    const named = plot.querySelectorAll(".name").length + (plot.closest(".diagram").querySelectorAll(".legend li").length);
    check(`${title}: nothing says what is drawn`, lines < 2 || named > 0);
  });
  document.querySelectorAll(".plot, .wide").forEach((box) =>
    check("a part is hidden and nothing says so", box.scrollWidth <= box.clientWidth + 1 || style(box, "overflowX") === "auto" && box.classList.contains("cut")));
  document.querySelectorAll("p, td, th, dt, dd, li, figcaption, h1, h2, h3, summary").forEach((part) => {
    if (part.textContent.trim() !== "") check(`pale: ${part.textContent.slice(0, 40)}`, contrast(style(part, "color"), ground(part)) >= 4.5);
  });
  // A word of a table breaks nowhere but at its own hyphens, dots and strokes, or where it alone is wider than the column may be.
  const range = document.createRange();
  document.querySelectorAll("td, th").forEach((cell) => {
    const walker = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT);
    for (let node; (node = walker.nextNode()); ) {
      for (const { 0: word, index } of node.data.matchAll(/[\p{L}\p{N}]+/gu)) {
        range.setStart(node, index);
        range.setEnd(node, index + word.length);
        const lines = new Set([...range.getClientRects()].map((box) => Math.round(box.top)));
        check(`a word is broken: ${word}`, lines.size < 2);
      }
    }
  });
};
addEventListener("load", () => {
  document.querySelectorAll("details").forEach((details) => { details.open = true; });
  looks();
  document.querySelectorAll("details").forEach((details) => { details.open = false; });
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
  console.log("HEIGHT " + document.documentElement.scrollHeight);
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

# shot PAGE NAME WIDTH HEIGHT SCHEME: a screenshot of the page, and what it says on the console in NAME.log.
shot() {
    local shown=$1 name=$2 width=$3 height=$4 scheme=$5
    # Chromium makes no window narrower than 500 pixels: a phone is a frame in a wider one.
    if [ "$width" -lt 500 ]; then
        shown=$out/phone.html
        printf '<!doctype html><meta name="color-scheme" content="light dark"><body style="margin:0"><iframe style="border:0" width=%s height=%s src="file://%s"></iframe>' \
            "$width" "$height" "$(realpath "$1")" >"$shown"
    fi
    # 0 is dark, 1 light: what the page is told that its user prefers.
    "$browser" --headless=new --no-sandbox --disable-gpu --hide-scrollbars --enable-logging=stderr --virtual-time-budget=10000 \
        --blink-settings=preferredColorScheme="$([ "$scheme" = dark ] && echo 0 || echo 1)" \
        --window-size="$width,$height" --screenshot="$name.png" "file://$(realpath "$shown")" 2>"$name.log" >&2 || fail "$browser failed: $name.log"
    if grep CONSOLE "$name.log" | grep -v '"HEIGHT ' >&2; then
        fail "$1: messages on the console at $width pixels, $scheme"
    fi
    say "$name.png: no message"
}

for report in "${reports[@]}"; do
    [ -r "$report" ] || fail "$report: cannot be read"
    bytes=$(stat -c %s "$report")
    [ "$bytes" -le "$most" ] || fail "$report: $bytes bytes, expected $most at most"
    name=$(basename "$report" .html)
    cat "$report" "$out/clicks.html" >"$out/$name-clicked.html"
    for width in 390 1400; do
        for scheme in light dark; do
            clicked=$out/$name-clicked-$width-$scheme
            shot "$out/$name-clicked.html" "$clicked" "$width" 900 "$scheme"
            # Whole, as far as Chromium makes pictures so high.
            height=$(sed -n 's/.*"HEIGHT \([0-9]*\)".*/\1/p' "$clicked.log" | head -1)
            [ -n "$height" ] || fail "$clicked.log: the page did not tell its height"
            shot "$report" "$out/$name-$width-$scheme" "$width" "$((height < 16000 ? height : 16000))" "$scheme"
        done
    done
done
