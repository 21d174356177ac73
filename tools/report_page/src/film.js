// The pictures of all frames of an animation: one large, all of them small.
import { h } from "./dom.js";
import { frame } from "./block.js";
import { showIn } from "./pictures.js";
import * as state from "./state.js";

const PERIOD = 250;  // milliseconds for which a frame is shown when playing

export function film(block) {
  const { frames, width, height } = block;
  const screen = h("img", { class: "film-screen", width, height, decoding: "async" });
  const readout = h("output", { class: "readout", "aria-live": "off" });
  const slider = h("input", { type: "range", min: 0, max: frames.length - 1, "aria-label": "Frame", oninput: () => choose(Number(slider.value)) });
  const thumbnails = frames.map((f, i) => {
    const image = h("img", { alt: "", width, height, decoding: "async", loading: "lazy" });
    showIn(image, f.picture);
    return h("button", { type: "button", onclick: () => choose(i), "aria-label": `frame ${f.frame}: ${f.words}` }, image, String(f.frame));
  });
  const play = h("button", { type: "button", "aria-pressed": "false", onclick: toggle }, "Play");
  let timer = null;

  const choose = (i) => state.set({ frame: i === 0 ? "" : String(frames[i].frame) });
  const index = () => Math.max(0, frames.findIndex((f) => String(f.frame) === state.get("frame")));

  function toggle() {
    if (timer) clearInterval(timer);
    timer = timer ? null : setInterval(() => choose((index() + 1) % frames.length), PERIOD);
    play.setAttribute("aria-pressed", String(timer !== null));
  }
  function show() {
    const i = index(), f = frames[i];
    showIn(screen, f.picture);
    screen.alt = `Frame ${f.frame}`;
    slider.value = String(i);
    readout.textContent = `frame ${f.frame}: ${f.words}`;
    thumbnails.forEach((button, at) => button.setAttribute("aria-pressed", String(at === i)));
  }

  state.listen("frame", show);
  const figure = frame(block, h("div", { class: "drawing", "data-drawn": "" }, screen, slider, readout, h("div", { class: "film-strip" }, thumbnails)), { more: [play] });
  if (block.note) figure.append(h("p", { class: "note" }, block.note));
  show();
  return figure;
}
