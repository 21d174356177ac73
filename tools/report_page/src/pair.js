// Two pictures: one above the other to flip between, split by a line, or under a map of what differs.
import { h, switches, choice } from "./dom.js";
import { frame } from "./block.js";
import { colourBar } from "./colours.js";
import { si } from "./format.js";
import { stage } from "./stage.js";
import * as state from "./state.js";

export function pair(block) {
  const [first, second] = block.names;
  const modes = [{ value: "a", name: first }, { value: "b", name: second }, { value: "split", name: "split" }];
  if (block.grids.length > 0) modes.push({ value: "map", name: "differences" });
  const readout = h("output", { class: "readout" });
  const bar = h("div", { class: "bar" });
  let colours = null, layer = null;

  const view = stage({ ...block, picture: block.a }, {
    probed(x, y, value) {
      colours?.point(value ?? null);
      readout.textContent = x === null ? hint() : `pixel ${x}, ${y}` + (layer && value !== null && value !== undefined ? `: ${si(value, layer.unit)} (${layer.name})` : "");
    },
    chosen: () => { if (mode() === "a" || mode() === "b") buttons.turn(mode() === "a" ? "b" : "a"); },
  });
  const other = h("img", { class: "other", src: block.b, alt: "", "aria-hidden": "true" });
  view.append(other);
  const slider = h("input", { type: "range", min: 0, max: 100, value: state.get("split", "50"), "aria-label": "Where the pictures are split",
    oninput: () => { state.set({ split: slider.value === "50" ? "" : slider.value }); split(); } });
  const mode = () => state.get("pair", "split");
  const hint = () => (mode() === "split" ? `left ${first}, right ${second}` : mode() === "map" ? "" : "A click or Enter flips.");
  const buttons = switches("Which picture", modes, mode(), (value) => { state.set({ pair: value === "split" ? "" : value }, listener); show(); });
  const grids = block.grids.length > 1 && choice("Differences in", block.grids.map((g) => ({ value: g.id, name: g.name })), state.get("map", block.grids[0].id),
    (value) => { state.set({ map: value }); show(); });

  function split() {
    other.style.clipPath = `inset(0 0 0 ${slider.value}%)`;
  }
  async function show() {
    const now = mode();
    other.hidden = now === "a" || now === "map";
    slider.hidden = now !== "split";
    if (grids) grids.hidden = now !== "map";
    if (now === "split") split();
    else other.style.clipPath = "none";
    layer = now === "map" ? block.grids.find((g) => g.id === state.get("map")) ?? block.grids[0] : null;
    const map = await view.show(layer, 0.9);
    colours = map ? colourBar(layer, map) : null;
    bar.replaceChildren(...(colours ? [colours] : []));
    readout.textContent = hint();
  }
  const listener = () => buttons.turn(mode());
  state.listen("pair", listener);
  const body = h("div", { class: "drawing" }, view, slider, bar, readout);
  const figure = frame(block, body, { more: [buttons, grids] });
  show();
  return figure;
}
