// The settings: native inputs in groups, and the state that they are the positions of.

const STRIDES = [8, 4, 2];

const digits = (value, count) => Number(value).toFixed(count);
const signed = (value, count) => `${value < 0 ? "\u2212" : ""}${digits(Math.abs(value), count)}`;
const psi = (value) => `\u03c8 ${signed(value, 2)}`;
const radians = (value) => `${signed(value, 2)} rad`;
/** Two digits are enough of a light. */
const light10 = (exponent) => Number((10 ** exponent).toPrecision(2));
const electrons = (exponent) => `${light10(exponent).toLocaleString("en")} e\u207b`;

function element(kind, properties = {}, children = []) {
  const made = Object.assign(document.createElement(kind), properties);
  made.append(...children);
  return made;
}

/** A slider with its label and its value in words. */
function slider(id, label, [min, max, step], value, words, changed) {
  const input = element("input", { id, type: "range", min, max, step, value });
  const output = element("output");
  output.htmlFor.add(id);
  const show = () => {
    output.value = words(Number(input.value));
    input.setAttribute("aria-valuetext", output.value);
  };
  input.addEventListener("input", () => {
    show();
    changed(Number(input.value));
  });
  show();
  return element("div", { className: "slider" }, [element("label", { htmlFor: id, textContent: label }), output, input]);
}

function choice(id, label, options, value, changed) {
  const select = element("select", { id });
  for (const [key, text] of options) select.append(element("option", { value: key, textContent: text, selected: key === value }));
  select.addEventListener("change", () => changed(select.value));
  return element("label", { className: "choice" }, [label, select]);
}

function button(id, text, pressed) {
  const made = element("button", { id, type: "button", textContent: text });
  made.addEventListener("click", pressed);
  return made;
}

const group = (title, children) => element("fieldset", {}, [element("legend", { textContent: title }), ...children]);

/** Coefficients of the cubic mask x\u00b3 + y\u00b3 and x\u00b2y + xy\u00b2 of a camera. */
function cubic(camera) {
  const term = (camera.mask ?? []).find((one) => one.polynomial)?.polynomial.terms ?? [];
  const of = (x, y) => term.find((one) => one.x === x && one.y === y)?.rad ?? 0;
  return { strength: of(3, 0), mixed: of(2, 1) };
}

/** Puts a cubic mask in place of the camera's polynomial. */
function withCubic(camera, { strength, mixed }) {
  const mask = (camera.mask ?? []).filter((one) => !one.polynomial);
  if (strength !== 0 || mixed !== 0) {
    const terms = [[3, 0, strength], [0, 3, strength], [2, 1, mixed], [1, 2, mixed]];
    const polynomial = { at_nm: camera.reference_wavelength_nm, cauchy: [1.458, 0.00354], terms: terms.map(([x, y, rad]) => ({ x, y, rad })) };
    mask.push({ polynomial });
  }
  return { ...camera, mask };
}

/** The phase of a ring in radians at the camera's reference wavelength; of an etched one as it is there. */
function ringPhase({ delay }, nm) {
  if (delay.phase) return (delay.phase.rad * delay.phase.at_nm) / nm;
  const { height_um, cauchy } = delay.etched;
  const um = nm / 1000;
  return (2 * Math.PI * height_um * (cauchy[0] + cauchy[1] / um ** 2 - 1)) / um;
}

