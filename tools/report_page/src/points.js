// The points of a sweep: a scatter of any two metrics with its front, a table, parallel axes, and a selected point.
import { h, choice } from "./dom.js";
import { frame } from "./block.js";
import { drawn, whenNear } from "./chart.js";
import { records, saveSpec } from "./files.js";
import { shown } from "./format.js";
import { capital } from "./model.js";
import { sortableTable } from "./table.js";
import * as state from "./state.js";

const ACCENT = "#1f5fa8", REST = "#8a9099", INK = "#1c2733", WAIT = "#b85c12", GROUND = "#ffffff";

/**
 * Returns the Pareto front of two metrics: indices of points, the best x first. Points that violate a constraint are
 * excluded.
 */
export function frontOf(points, x, y) {
  const better = (metric, a, b) => (metric.more ? a > b : a < b);
  const rows = points.map((p, i) => ({ i, x: p[x.field], y: p[y.field] }))
    .filter((p) => typeof p.x === "number" && typeof p.y === "number" && points[p.i].constraints !== "broken");
  rows.sort((a, b) => (a.x !== b.x ? (better(x, a.x, b.x) ? -1 : 1) : a.y === b.y ? 0 : better(y, a.y, b.y) ? -1 : 1));
  const front = [];
  let last = null;
  for (const p of rows) {
    if (!last || (p.x === last.x && p.y === last.y) || better(y, p.y, last.y)) {
      front.push(p.i);
      last = p;
    }
  }
  return front;
}

const listeners = [];
export const chosenRow = () => (state.get("point") === "" ? null : Number(state.get("point")));
function choose(i) {
  state.set({ point: i === chosenRow() ? "" : String(i) });
}

let left = null;  // rows that pass the table's filter; null: all
const filterListeners = [];

const named = (metric) => (metric.unit ? `${metric.name}, ${metric.unit}` : metric.name);

export function scatter(block, data) {
  const points = records(data);
  const metric = (field) => block.metrics.find((m) => m.field === field) ?? block.metrics[0];
  const x = () => metric(state.get("x", block.start.x)), y = () => metric(state.get("y", block.start.y));
  const body = h("div", { class: "drawing", "data-about": block.about });
  const choices = block.metrics.map((m) => ({ value: m.field, name: m.name }));
  const by = () => block.axes.find((a) => a.field === state.get("by")) ?? null;

  function rows() {
    const isStart = x().field === block.start.x && y().field === block.start.y;
    const front = new Set(isStart ? block.start.front : frontOf(points, x(), y()));
    const near = new Set(isStart ? block.start.near : []);
    return points.map((p, i) => ({
      row: i, n: p.n, x: p[x().field], y: p[y().field], by: by() ? String(p[by().field]) : "",
      place: front.has(i) ? "on the front" : near.has(i) ? "near it, within noise" : "other",
      chosen: i === chosenRow(), axes: block.axes.map((a) => `${a.field} ${p[a.field]}`).join(", "),
    })).filter((p) => typeof p.x === "number" && typeof p.y === "number" && (!left || left.has(p.row)));
  }
  function spec() {
    const axis = (field, metric) => ({ field, type: "quantitative", title: `${named(metric)} (${metric.more ? "more" : "less"} is better)`, scale: { zero: false, nice: true } });
    const colour = by()
      ? { field: "by", type: "ordinal", title: by().field, sort: by().levels, scale: { scheme: "viridis" }, legend: { orient: "bottom", symbolType: "circle" } }
      : { field: "place", type: "nominal", title: null, scale: { domain: ["on the front", "near it, within noise", "other"], range: [ACCENT, WAIT, REST] }, legend: { orient: "bottom", symbolType: "circle" } };
    return {
      $schema: "https://vega.github.io/schema/vega-lite/v6.json", description: block.about, width: "container", height: 340,
      autosize: { type: "fit-x", contains: "padding" },
      encoding: { x: axis("x", x()), y: axis("y", y()) },
      layer: [
        { transform: [{ filter: "datum.place === 'on the front'" }], mark: { type: "line", color: ACCENT, strokeWidth: 1.2, opacity: 0.6, interpolate: (x().more === y().more) === x().more ? "step-before" : "step-after" }, encoding: { order: { field: "x" } } },
        { mark: { type: "point", filled: true, cursor: "pointer" },
          encoding: { color: colour, opacity: { value: 0.92 },
            size: { condition: { test: "datum.place === 'on the front'", value: 90 }, value: 42 },
            tooltip: [{ field: "n", title: block.noun }, { field: "x", title: x().name, format: ".4~g" }, { field: "y", title: y().name, format: ".4~g" }, { field: "axes", title: "axes" }] } },
        { transform: [{ filter: "datum.chosen" }], mark: { type: "point", size: 260, strokeWidth: 2, color: INK } },
      ],
    };
  }
  /** Returns the points in the scatter plot, for the table and the download. */
  function shownRows() {
    const both = [["x", x()], ["y", y()]].map(([field, m]) => ({ ...data.columns.find((c) => c.field === m.field), field }));
    const columns = [{ field: "n", title: block.noun, show: "number" }, ...both, { field: "place", title: "place", show: "text" }, { field: "axes", title: "axes", show: "text" }];
    return { columns, rows: rows().map((row) => columns.map((c) => row[c.field])) };
  }
  let drawing = null;
  const again = () => {
    figure.refresh();
    drawing?.draw();
  };
  const pick = (label, key, of) => choice(label, choices, of().field, (value) => { state.set({ [key]: value === block.start[key] ? "" : value }); });
  const pickX = pick("x", "x", x), pickY = pick("y", "y", y);
  const pickBy = choice("colour", [{ value: "", name: "front" }, ...block.axes.map((a) => ({ value: a.field, name: a.field }))], state.get("by"), (value) => state.set({ by: value }));
  const save = h("button", { type: "button", "aria-label": `${block.title}: Vega-Lite specification`,
    onclick: () => { const values = rows(); saveSpec(block.id, spec(), { columns: Object.keys(values[0] ?? {}).map((field) => ({ field })), rows: values.map(Object.values) }); } }, "Vega-Lite");
  for (const key of ["x", "y", "by"]) state.listen(key, () => { pickX.show(x().field); pickY.show(y().field); pickBy.show(by()?.field ?? ""); again(); });
  listeners.push(again);
  filterListeners.push(again);
  const figure = frame(block, body, { data: shownRows, more: [pickX, pickY, pickBy, save] });
  figure.append(details(block, data, points));
  whenNear(figure, () => {
    drawing = drawn(body, spec, rows, (view) => view.addEventListener("click", (event, item) => item?.datum?.row !== undefined && choose(item.datum.row)));
  });
  figure.front = () => frontOf(points, x(), y());
  return figure;
}

