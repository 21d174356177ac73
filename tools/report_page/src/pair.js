// Two pictures to flip between or to split by a line, and a map of their differences.
import { h, switches, choice } from "./dom.js";
import { frame } from "./block.js";
import { colourBar } from "./colours.js";
import { si, signed } from "./format.js";
import { showIn } from "./pictures.js";
import { stage } from "./stage.js";
import { tileAt, tileRows } from "./tiles.js";
import * as state from "./state.js";

const OPACITY = 0.92;

export function pair(block) {
  const linked = [];
  /** Moves the crosses of the other views to the same pixel. */
  const follow = (self) => (x, y) => linked.forEach((view) => view !== self() && view.mark(x, y));
  const figures = [];
  if (block.a) figures.push(both(block, linked, follow));
  if (block.grids.length > 0) figures.push(map(block, linked, follow));
  const note = block.note && h("p", { class: "note" }, block.note);
  return h("div", {}, h("div", { class: figures.length > 1 ? "beside" : null }, figures), note);
}

function both(block, linked, follow) {
  const [first, second] = block.names;
  const modes = [{ value: "a", name: first }, { value: "b", name: second }, { value: "split", name: "split" }];
  const mode = () => (modes.some((m) => m.value === state.get("pair")) ? state.get("pair") : "split");
  const readout = h("output", { class: "readout" });
  const hint = () => (mode() === "split" ? `Left of the line ${first}, right of it ${second}.` : "A click or Enter flips.");
  const set = (value) => state.set({ pair: value === "split" ? "" : value });

  const view = stage({ ...block, picture: block.a }, {
    probed(x, y) {
      readout.textContent = x === null ? hint() : `pixel ${x}, ${y}`;
      follow(() => view)(x, y);
    },
    chosen: () => mode() !== "split" && set(mode() === "a" ? "b" : "a"),
  });
  linked.push(view);
  const other = h("img", { class: "other", alt: "", "aria-hidden": "true", decoding: "async" });
  showIn(other, block.b);
  view.show(null);
  view.append(other);
  const slider = h("input", { type: "range", min: 0, max: 100, "aria-label": "Where the pictures are split",
    oninput: () => state.set({ split: slider.value === "50" ? "" : slider.value }) });
  const buttons = switches("Which picture", modes, mode(), set);

  function show() {
    const now = mode();
    buttons.press(now);
    slider.value = state.get("split", "50");
    other.hidden = now === "a";
    slider.hidden = now !== "split";
    other.style.clipPath = now === "split" ? `inset(0 0 0 ${slider.value}%)` : "none";
    view.style.setProperty("--split", now === "split" ? `${slider.value}%` : "-9px");
    readout.textContent = hint();
  }
  state.listen("pair", show);
  state.listen("split", show);
  show();
  return frame(block, h("div", { class: "drawing" }, view, slider, readout), { more: [buttons] });
}

function map(block, linked, follow) {
  const [first, second] = block.names;
  const readout = h("output", { class: "readout" });
  const bar = h("div", { class: "bar" });
  const layer = () => block.grids.find((g) => g.id === state.get("map")) ?? block.grids[0];
  const hint = "Point at the map, or move the probe by arrow keys.";
  let colours = null;

  /** Returns a text with the difference at a tile and the values of both runs. */
  function words(x, y, value) {
    const { name, unit, of, tile, diverging } = layer();
    const at = Math.floor(y / tile) * Math.ceil(block.width / tile) + Math.floor(x / tile);
    const between = of ? `; ${first} ${si(of[0][at], unit)}, ${second} ${si(of[1][at], unit)}` : "";
    return `pixel ${x}, ${y}, ${tileAt(x, y, tile)}: ${(diverging ? signed : si)(value, unit)} (${name}${between})`;
  }
  const view = stage({ ...block, picture: block.a, about: "Map of differences" }, {
    probed(x, y, value) {
      colours?.point(value ?? null);
      readout.textContent = x === null || value === null || value === undefined ? hint : words(x, y, value);
      follow(() => view)(x, y);
    },
  });
  linked.push(view);
  const pick = choice("of", block.grids.map((g) => ({ value: g.id, name: g.name })), layer().id,
    (value) => state.set({ map: value === block.grids[0].id ? "" : value }));
  async function show() {
    pick.show(layer().id);
    const of = layer();
    const map = await view.show(of, OPACITY);
    colours = colourBar(of.of ? { ...of, name: `${of.name}: ${second} less ${first}` } : of, map);
    bar.replaceChildren(colours);
    view.dataset.shown = of.id;
    readout.textContent = hint;
  }
  state.listen("map", show);
  show();
  const column = (g, field, title, values) => ({ field: `${g.id}.${field}`, title: `${g.name}, ${title}`, unit: g.unit, values });
  const data = tileRows(block.grids.filter((g) => g.of), block.width,
    (g) => [column(g, "a", first, g.of[0]), column(g, "b", second, g.of[1]), column(g, "difference", "difference", g.values)]);
  return frame({ id: "differences", type: "map", title: "Differences by tile" },
    h("div", { class: "drawing" }, view, bar, readout), { data: data ?? undefined, more: [pick] });
}
