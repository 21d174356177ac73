// Headline figures with their bands.
import { h } from "./dom.js";
import { shown } from "./format.js";

export function headlines(figures) {
  if (figures.length === 0) return null;
  return h("dl", { class: "headlines" }, figures.map((f) => {
    const number = f.show === "si" || f.show === "percent" || typeof f.value !== "number" ? shown(f.value, f) : shown(f.value, { show: f.show }, false);
    const unit = f.show === "number" || typeof f.value !== "number" ? f.unit : "";
    return h("div", { "data-figure": f.id, title: f.note || null },
      h("dt", {}, f.name),
      h("dd", {}, h("span", { class: "value" }, number), unit && h("span", { class: "unit" }, unit),
        f.low !== null && f.high !== null && h("span", { class: "band" }, `${shown(f.low, { show: "number" })} to ${shown(f.high, { show: "number" })}`),
        f.note && h("span", { class: "note" }, f.note.replace(/^-/, "−"))));
  }));
}
