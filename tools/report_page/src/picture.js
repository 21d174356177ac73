// The picture of a run with overlays to choose from, a colour bar and a probe.
import { h, choice } from "./dom.js";
import { frame } from "./block.js";
import { colourBar } from "./colours.js";
import { digits, si } from "./format.js";
import { stage } from "./stage.js";
import * as link from "./link.js";
import * as state from "./state.js";

const NONE = { value: "", name: "none" };

export function picture(block) {
  const layers = [...block.grids, ...block.overlays];
  const readout = h("output", { class: "readout", "aria-live": "off" }, "Point at the picture, or move the probe by arrow keys.");
  const bar = h("div", { class: "bar" });
  const times = block.times;
  const tile = times?.side ?? block.grids.find((g) => g.tile)?.tile;
  if (times) link.know(times);
  let layer = null, colours = null;

  const view = stage(block, {
    probed(x, y, value) {
      colours?.point(value ?? null);
      if (x === null) readout.textContent = "Point at the picture, or move the probe by arrow keys.";
      else readout.textContent = words(x, y, value);
      if (tile) link.point(x === null ? null : tileAt(x, y));
    },
    chosen: (x, y) => tile && link.choose(tileAt(x, y)),
  });
  const columns = tile && Math.ceil(block.width / tile);
  const tileAt = (x, y) => Math.floor(y / tile) * columns + Math.floor(x / tile);

  function words(x, y, value) {
    const where = `pixel ${x}, ${y}` + (tile ? `, tile ${Math.floor(x / tile)}, ${Math.floor(y / tile)}` : "");
    if (!layer || layer.picture) return where + when(x, y);
    return `${where}: ${value === null || value === undefined ? "no value" : si(value, layer.unit)} (${layer.name})${when(x, y)}`;
  }
  /** When the tile of a pixel was in flight. */
  function when(x, y) {
    if (!times) return "";
    const i = tileAt(x, y);
    return times.begin_us[i] === null ? "" : `; core ${times.core[i]}, ${digits(times.begin_us[i])} to ${digits(times.end_us[i])} us`;
  }

  async function show() {
    layer = layers.find((l) => l.id === state.get("overlay")) ?? null;
    overlays.querySelector("select").value = layer?.id ?? "";
    opacity.hidden = !layer || Boolean(layer.picture);
    const map = await view.show(layer, Number(slider.value) / 100);
    colours = map ? colourBar(layer, map) : null;
    bar.replaceChildren(...(colours ? [colours] : []));
    view.dataset.shown = layer?.id ?? "";
  }

  const overlays = choice("Overlay", [NONE, ...layers.map((l) => ({ value: l.id, name: l.name }))], state.get("overlay"),
    (value) => { state.set({ overlay: value }, show); show(); });
  const slider = h("input", { type: "range", min: 0, max: 100, value: state.get("opacity", "85"), id: "opacity",
    oninput: () => { state.set({ opacity: slider.value === "85" ? "" : slider.value }); view.show(layer, Number(slider.value) / 100); } });
  const opacity = h("span", { class: "choice" }, h("label", { for: "opacity" }, "opacity"), slider);
  state.listen("overlay", show);
  link.listenLit((tiles) => view.light(tiles, tile));

  const body = h("div", { class: "drawing" }, view, bar, readout);
  const figure = frame(block, body, { more: layers.length > 0 ? [overlays, opacity] : [] });
  if (block.note) body.append(h("p", { class: "note" }, block.note));
  show();
  return figure;
}