/** Builds the settings in a form; `changed(state)` follows every movement. */
export function controls(form, setup, changed) {
  const start = (camera) => ({ camera: structuredClone(camera), psi: camera.psi_range[0] + 0.25 * (camera.psi_range[1] - camera.psi_range[0]) });
  const middle = (camera) => ({ stops: 0, focus_psi: 0.5 * (camera.psi_range[0] + camera.psi_range[1]) });
  const state = {
    scene: setup.scenes.at(-1) === setup.photograph ? setup.photograph : setup.scenes[0], ...start(setup.camera), stops: 0, electrons: 3000, read_noise_e: 2.5,
    seed: 0, network: null, layers: null, stride: 4, clear: middle(setup.camera),
  };
  const move = (change) => {
    Object.assign(state, change);
    changed(state);
  };
  const cameras = new Map(setup.presets.map((camera) => [camera.name, camera]));
  const isPreset = JSON.stringify(cameras.get(setup.camera.name)) === JSON.stringify(setup.camera);
  if (!isPreset) cameras.set(`${setup.camera.name} (given)`, setup.camera);
  let chosen = isPreset ? setup.camera.name : `${setup.camera.name} (given)`;

  const moveRing = (index, change) => {
    const rings = state.camera.rings.map((ring, at) => (at === index ? { ...ring, ...change } : ring));
    move({ camera: { ...state.camera, rings } });
  };
  const ring = (one, index) => {
    const nm = state.camera.reference_wavelength_nm;
    const name = (what) => `ring-${index + 1}-${what}`;
    // A ring has a width.
    const inner = (value) => moveRing(index, { inner: Math.min(value, state.camera.rings[index].outer - 0.01) });
    const outer = (value) => moveRing(index, { outer: Math.max(value, state.camera.rings[index].inner + 0.01) });
    const phase = (rad) => moveRing(index, { delay: { phase: { rad, at_nm: nm } } });
    const radius = (value) => digits(value, 4);
    return [
      slider(name("inner"), `Ring ${index + 1}, inner radius`, [0, 0.99, 0.0005], one.inner, radius, inner),
      slider(name("outer"), `Ring ${index + 1}, outer radius`, [0.01, 1, 0.0005], one.outer, radius, outer),
      slider(name("phase"), `Ring ${index + 1}, phase at ${nm} nm`, [-15, 15, 0.01], ringPhase(one, nm), radians, phase),
    ];
  };
  const setRings = (count) => {
    const kept = state.camera.rings.slice(0, count);
    while (kept.length < count) {
      kept.push({ inner: 0.5, outer: 0.75, delay: { phase: { rad: 0, at_nm: state.camera.reference_wavelength_nm } } });
    }
    move({ camera: { ...state.camera, rings: kept } });
    build();
  };
  const mask = () => {
    const { strength, mixed } = cubic(state.camera);
    const set = (change) => move({ camera: withCubic(state.camera, { ...cubic(state.camera), ...change }) });
    return group("Mask", [
      choice("camera", "Camera", [...cameras.keys()].map((name) => [name, name]), chosen, (name) => {
        chosen = name;
        move({ ...start(cameras.get(name)), clear: middle(cameras.get(name)) });
        build();
      }),
      choice("rings", "Rings", [0, 1, 2, 3].map((count) => [String(count), String(count)]), String(state.camera.rings.length), (count) => setRings(Number(count))),
      ...state.camera.rings.flatMap(ring),
      slider("cubic", "Cubic mask, x\u00b3 + y\u00b3", [-10, 10, 0.1], strength, radians, (value) => set({ strength: value })),
      slider("mixed", "Cubic mask, x\u00b2y + xy\u00b2", [-5, 5, 0.1], mixed, radians, (value) => set({ mixed: value })),
    ]);
  };
  const network = () => {
    const one = setup.networks.find(({ name }) => name === state.network);
    const most = one?.layers ?? 4;
    return group("Network", [
      choice("network", "Network", [["", "the one for this lens and noise"], ...setup.networks.map(({ name, camera }) => [name, `${name} (${camera})`])], state.network ?? "", (name) => {
        move({ network: name || null, layers: null });
        build();
      }),
      slider("layers", "Layers", [2, most, 1], state.layers ?? most, (value) => `${value} of ${most}`, (value) => move({ layers: value === most ? null : value })),
      slider("stride", "Stride", [0, STRIDES.length - 1, 1], STRIDES.indexOf(state.stride), (index) => `${STRIDES[index]} pixels`, (index) => move({ stride: STRIDES[index] })),
    ]);
  };
  const picture = () => {
    const file = element("input", { id: "file", type: "file", accept: "image/*" });
    file.addEventListener("change", () => file.files[0] && form.dispatchEvent(new CustomEvent("photograph", { detail: file.files[0] })));
    return group("Picture", [
      choice("scene", "Picture", setup.scenes.map((name) => [name, name]), state.scene, (scene) => move({ scene })),
      element("label", { className: "choice" }, ["Your own, or drop one on the page", file]),
    ]);
  };
  const lens = () => {
    const [low, high] = state.camera.psi_range;
    const range = [low, high, (high - low) / 160];
    const wide = [low - 0.25 * (high - low), high + 0.25 * (high - low), (high - low) / 800];
    return group("Lens", [
      slider("psi", "Depth of the object", range, state.psi, psi, (value) => move({ psi: value })),
      slider("focus", "Focus", wide, state.camera.focus_psi, psi, (value) => move({ camera: { ...state.camera, focus_psi: value } })),
      slider("stops", "Aperture closed by", [0, setup.max_stops, 0.25], state.stops, (value) => `${digits(value, 2)} stops`, (value) => move({ stops: value })),
    ]);
  };
  const light = () => group("Light", [
    slider("electrons", "White pixel, lens open", [2, 5, 0.02], Math.log10(state.electrons), electrons, (value) => move({ electrons: light10(value) })),
    slider("read-noise", "Read noise", [0, 20, 0.5], state.read_noise_e, (value) => `${digits(value, 1)} e\u207b`, (value) => move({ read_noise_e: value })),
    element("div", { className: "row" }, [button("again", "Draw noise again", () => move({ seed: state.seed + 1 }))]),
  ]);
  const build = () => {
    const focused = document.activeElement?.id;
    form.replaceChildren(picture(), lens(), light(), mask(), network());
    // What was built again keeps the keyboard.
    if (focused && form.querySelector(`#${focused}`)) form.querySelector(`#${focused}`).focus();
  };
  form.addEventListener("submit", (event) => event.preventDefault());
  build();
  return { state, move, build };
}
