// Light and dark theme of the charts; page.css has the colours of the page.
import * as state from "./state.js";

const preferred = window.matchMedia("(prefers-color-scheme: dark)");
let listeners = [];

export const choices = [
  { value: "", name: "as system" },
  { value: "light", name: "light" },
  { value: "dark", name: "dark" },
];

let isPrinting = false;  // true: charts are light, like paper

export function isDark() {
  if (isPrinting) return false;
  const asked = state.get("theme");
  return asked ? asked === "dark" : preferred.matches;
}

/** Colours on a dark ground, by the colour on a light ground that specifications use. */
const DARK = {
  "#1f5fa8": "#6fb0f2",
  "#2b6cb0": "#5a9fe0",
  "#63a0d8": "#3f74a8",
  "#a9cbea": "#2d4f70",
  "#b85c12": "#f0a35a",
  "#e0964a": "#b97a3b",
  "#f2c793": "#6e5233",
  "#17736d": "#4fc0b2",
  "#4aa89a": "#37877c",
  "#9cd3c7": "#2a5a54",
  "#6b4a95": "#b797dd",
  "#a184c2": "#85689f",
  "#cebfdf": "#54466a",
  "#b3446c": "#e58ba0",
  "#d487a3": "#a65f78",
  "#ecc4d2": "#643d4b",
  "#7a7414": "#cdc45a",
  "#8a9099": "#8a94a0",
  "#d3d7dc": "#3b444e",
  "#1c2733": "#dfe6ed",
  "#ffffff": "#0f151b",
};

/** A specification, or a part of one, in the colours of the current theme. */
export function coloured(spec) {
  if (!isDark()) return spec;
  return JSON.parse(JSON.stringify(spec), (key, value) => (typeof value === "string" && DARK[value]) || value);
}
export const colour = (light) => (isDark() && DARK[light]) || light;

/** Vega's configuration of all charts. */
export function config() {
  const dark = isDark();
  const ink = dark ? "#dfe6ed" : "#1c2733";
  const soft = dark ? "#a3afbb" : "#55616e";
  const line = dark ? "#2a333d" : "#e3e7eb";
  const font = getComputedStyle(document.body).fontFamily;
  return {
    background: "transparent",
    font,
    padding: { left: 2, top: 4, right: 6, bottom: 2 },
    view: { stroke: null },
    axis: {
      labelColor: ink, titleColor: soft, gridColor: line, domainColor: line, tickColor: line,
      labelFontSize: 12, titleFontSize: 12, titleFontWeight: 400, titlePadding: 6,
    },
    axisQuantitative: { tickCount: 6 },
    axisY: { grid: false },
    legend: { labelColor: ink, titleColor: soft, labelFontSize: 12, titleFontSize: 12, titleFontWeight: 400 },
    text: { color: ink, fontSize: 12 },
    range: {
      category: dark
        ? ["#5a9fe0", "#f0a35a", "#4fc0b2", "#b797dd", "#8a94a0", "#d8c25a", "#e58ba0", "#8fd07c", "#c99a6a", "#7fd6ec"]
        : ["#2b6cb0", "#b85c12", "#17736d", "#6b4a95", "#8a9099", "#a88a00", "#b3446c", "#3d8b2f", "#7a5230", "#138ba8"],
      ramp: { scheme: "viridis" },
      diverging: { scheme: "blueorange" },
    },
  };
}

/** Adds a listener for changes of the theme. */
export const listen = (listener) => listeners.push(listener);
/** Removes the listeners of the previous view. */
export const freshView = () => (listeners = []);

const root = document.documentElement;
function apply() {
  const now = isDark() ? "dark" : "light";
  if (root.dataset.theme === now) return;
  root.dataset.theme = now;
  for (const listener of listeners) listener();
}
function print(on) {
  isPrinting = on;
  apply();
}
preferred.addEventListener("change", apply);
window.addEventListener("beforeprint", () => print(true));
window.addEventListener("afterprint", () => print(false));
state.listen("theme", apply);
root.dataset.theme = isDark() ? "dark" : "light";
