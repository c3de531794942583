// The page: settings, pictures, plots and words that follow each other.

import { controls } from "./controls.js";
import { plot, psfs } from "./plots.js";
import * as server from "./server.js";
import { training } from "./training.js";
import { viewer } from "./viewer.js";

const TITLES = {
  sharp: "Sharp", raw: "Raw", demosaiced: "This lens, demosaiced", network: "This lens, network", clear: "Clear lens, network",
};
const COLOURS = ["red", "green", "blue"];
/** Depths at which PSNR is computed. */
const DEPTHS = 9;

const at = (id) => document.getElementById(id);
const main = document.querySelector("main");
const paragraph = (text, className = "") => Object.assign(document.createElement("p"), { textContent: text, className });
const db = (value) => (value === null ? "\u221e" : value.toFixed(2));

let shown = null;
const view = viewer(at("view"), at("split"), at("zoom"));

function fail(error) {
  at("error").textContent = error.message;
}

/** Fields of cameras in words. */
const FIELDS = {
  rings: "its rings", mask: "its mask", profile: "its mask", height_map: "its mask", focus_psi: "its focus", aperture_radius_mm: "its aperture",
  defocus_sign: "the side of its focus", aberrations: "its aberrations", focal_length_mm: "its focal length", pixel_pitch_um: "its pixels", spectra: "its colours",
};

function network({ network: { name, layers, camera, differs, is_noise_known } }) {
  const part = layers[0] === layers[1] ? "" : `, ${layers[0]} of ${layers[1]} layers`;
  const words = [...new Set(differs.map((field) => FIELDS[field] ?? field))];
  const lens = differs.length ? `trained for ${camera}: ${words.join(", ")} differ${words.length === 1 ? "s" : ""}` : `trained for this lens`;
  const noise = { true: "", false: "; not for this much noise or so little", null: "; for other pictures" }[String(is_noise_known)];
  return { text: `${name}${part}; ${lens}${noise}`, isForeign: differs.length > 0, words };
}

function figures(answer) {
  const of = (id) => answer.pictures.find((picture) => picture.id === id).psnr_db;
  const fNumber = (lens) => `F/${lens.f_number.toFixed(1)}`;
  const rows = [
    ["demosaiced", `${fNumber(answer.lens)}, no network`],
    ["network", `${fNumber(answer.lens)}, ${network(answer.lens).text}`],
    ["clear", `${fNumber(answer.clear)}, ${network(answer.clear).text}`],
  ];
  at("figures").replaceChildren(...rows.map(([id, words]) => {
    const row = document.createElement("tr");
    const title = Object.assign(document.createElement("th"), { scope: "row", textContent: TITLES[id] });
    const cells = [db(of(id)), words].map((text) => Object.assign(document.createElement("td"), { textContent: text }));
    cells[0].id = `db-${id}`;
    row.append(title, ...cells);
    return row;
  }));
  const { isForeign, words } = network(answer.lens);
  const text = `This network was not trained for this lens (${words.join(", ")} differ${words.length === 1 ? "s" : ""}). A network of its own would do better: save the camera below, then ${answer.train}`;
  at("warning").textContent = isForeign ? text : "";
  lesson.offer(answer.lens.network.name, isForeign);
}

function commands(answer, { scene, stride, seed }) {
  const { camera, psi, noise, network: own } = answer.lens;
  const isDrawn = scene === "leaves" || scene === "chart";
  const picture = isDrawn ? `${scene} --size ${answer.width}x${answer.height}` : "picture.png";
  const layers = own.layers[0] === own.layers[1] ? "" : "  # with all layers";
  const force = own.differs.length ? " --force" : "";
  at("commands").textContent = [
    `edof optics page.json --psi ${psi}`,
    `edof capture ${picture} --camera page.json --psi ${psi} --noise ${noise} --seed ${seed} --out raw.png --sharp sharp.png`,
    `edof reconstruct raw.png --float --weights ${own.weights} --stride ${stride} --out out.png --bits 16${force}${layers}`,
    "edof compare sharp.png out.png",
  ].join("\n");
  at("commands-note").textContent = isDrawn ? "" : "The page makes large pictures smaller first; the commands take picture.png as it is.";
  const isOwn = own.weights !== own.name;
  at("network-place").hidden = !isOwn;
  if (isOwn) Object.assign(at("network-file"), { href: `weights/${own.weights}`, download: own.weights, textContent: `Save the network as ${own.weights}` });
  at("camera-file").href = `data:application/json,${encodeURIComponent(JSON.stringify(camera, null, 2))}`;
}

