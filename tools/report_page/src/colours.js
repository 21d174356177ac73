// Colour maps of values, the same as those of the charts. Lightness increases with the value.
import { h } from "./dom.js";
import { si, signed } from "./format.js";
import { libraries } from "./lib.js";

const MAPS = { sequential: "viridis", diverging: "blueorange" };
const STEPS = 256;

/** Returns a layer's colour map, which maps 0 to 1 to [r, g, b]. Waits until the libraries are loaded. */
export async function colourMap(layer) {
  const { scheme } = await libraries;
  const map = scheme(layer.diverging ? MAPS.diverging : MAPS.sequential);
  const table = Array.from({ length: STEPS }, (_, i) => rgbOf(map(i / (STEPS - 1))));
  return (share) => table[Math.max(0, Math.min(STEPS - 1, Math.round(share * (STEPS - 1))))];
}

function rgbOf(text) {
  if (text.startsWith("#")) return [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16));
  return text.match(/\d+(\.\d+)?/g).slice(0, 3).map(Number);
}

/** Returns the position of a value between low and high, 0 to 1. */
export function shareOf(value, { low, high, scale }) {
  if (high === low) return 0.5;
  if (scale === "log") return Math.log1p(Math.max(0, value - low)) / Math.log1p(high - low);
  return (value - low) / (high - low);
}
export function valueAt(share, { low, high, scale }) {
  if (scale === "log") return low + Math.expm1(share * Math.log1p(high - low));
  return low + share * (high - low);
}

/** Returns a colour bar with three values and a mark, which `point(value)` moves. */
export function colourBar(layer, map) {
  const canvas = h("canvas", { width: STEPS, height: 1, "aria-hidden": "true" });
  const context = canvas.getContext("2d");
  for (let i = 0; i < STEPS; ++i) {
    context.fillStyle = `rgb(${map(i / (STEPS - 1)).join(",")})`;
    context.fillRect(i, 0, 1, 1);
  }
  const mark = h("span", { class: "mark", hidden: true });
  const text = (share) => (layer.diverging ? signed : si)(valueAt(share, layer), layer.unit);
  const element = h("div", { class: "colour-bar", role: "img", "aria-label": `Colours from ${text(0)} to ${text(1)}` },
    h("div", { class: "strip" }, canvas, mark),
    h("div", { class: "ends" }, h("span", {}, text(0)), h("span", {}, text(0.5)), h("span", {}, text(1))),
    h("div", { class: "caption" }, layer.name));
  element.point = (value) => {
    mark.hidden = value === null;
    if (value !== null) mark.style.left = `${100 * Math.max(0, Math.min(1, shareOf(value, layer)))}%`;
  };
  return element;
}
