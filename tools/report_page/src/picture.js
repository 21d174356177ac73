// The picture of a run with a choice of overlays, a colour bar and a probe.
import { h, choice } from "./dom.js";
import { frame } from "./block.js";
import { colourBar } from "./colours.js";
import { digits, si } from "./format.js";
import { stage } from "./stage.js";
import { tileAt, tileRows } from "./tiles.js";
import * as link from "./link.js";
import * as state from "./state.js";

const HINT = "Point at the picture, or move the probe by arrow keys.";
const OPACITY = "85";  // percent

/** Returns the overlays of a picture in groups, for a select box. */
function choices(block) {
  const named = (layers) => layers.map((l) => ({ value: l.id, name: l.name }));
  const groups = [
    { name: "by tile", choices: named(block.grids.filter((g) => g.tile)) },
    { name: "by pixel", choices: named(block.grids.filter((g) => !g.tile)) },
    { name: "debug pictures", choices: named(block.overlays) }];
  return [{ value: "", name: "none" }, ...groups.filter((g) => g.choices.length > 0)];
}

export function picture(block) {
  const layers = [...block.grids, ...block.overlays];
  const readout = h("output", { class: "readout", "aria-live": "off" }, HINT);
  const bar = h("div", { class: "bar" });
  const times = block.times;
  const side = times?.side ?? block.grids.find((g) => g.tile)?.tile;
  if (times) link.setTimes(times);
  let layer = null, colours = null;

  const view = stage(block, {
    probed(x, y, value) {
      colours?.point(value ?? null);
      readout.textContent = x === null ? HINT : words(x, y, value);
      if (side) link.point(x === null ? null : indexAt(x, y));
    },
  });
  const columns = side && Math.ceil(block.width / side);
  const indexAt = (x, y) => Math.floor(y / side) * columns + Math.floor(x / side);

  function words(x, y, value) {
    const where = `pixel ${x}, ${y}` + (side ? `, ${tileAt(x, y, side)}` : "");
    if (!layer || layer.picture) return where + when(x, y);
    return `${where}: ${value === null || value === undefined ? "no value" : si(value, layer.unit)} (${layer.name})${when(x, y)}`;
  }
  /** Returns a text with the core and the time of the tile that contains a pixel. */
  function when(x, y) {
    if (!times) return "";
    const i = indexAt(x, y);
    return times.begin_us[i] === null ? "" : `; core ${times.core[i]}, ${digits(times.begin_us[i])} to ${digits(times.end_us[i])} us`;
  }

  async function show() {
    const now = (layer = layers.find((l) => l.id === state.get("overlay")) ?? null);
    overlays.show(layer?.id ?? "");
    slider.value = state.get("opacity", OPACITY);
    opacity.hidden = !layer || Boolean(layer.picture);
    const map = await view.show(layer, Number(slider.value) / 100);
    if (layer !== now) return;  // another overlay was chosen in the meantime
    colours = map ? colourBar(layer, map) : null;
    bar.replaceChildren(...[colours, layer?.note && h("p", { class: "note" }, layer.note)].filter(Boolean));
    view.dataset.shown = layer?.id ?? "";
  }

  const overlays = choice("Overlay", choices(block), state.get("overlay"), (value) => state.set({ overlay: value }));
  const slider = h("input", { type: "range", min: 0, max: 100, id: "opacity",
    oninput: () => state.set({ opacity: slider.value === OPACITY ? "" : slider.value }) });
  const opacity = h("span", { class: "choice" }, h("label", { for: "opacity" }, "opacity"), slider);
  state.listen("overlay", show);
  state.listen("opacity", () => {
    slider.value = state.get("opacity", OPACITY);
    view.fade(Number(slider.value) / 100);
  });
  link.listenLit((tiles) => view.light(tiles, side));

  const data = tileRows(block.grids, block.width, (g) => [{ field: g.id, title: g.name, unit: g.unit, values: g.values }]);
  const figure = frame(block, h("div", { class: "drawing" }, view, bar, readout),
    { data: data ?? undefined, more: layers.length > 0 ? [overlays, opacity] : [] });
  if (block.note) figure.append(h("p", { class: "note" }, block.note));
  show();
  return figure;
}