function present() {
  const [left, right] = ["left", "right"].map((side) => at(side).value);
  view.show({ left: shown.pixels[left], right: shown.pixels[right] }, { left: TITLES[left], right: TITLES[right] });
}

const pictures = server.latest(async (state) => {
  try {
    const answer = await server.pictures(state);
    shown = answer;
    at("error").textContent = "";
    present();
    figures(answer);
    commands(answer, state);
    at("pace").textContent = `computed in ${Math.round(1000 * answer.seconds)} ms`;
  } catch (error) {
    fail(error);
  }
  settle();
});

const lens = server.latest(async (state) => {
  try {
    const answer = await server.lens({ camera: state.camera, psi: state.psi, stops: state.stops });
    const side = psfs(at("psfs"), answer.psf, answer.kernel_side);
    const metres = answer.distance_m === null ? "" : `, ${answer.distance_m.toFixed(2)} m`;
    at("psf-note").textContent = `${side} \u00d7 ${side} pixels, each scaled to its peak. F/${answer.f_number.toFixed(2)}${metres}.`;
    const curve = (values, range, name, style) => ({ name, style, points: values.map((value, i) => [range[0] + ((range[1] - range[0]) * i) / (values.length - 1), value]) });
    const low = Math.min(0, ...answer.mtf.flat());
    plot(at("mtf"), {
      x: { title: "frequency / cut-off of green", range: [0, 1] }, y: { range: [low < -0.02 ? Math.floor(5 * low) / 5 : 0, 1] },
      curves: answer.mtf.map((values, i) => curve(values, [0, 1], COLOURS[i], COLOURS[i])),
      label: `Contrast over spatial frequency. At a quarter of the cut-off: ${COLOURS.map((name, i) => `${name} ${answer.contrast_quarter_cutoff[i].toFixed(3)}`).join(", ")}.`,
    });
    const { psi, contrast, clear } = answer.over_depth;
    const colour = (all, channel) => all.map((values, i) => [psi[i], Math.abs(values[channel])]);
    const dotted = COLOURS.map((name, channel) => ({ name: channel ? "" : "without mask", style: `${name} dots`, points: colour(clear, channel) }));
    const most = Math.max(...contrast.flat().map(Math.abs), ...clear.flat().map(Math.abs));
    plot(at("contrast"), {
      x: { title: "\u03c8 of the open lens", range: [psi[0], psi.at(-1)] }, y: { range: [0, Math.ceil(10 * most) / 10] }, mark: state.psi,
      curves: [...dotted, ...COLOURS.map((name, channel) => ({ name, style: name, points: colour(contrast, channel) }))],
      label: `Contrast at a quarter of the cut-off over depth. At \u03c8 ${state.psi.toFixed(2)}: ${COLOURS.map((name, i) => `${name} ${answer.contrast_quarter_cutoff[i].toFixed(3)}`).join(", ")}.`,
    });
    main.dataset.contrast = answer.contrast_quarter_cutoff.join(" ");
  } catch (error) {
    fail(error);
  }
  settle();
});

let depthRows = [];
let depthKey = "";
function plotDepths(state) {
  if (!depthRows.length) return;
  const values = depthRows.flatMap(({ demosaiced, network, clear }) => [demosaiced, network, clear]);
  const [low, high] = [Math.floor(Math.min(...values) - 0.5), Math.ceil(Math.max(...values) + 0.5)];
  const points = (id) => depthRows.map((row) => [row.psi, row[id]]);
  const worst = (id) => Math.min(...depthRows.map((row) => row[id])).toFixed(1);
  plot(at("depths"), {
    x: { title: "\u03c8 of the open lens", range: state.camera.psi_range }, y: { range: [low, high] }, mark: state.psi,
    curves: [
      { name: "this lens, network", style: "accent", points: points("network") },
      { name: "clear lens, network", style: "grey dashed", points: points("clear") },
      { name: "this lens, demosaiced", style: "grey dots", points: points("demosaiced") },
    ],
    label: `PSNR in dB over depth. Worst depth: this lens with its network ${worst("network")}, clear lens ${worst("clear")}, demosaiced ${worst("demosaiced")}.`,
  });
}

