// A short training for the lens on the page: offered, followed, and its network looked through.

import * as server from "./server.js";

/** Milliseconds from look to look. */
const EVERY = 500;
const PARTS = { photographs: "reading photographs", blur: "blurring photographs", steps: "training" };

const duration = (seconds) => (seconds < 90 ? `${Math.round(seconds)} s` : `${Math.round(seconds / 60)} min`);

/**
 * Fills `place`. `current()` is the state of the page; `ready()` has it read the list of networks again, and `look(state)` shows the lens of a state with the network
 * that is the one for it.
 */
export function training(place, steps, { current, ready, look }) {
  const text = Object.assign(document.createElement("p"), { id: "training-text" });
  text.setAttribute("role", "status");
  const bar = Object.assign(document.createElement("progress"), { id: "training-bar" });
  bar.setAttribute("aria-label", "Progress of the training");
  const left = Object.assign(document.createElement("span"), { id: "training-left", className: "small" });
  // One button, so that the keyboard stays on it.
  const button = Object.assign(document.createElement("button"), { id: "train", type: "button" });
  let offered = false, looked = "", running = false, began = null, failure = "", made = null;
  // What is said of each network that was trained.
  const words = new Map();
  const lensOf = ({ camera, stops }) => JSON.stringify([camera, stops]);

  function say(line) {
    // A screen reader says a line again that is set again.
    if (text.textContent !== line) text.textContent = line;
  }
  function fill(...wanted) {
    for (const one of [...place.children]) if (!wanted.includes(one)) one.remove();
    // What stays is not moved: a button that is moved loses the keyboard.
    wanted.forEach((one, index) => place.children[index] === one || place.insertBefore(one, place.children[index] ?? null));
  }
  function show() {
    if (running) {
      button.textContent = "Cancel";
      fill(text, bar, left, button);
    } else if (made && lensOf(made.state) !== lensOf(current())) {
      say(`${made.network} is ready, for the lens as it was when its training began.`);
      button.textContent = "Back to that lens";
      fill(text, button);
    } else if (offered) {
      say(`${failure}A short training (${steps} steps) makes one on this computer.`);
      button.textContent = "Train a network for this lens";
      fill(text, button);
    } else {
      say(words.get(looked) ?? "");
      fill(text);
    }
  }
  async function follow() {
    const status = await server.training().catch((error) => ({ is: "failed", error: error.message }));
    running = status.is === "running";
    if (running) {
      say(`A network for this lens: ${PARTS[status.part]}.`);
      [bar.max, bar.value] = [status.of, status.done];
      left.textContent = `${status.done} of ${status.of}${status.seconds_left === null ? "" : `, ${duration(status.seconds_left)} left`}`;
      show();
      setTimeout(follow, EVERY);
      return;
    }
    failure = { cancelled: "The training was cancelled. ", failed: `The training failed: ${status.error}. ` }[status.is] ?? "";
    if (status.is === "done") {
      const { network } = status;
      words.set(network, `${network} is the network for this lens now: ${status.validation_db.toFixed(2)} dB on validation windows, after ${duration(status.seconds)}. The same by: ${status.command}`);
      await ready();
      if (began && lensOf(began) === lensOf(current())) {
        [offered, looked] = [false, network];
        look(current());
      } else if (began) made = { state: began, network };
    }
    show();
  }
  button.addEventListener("click", async () => {
    if (running) return server.cancel().catch(() => {});
    if (made) {
      const { state } = made;
      made = null;
      look(state);
      return show();
    }
    began = structuredClone(current());
    try {
      await server.train(began);
      failure = "";
      running = true;
      follow();
    } catch (error) {
      failure = `${error.message}. `;
      show();
    }
  });
  show();
  // A page that was loaded again follows the training that runs.
  server.training().then(({ is }) => is === "running" && follow());
  return {
    /** The network that is looked through, and whether it was trained for another lens; one that was trained for this lens meanwhile is taken. */
    offer(network, isForeign) {
      [looked, offered] = [network, isForeign];
      if (made && lensOf(made.state) === lensOf(current())) {
        made = null;
        if (isForeign) return look(current());
      }
      if (!running) show();
    },
  };
}
