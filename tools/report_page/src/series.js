// Figures over time: a group at a time, brushed to light tiles of the picture, marked where a tile is pointed at.
import { h, choice } from "./dom.js";
import { frame } from "./block.js";
import { whenNear, drawn } from "./chart.js";
import { records, saveCsv, saveSpec } from "./files.js";
import { digits } from "./format.js";
import { plainTable } from "./table.js";
import * as link from "./link.js";
import * as state from "./state.js";

const span = () => {
  const [from, to] = state.get("time").split("-").map(Number);
  return Number.isFinite(from) && Number.isFinite(to) && to > from ? [from, to] : null;
};

export function series(block, _, all) {
  const body = h("div", { class: "drawing" });
  const readout = h("output", { class: "readout" });
  const chart = () => block.charts.find((c) => c.id === state.get("series")) ?? block.charts[0];
  const data = () => all[chart().data];
  let view = null, drawing = null, table = null;

  /** The chart's own marks, a brush, and a band for the tile that is pointed at. */
  function spec() {
    const { encoding, mark, transform, ...rest } = chart().spec;
    const brush = { name: "brush", select: { type: "interval", encodings: ["x"] } };
    if (span()) brush.value = { x: span() };
    return {
      ...rest, description: chart().about, autosize: { type: "fit-x", contains: "padding" },
      layer: [
        { params: [brush], transform, mark, encoding },
        { data: { name: "pointed" }, mark: { type: "rect", color: "#1c2733", opacity: 0.22 },
          encoding: { x: { field: "from", type: "quantitative" }, x2: { field: "to" } } },
      ],
    };
  }
  function brushed(_, value) {
    const now = value?.begin_us;
    const next = now && now[1] > now[0] ? `${digits(now[0])}-${digits(now[1])}` : "";
    if (next !== state.get("time")) state.set({ time: next });
    link.brush(span());
    tell(null);
  }
  function tell(tile) {
    const of = link.spanOf(tile);
    if (of) readout.textContent = `the tile that is pointed at: ${digits(of[0])} to ${digits(of[1])} us`;
    else readout.textContent = span() ? `brushed: ${digits(span()[0])} to ${digits(span()[1])} us. A click beside the brush ends it.` : "";
  }
  function point(tile) {
    const of = link.spanOf(tile);
    view?.data("pointed", of ? [{ from: of[0], to: of[1] }] : []).runAsync();
    tell(tile);
  }
  const again = () => { body.dataset.about = chart().about; pick.querySelector("select").value = chart().id; drawing?.draw(); if (table) refreshTable(); };
  const pick = choice("Figure", block.charts.map((c) => ({ value: c.id, name: c.name })), chart().id,
    (value) => state.set({ series: value === block.charts[0].id ? "" : value }));
  const asTable = h("button", { type: "button", "aria-pressed": "false", "aria-label": `${block.title}: as a table`, onclick: () => {
    if (table) { table.remove(); table = null; } else refreshTable();
    asTable.setAttribute("aria-pressed", String(Boolean(table)));
    body.hidden = Boolean(table);
  } }, "Table");
  function refreshTable() {
    table?.remove();
    figure.append((table = plainTable(chart().name, data())));
  }
  const save = [
    h("button", { type: "button", "aria-label": `${block.title}: Vega-Lite specification`, onclick: () => saveSpec(chart().id, chart().spec, data()) }, "Vega-Lite"),
    h("button", { type: "button", "aria-label": `${block.title}: CSV`, onclick: () => saveCsv(chart().id, data()) }, "CSV")];
  state.listen("series", again);
  link.listenPointed(point);
  const figure = frame(block, h("div", {}, body, readout), { more: [pick, asTable, ...save] });
  body.dataset.about = chart().about;
  whenNear(figure, () => {
    drawing = drawn(body, spec, () => records(data()), (drawnView) => {
      view = drawnView;
      view.addSignalListener("brush", brushed);
      link.brush(span());
      tell(null);
    }, { pointed: [] });
  });
  figure.brush = (from, to) => brushed("brush", { begin_us: [from, to] });
  return figure;
}
