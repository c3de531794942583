// What the page asks its server for. Every answer is a function of what is sent.

async function asked(path, options) {
  let response;
  try {
    response = await fetch(path, options);
  } catch {
    throw new Error("the program does not answer; is edof play still running?");
  }
  if (response.ok) return response;
  const { error } = await response.json().catch(() => ({ error: `status ${response.status}` }));
  throw new Error(error);
}

const posted = (path, state, signal) => asked(path, { method: "POST", body: JSON.stringify(state), signal });

export const setup = async () => (await asked("setup")).json();
export const lens = async (state) => (await posted("lens", state)).json();
export const depth = async (state) => (await posted("depth", state)).json();
export const advice = async (state) => (await posted("advice", state)).json();
export const train = async (state) => (await posted("train", state)).json();
export const training = async () => (await asked("training")).json();
export const cancel = async () => (await posted("cancel", {})).json();
export const photograph = async (file) => (await asked("photograph", { method: "POST", body: file })).json();

/** All pictures of a state: the text of the answer, and an ImageData for each picture by its id. */
export async function pictures(state) {
  const bytes = await (await posted("pictures", state)).arrayBuffer();
  const length = new DataView(bytes).getUint32(0, true);
  const text = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, length)));
  const size = 4 * text.width * text.height;
  text.pixels = {};
  text.pictures.forEach(({ id }, index) => {
    const pixels = new Uint8ClampedArray(bytes, 4 + length + index * size, size);
    text.pixels[id] = new ImageData(pixels, text.width, text.height);
  });
  return text;
}

/**
 * Runs work for the latest request alone: one at a time, and of those that come meanwhile only the last, `rest` milliseconds after it at the earliest.
 */
export function latest(work, rest = 0) {
  let wanted = null, running = false, timer = null;
  const run = async () => {
    if (running || timer !== null || wanted === null) return;
    running = true;
    const state = wanted;
    wanted = null;
    try {
      await work(state, () => wanted !== null);
    } finally {
      running = false;
      run();
    }
  };
  const request = (state) => {
    wanted = state;
    clearTimeout(timer);
    timer = setTimeout(() => {
      timer = null;
      run();
    }, rest);
  };
  return { request, isBusy: () => running || wanted !== null };
}