/** What PSNR over depth depends on. */
const keyOf = (state) => JSON.stringify({ ...state, psi: 0 });

const depths = server.latest(async (state, isStale) => {
  const key = keyOf(state);
  if (key === depthKey) return settle();
  const [low, high] = state.camera.psi_range;
  const rows = [];
  try {
    for (let index = 0; index < DEPTHS; index++) {
      // Pictures come first.
      if (isStale() || pictures.isBusy()) return depths.request(controlled.state);
      rows.push(await server.depth({ ...state, psi: low + ((high - low) * index) / (DEPTHS - 1) }));
      depthRows = [...rows];
      plotDepths(controlled.state);
    }
    depthKey = key;
  } catch (error) {
    fail(error);
  }
  settle();
}, 400);

let adviceKey = "";
const advice = server.latest(async ({ camera, electrons, read_noise_e }) => {
  const key = JSON.stringify([{ ...camera, focus_psi: 0 }, electrons, read_noise_e]);
  if (key === adviceKey) return settle();
  try {
    const { lines, clear } = await server.advice({ camera, electrons, read_noise_e });
    const list = document.createElement("ul");
    list.append(...lines.filter((line) => line.startsWith("  ")).map((line) => Object.assign(document.createElement("li"), { textContent: line.trim() })));
    const paragraphs = lines.filter((line) => !line.startsWith("  ")).map((line) => paragraph(line, line.startsWith("Advice") ? "advised" : ""));
    paragraphs.splice(-1, 0, list);
    at("advice").replaceChildren(...paragraphs);
    adviceKey = key;
    if (clear && JSON.stringify(clear) !== JSON.stringify(controlled.state.clear)) controlled.move({ clear });
  } catch (error) {
    at("advice").replaceChildren(paragraph(error.message));
  }
  settle();
}, 600);

function settle() {
  // The work that calls this is not over yet.
  setTimeout(() => {
    main.setAttribute("aria-busy", String([pictures, lens, depths, advice].some((work) => work.isBusy())));
  }, 0);
}

function changed(state) {
  const now = structuredClone(state);
  main.setAttribute("aria-busy", "true");
  pictures.request(now);
  lens.request(now);
  depths.request(now);
  advice.request(now);
  plotDepths(now);
}

async function take(file) {
  try {
    const { notes } = await server.photograph(file);
    if (!setup.scenes.includes(setup.photograph)) setup.scenes.push(setup.photograph);
    // The seed makes it another state although the picture has the same name.
    controlled.move({ scene: setup.photograph, seed: controlled.state.seed + 1 });
    controlled.build();
    at("error").textContent = notes.join(" ");
  } catch (error) {
    fail(error);
  }
}

const setup = await server.setup().catch((error) => {
  fail(error);
  throw error;
});
const controlled = controls(at("controls"), setup, changed);
const lesson = training(at("training"), setup.steps, {
  current: () => controlled.state,
  async ready() {
    setup.networks = (await server.setup()).networks;
    controlled.build();
  },
  look({ camera, stops }) {
    controlled.move({ camera, stops, network: null, layers: null });
    controlled.build();
  },
});
at("controls").addEventListener("photograph", (event) => take(event.detail));
for (const [side, first] of [["left", "network"], ["right", "clear"]]) {
  for (const [id, title] of Object.entries(TITLES)) at(side).append(Object.assign(document.createElement("option"), { value: id, textContent: title, selected: id === first }));
  at(side).addEventListener("change", present);
}
for (const kind of ["dragenter", "dragover"]) {
  document.addEventListener(kind, (event) => {
    event.preventDefault();
    document.body.classList.add("dropping");
  });
}
document.addEventListener("dragleave", (event) => event.relatedTarget === null && document.body.classList.remove("dropping"));
document.addEventListener("drop", (event) => {
  event.preventDefault();
  document.body.classList.remove("dropping");
  if (event.dataTransfer.files[0]) take(event.dataTransfer.files[0]);
});
changed(controlled.state);
