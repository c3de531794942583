// Plots as SVG, and the pictures of PSFs.

const SVG = "http://www.w3.org/2000/svg";
const [WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM] = [320, 170, 34, 6, 6, 30];

function svg(kind, attributes, text) {
  const made = document.createElementNS(SVG, kind);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

/** Round steps that part a range into about four. */
function ticks(low, high) {
  const rough = (high - low) / 4;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= rough * 0.999);
  const found = [];
  for (let value = Math.ceil(low / step - 1e-9) * step; value <= high + 1e-9 * step; value += step) found.push(Number(value.toPrecision(6)));
  return found;
}

/**
 * A plot of curves `{ name, style, points }` in place of what an element shows. `x` and `y` are `{ title, range }`; `mark` is a position on x.
 */
export function plot(place, { x, y, curves, mark, label }) {
  const across = (value) => LEFT + ((value - x.range[0]) / (x.range[1] - x.range[0])) * (WIDTH - LEFT - RIGHT);
  const down = (value) => HEIGHT - BOTTOM - ((value - y.range[0]) / (y.range[1] - y.range[0])) * (HEIGHT - TOP - BOTTOM);
  const picture = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": label });
  for (const value of ticks(...y.range)) {
    picture.append(svg("line", { class: "axis", x1: LEFT, x2: WIDTH - RIGHT, y1: down(value), y2: down(value) }));
    picture.append(svg("text", { x: LEFT - 5, y: down(value) + 4, "text-anchor": "end" }, String(value).replace("-", "\u2212")));
  }
  for (const value of ticks(...x.range)) {
    picture.append(svg("text", { x: across(value), y: HEIGHT - BOTTOM + 14, "text-anchor": "middle" }, String(value).replace("-", "\u2212")));
  }
  picture.append(svg("text", { x: 0.5 * (LEFT + WIDTH - RIGHT), y: HEIGHT - 4, "text-anchor": "middle" }, x.title));
  for (const { style, points } of curves) {
    const inside = points.map(([a, b]) => `${across(a).toFixed(1)},${down(Math.min(Math.max(b, y.range[0]), y.range[1])).toFixed(1)}`);
    if (inside.length === 1) picture.append(svg("circle", { class: style, cx: inside[0].split(",")[0], cy: inside[0].split(",")[1], r: 2 }));
    picture.append(svg("polyline", { class: `curve ${style}`, points: inside.join(" ") }));
  }
  if (mark !== undefined) picture.append(svg("line", { class: "mark", x1: across(mark), x2: across(mark), y1: TOP, y2: HEIGHT - BOTTOM }));
  const key = document.createElement("ul");
  key.className = "key";
  for (const { name, style } of curves.filter((curve) => curve.name)) {
    const sample = svg("svg", { viewBox: "0 0 22 8", "aria-hidden": "true" });
    sample.append(svg("line", { class: `curve ${style}`, x1: 0, x2: 22, y1: 4, y2: 4 }));
    const entry = document.createElement("li");
    entry.append(sample, name);
    key.append(entry);
  }
  place.replaceChildren(picture, key);
}

/** Codes below this one are too dark to see, and the least pixels that are shown. */
const [FAINT, LEAST] = [22, 9];

/** Half the side of the square outside of which nothing is bright enough to be seen. */
function reach(side, rgba) {
  const half = (side - 1) / 2;
  let most = (LEAST - 1) / 2;
  for (let pixel = 0; pixel < side * side; pixel++) {
    if (Math.max(rgba[4 * pixel], rgba[4 * pixel + 1], rgba[4 * pixel + 2]) < FAINT) continue;
    most = Math.max(most, Math.abs((pixel % side) - half), Math.abs(Math.floor(pixel / side) - half));
  }
  return most;
}

/** Three pictures, one of each colour, from pixels in which each channel is one colour's PSF. Returns the pixels of a side that are shown. */
export function psfs(place, { side, rgba }, sides) {
  const half = reach(side, rgba);
  const [seen, first] = [2 * half + 1, (side - 1) / 2 - half];
  const tints = [[255, 120, 110], [120, 230, 140], [120, 170, 255]];
  const cells = ["Red", "Green", "Blue"].map((name, plane) => {
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [seen, seen];
    const image = new ImageData(side, side);
    for (let pixel = 0; pixel < side * side; pixel++) {
      const share = rgba[4 * pixel + plane] / 255;
      tints[plane].forEach((tint, channel) => (image.data[4 * pixel + channel] = share * tint));
      image.data[4 * pixel + 3] = 255;
    }
    canvas.getContext("2d").putImageData(image, -first, -first);
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${name}: a blur of ${sides[plane]} by ${sides[plane]} pixels`);
    const cell = document.createElement("div");
    cell.append(canvas, document.createElement("br"), name);
    return cell;
  });
  place.replaceChildren(...cells);
  return seen;
}
