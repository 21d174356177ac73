// Metrics of machines on each workload of a set: bars of the best machine and of the chosen one.
import { h, choice } from "./dom.js";
import { frame } from "./block.js";
import { drawn, whenNear } from "./chart.js";
import { records, saveSpec } from "./files.js";
import { shown } from "./format.js";
import { chosenRow } from "./points.js";
import * as state from "./state.js";

const ACCENT = "#1f5fa8", WAIT = "#b85c12", TEXT = "#1c2733";

export function workloadBars(block, data) {
  const points = records(data);
  const figure = () => block.figures.find((f) => f.name === state.get("on")) ?? block.figures[0];
  const body = h("div", { class: "drawing", "data-about": block.about });
  const machines = () => [block.best, chosenRow()].filter((row, i, all) => row !== null && row !== undefined && all.indexOf(row) === i);
  const nameOf = (row) => `machine ${points[row].n}${row === block.best ? ", the best" : ", chosen"}`;

  function rows() {
    const { fields, show, unit } = figure();
    return machines().flatMap((row) => block.names.map((workload, w) => {
      const value = points[row][fields[w]];
      return { workload, machine: nameOf(row), value, label: shown(value, { show, unit }) };
    })).filter((r) => typeof r.value === "number");
  }
  const spec = () => ({
    $schema: "https://vega.github.io/schema/vega-lite/v6.json", description: block.about, width: "container",
    height: { step: 22 }, autosize: { type: "fit-x", contains: "padding" },
    encoding: {
      y: { field: "workload", type: "nominal", sort: null, title: null, axis: { labelLimit: 250, ticks: false, domain: false } },
      yOffset: { field: "machine", type: "nominal", sort: null },
      x: { field: "value", type: "quantitative", title: `${figure().name}${figure().unit ? `, ${figure().unit}` : ""}`, scale: { zero: true, nice: true } },
    },
    layer: [
      { mark: { type: "bar", height: { band: 0.8 } },
        encoding: {
          color: { field: "machine", type: "nominal", sort: null, title: null, scale: { range: [ACCENT, WAIT] }, legend: { orient: "bottom", symbolType: "square" } },
          tooltip: [{ field: "machine", title: " " }, { field: "workload", title: "workload" }, { field: "label", title: figure().name }] } },
      { mark: { type: "text", align: "left", dx: 5, dy: 3, color: TEXT }, encoding: { text: { field: "label" } } },
    ],
  });
  const table = () => ({
    columns: [{ field: "workload", title: "workload", show: "text" }, { field: "machine", title: "machine", show: "text" },
      { field: "value", title: figure().name, show: figure().show, unit: figure().unit }],
    rows: rows().map((r) => [r.workload, r.machine, r.value]),
  });
  let drawing = null;
  const pick = choice("figure", block.figures.map((f) => ({ value: f.name, name: f.name })), figure().name, (value) => state.set({ on: value === block.figures[0].name ? "" : value }));
  const save = h("button", { type: "button", "aria-label": `${block.title}: Vega-Lite specification`,
    onclick: () => { const values = rows(); saveSpec(block.id, spec(), { columns: Object.keys(values[0] ?? {}).map((field) => ({ field })), rows: values.map(Object.values) }); } }, "Vega-Lite");
  const shownFigure = frame(block, body, { data: table, more: [pick, save] });
  for (const key of ["on", "point"]) state.listen(key, () => { pick.show(figure().name); shownFigure.refresh(); drawing?.draw(); });
  whenNear(shownFigure, () => { drawing = drawn(body, spec, rows); });
  return shownFigure;
}
