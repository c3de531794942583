// Two pictures under one split, with zoom.

/** Nearer to the line than this, in CSS pixels, a drag moves it. */
const GRIP = 24;

export function viewer(canvas, split, zoom) {
  const context = canvas.getContext("2d");
  const sides = { left: document.createElement("canvas"), right: document.createElement("canvas") };
  // The middle of what is seen, as shares of the picture.
  let centre = [0.5, 0.5];
  let names = { left: "", right: "" };

  const clamped = (value, low, high) => Math.min(high, Math.max(low, value));
  const scale = () => Number(zoom.value);
  function keepInside() {
    const half = 0.5 / scale();
    centre = centre.map((share) => clamped(share, half, 1 - half));
  }
  function draw() {
    keepInside();
    const { left, right } = sides;
    const [width, height] = [left.width, left.height];
    if (!width || !canvas.clientWidth) return;
    const ratio = window.devicePixelRatio || 1;
    const [w, h] = [Math.round(canvas.clientWidth * ratio), Math.round((canvas.clientWidth * ratio * height) / width)];
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    const seen = 1 / scale();
    const [x, y] = [(centre[0] - seen / 2) * width, (centre[1] - seen / 2) * height];
    context.imageSmoothingEnabled = (w * scale()) / width < 2;
    const at = (Number(split.value) / 100) * w;
    const part = (side, from, to) => {
      context.save();
      context.beginPath();
      context.rect(from, 0, to - from, h);
      context.clip();
      context.drawImage(side, x, y, seen * width, seen * height, 0, 0, w, h);
      context.restore();
    };
    part(left, 0, at);
    part(right, at, w);
    context.fillStyle = "#000";
    context.fillRect(at - 1.5 * ratio, 0, 3 * ratio, h);
    context.fillStyle = "#fff";
    context.fillRect(at - 0.5 * ratio, 0, ratio, h);
    context.beginPath();
    context.arc(at, h / 2, 7 * ratio, 0, 2 * Math.PI);
    context.fill();
  }
  function say() {
    split.nextElementSibling.value = `${split.value} %`;
    zoom.nextElementSibling.value = `${scale()}\u00d7`;
    const text = `${names.left} on the left, ${names.right} on the right, split at ${split.value} %, zoom ${scale()}`;
    canvas.setAttribute("aria-label", text);
    draw();
  }
  function zoomBy(step, towards = centre) {
    const before = scale();
    zoom.value = before + step;
    // What is under the pointer stays there.
    centre = centre.map((share, i) => towards[i] + ((share - towards[i]) * before) / scale());
    say();
  }
  const share = (event) => {
    const { left, top, width, height } = canvas.getBoundingClientRect();
    const place = [(event.clientX - left) / width, (event.clientY - top) / height];
    return { place, picture: place.map((value, i) => centre[i] + (value - 0.5) / scale()), width };
  };

  let drag = null;
  canvas.addEventListener("pointerdown", (event) => {
    const { place, width } = share(event);
    const isSplit = scale() === 1 || Math.abs(place[0] * 100 - Number(split.value)) * width < GRIP * 100;
    drag = { isSplit, place, centre };
    canvas.setPointerCapture(event.pointerId);
    if (isSplit) [split.value, drag.moved] = [100 * place[0], true];
    say();
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!drag) return;
    const { place } = share(event);
    if (drag.isSplit) split.value = 100 * place[0];
    else centre = drag.centre.map((value, i) => value - (place[i] - drag.place[i]) / scale());
    say();
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => (drag = null));
  canvas.addEventListener("wheel", (event) => {
    if (event.deltaY === 0) return;
    // At either end the page scrolls.
    const step = event.deltaY < 0 ? 0.5 : -0.5;
    if (scale() + step < Number(zoom.min) || scale() + step > Number(zoom.max)) return;
    event.preventDefault();
    zoomBy(step, share(event).picture);
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const move = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    const step = { "+": 0.5, "=": 0.5, "-": -0.5 }[event.key];
    if (event.ctrlKey || event.metaKey || (!move && !step)) return;
    event.preventDefault();
    if (step) return zoomBy(step);
    if (scale() === 1) split.value = Number(split.value) + 2 * move[0];
    else centre = centre.map((value, i) => value + (0.1 * move[i]) / scale());
    say();
  });
  for (const bar of [split, zoom]) bar.addEventListener("input", say);
  new ResizeObserver(draw).observe(canvas);

  return {
    /** Shows two pictures by their names. */
    show(pixels, titles) {
      names = titles;
      for (const side of ["left", "right"]) {
        const image = pixels[side];
        if (sides[side].width !== image.width || sides[side].height !== image.height) {
          [sides[side].width, sides[side].height] = [image.width, image.height];
        }
        sides[side].getContext("2d").putImageData(image, 0, 0);
      }
      say();
    },
  };
}