/** Returns a box that shows the values and the command of the chosen point. */
function details(block, data, points) {
  const box = h("div", { class: "details", role: "status" });
  function show() {
    const p = points[chosenRow() ?? -1];
    if (!p) return box.replaceChildren(h("p", { class: "note" }, `No ${block.noun} is chosen.`));
    const copy = h("button", { type: "button", onclick: async () => { await navigator.clipboard?.writeText(p.command); copy.textContent = "Copied"; } }, "Copy");
    const items = [...block.axes.map((a) => [a.field, p[a.field]]), ...block.metrics.map((m) => [m.name, shown(p[m.field], data.columns.find((c) => c.field === m.field))])];
    box.replaceChildren(h("h4", {}, `${capital(block.noun)} ${p.n}`),
      h("dl", {}, items.map(([name, value]) => h("div", {}, h("dt", {}, name), h("dd", {}, value)))),
      p.error && h("p", {}, p.error),
      h("p", { class: "command" }, h("code", {}, p.command), " ", copy));
  }
  state.listen("point", () => { show(); listeners.forEach((listener) => listener()); });
  show();
  return box;
}

export function pointsTable(block, data) {
  const hidden = new Set(["command"]);
  if (data.rows.every((row) => !row[data.columns.findIndex((c) => c.field === "error")])) hidden.add("error");
  let table = null, waiting = 0;
  table = sortableTable(block, data, {
    filter: true, hidden, chosen: choose,
    filtered: (rows) => { left = rows.size === data.rows.length ? null : rows; table?.mark(chosenRow()); clearTimeout(waiting); waiting = setTimeout(() => filterListeners.forEach((l) => l()), 150); },
  });
  state.listen("point", () => table.mark(chosenRow()));
  table.mark(chosenRow());
  return frame(block, table.element, { data, table: true });
}

export function parallel(block, data) {
  const points = records(data);
  const body = h("div", { class: "drawing", "data-about": block.about });
  const shownMetrics = block.metrics.slice(0, 4);
  const front = new Set(frontOf(points, block.metrics.find((m) => m.field === block.start.x), block.metrics.find((m) => m.field === block.start.y)));
  const names = [...block.axes.map((a) => a.field), ...shownMetrics.map((m) => named(m))];
  const spread = shownMetrics.map((m) => {
    const values = points.map((p) => p[m.field]).filter((v) => typeof v === "number");
    return [Math.min(...values), Math.max(...values)];
  });
  function rows() {
    return points.flatMap((p, i) => {
      if (left && !left.has(i)) return [];
      const kind = i === chosenRow() ? "chosen" : front.has(i) ? "on the front" : "other";
      const at = (axis, share, value) => ({ row: i, n: p.n, axis, share, value: String(value), kind });
      return [
        ...block.axes.map((a) => at(a.field, a.levels.length < 2 ? 0.5 : a.levels.indexOf(String(p[a.field])) / (a.levels.length - 1), p[a.field])),
        ...shownMetrics.flatMap((m, k) => (typeof p[m.field] === "number" ? [at(named(m), spread[k][1] === spread[k][0] ? 0.5 : (p[m.field] - spread[k][0]) / (spread[k][1] - spread[k][0]), shown(p[m.field], { show: "number" }))] : [])),
      ];
    });
  }
  const ends = [
    ...block.axes.flatMap((a) => a.levels.map((level, i) => ({ axis: a.field, share: a.levels.length < 2 ? 0.5 : i / (a.levels.length - 1), text: level }))),
    ...shownMetrics.flatMap((m, k) => [0, 1].map((e) => ({ axis: named(m), share: e, text: shown(spread[k][e], { show: "number" }) }))),
  ];
  /** Names of axes are horizontal, or slanted if there is no room. */
  const heads = () => (body.clientWidth > 115 * names.length ? { labelAngle: 0, labelLimit: 150, labelPadding: 14 }
    : { labelAngle: -50, labelAlign: "left", labelLimit: 130, labelPadding: 16 });
  const spec = () => ({
    $schema: "https://vega.github.io/schema/vega-lite/v6.json", description: block.about, width: "container", height: 300,
    autosize: { type: "fit-x", contains: "padding" },
    encoding: {
      x: { field: "axis", type: "nominal", sort: names, title: null, axis: { orient: "top", ...heads(), domain: false, ticks: false, grid: true, labelFontWeight: 600 }, scale: { padding: 0.35 } },
      y: { field: "share", type: "quantitative", axis: null, scale: { domain: [-0.03, 1.03] } },
    },
    layer: [
      ...["other", "on the front", "chosen"].map((kind) => ({
        transform: [{ filter: `datum.kind === '${kind}'` }],
        mark: { type: "line", cursor: "pointer", strokeWidth: { other: 1, chosen: 3.5 }[kind] ?? 1.6,
          opacity: { other: Math.max(0.25, Math.min(0.6, 20 / points.length)), chosen: 1 }[kind] ?? Math.max(0.5, Math.min(0.95, 20 / front.size)) },
        encoding: {
          detail: { field: "row" },
          color: { field: "kind", type: "nominal", title: null, scale: { domain: ["other", "on the front", "chosen"], range: [REST, ACCENT, WAIT] }, legend: { orient: "bottom", symbolType: "stroke", symbolOpacity: 1, symbolStrokeWidth: 2 } },
          tooltip: [{ field: "n", title: block.noun }],
        } })),
      ...[{ stroke: GROUND, strokeWidth: 3.5, strokeJoin: "round" }, {}].map((halo) => (
        { data: { values: ends }, mark: { type: "text", align: "left", dx: 6, dy: -6, color: INK, fontSize: 11, ...halo }, encoding: { text: { field: "text" } } })),
    ],
  });
  const save = h("button", { type: "button", "aria-label": `${block.title}: Vega-Lite specification`,
    onclick: () => { const values = rows(); saveSpec(block.id, spec(), { columns: Object.keys(values[0] ?? {}).map((field) => ({ field })), rows: values.map(Object.values) }); } }, "Vega-Lite");
  let drawing = null;
  const again = () => drawing?.draw();
  listeners.push(again);
  filterListeners.push(again);
  const figure = frame(block, body, { data, more: [save] });
  whenNear(figure, () => {
    drawing = drawn(body, spec, rows, (view) => view.addEventListener("click", (event, item) => item?.datum?.row !== undefined && choose(item.datum.row)));
  });
  return figure;
}
