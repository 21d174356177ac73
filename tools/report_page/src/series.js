// Metrics over time, one group at a time. A brush highlights tiles of the picture; the tile under the pointer is marked.
import { h, choice } from "./dom.js";
import { frame } from "./block.js";
import { whenNear, drawn } from "./chart.js";
import { records, saveSpec } from "./files.js";
import { digits } from "./format.js";
import { specOf } from "./specs.js";
import * as link from "./link.js";
import * as state from "./state.js";

const span = () => {
  const [from, to] = state.get("time").split("-").map(Number);
  return Number.isFinite(from) && Number.isFinite(to) && to > from ? [from, to] : null;
};

/** Returns two number fields for the ends of the brush, for use with the keyboard. */
function ends(end, change) {
  const input = (label) => h("input", { type: "number", min: 0, max: end, step: "any", "aria-label": label, onchange: () => change() });
  const from = input("Brush from, us"), to = input("Brush to, us");
  const element = h("span", { class: "choice ends-of-time" }, "brush", from, "to", to, "us");
  element.span = () => (from.value === "" && to.value === "" ? null : [Number(from.value || 0), Number(to.value || end)]);
  element.show = (of) => [from, to].forEach((each, i) => (each.value = of ? digits(of[i]) : ""));
  return element;
}

export function series(block, _, all) {
  const body = h("div", { class: "drawing" });
  const readout = h("output", { class: "readout" });
  const chart = () => block.charts.find((c) => c.id === state.get("series")) ?? block.charts[0];
  const data = () => all[chart().data];
  const end = Math.max(...records(all[block.charts[0].data]).map((row) => row.end_us));
  let view = null, drawing = null;

  /** Returns the specification of the chart with a brush and a band for the tile under the pointer. */
  function spec() {
    const { encoding, mark, transform, ...rest } = specOf(chart().chart, chart().about);
    const brush = { name: "brush", select: { type: "interval", encodings: ["x"] } };
    if (span()) brush.value = { x: span() };
    return {
      ...rest,
      layer: [
        { params: [brush], transform, mark, encoding },
        { data: { name: "pointed" }, mark: { type: "rect", color: "#1c2733", opacity: 0.22 },
          encoding: { x: { field: "from", type: "quantitative" }, x2: { field: "to" } } },
      ],
    };
  }
  const setTime = (of, from) => {
    const time = of && of[1] > of[0] ? of.map(digits).join("-") : "";
    if (time !== state.get("time")) state.set({ time }, from);
    update(null);
  };
  const brushed = (_, value) => setTime(value?.begin_us, redraw);
  const times = ends(end, () => setTime(times.span()));
  function update(tile) {
    const of = link.spanOf(tile);
    link.brush(span());
    times.show(span());
    readout.textContent = of ? `The tile that is pointed at: ${digits(of[0])} to ${digits(of[1])} us.`
      : span() ? "A click outside of the brush ends it." : "Drag over the chart to brush a stretch of time.";
  }
  function point(tile) {
    const of = link.spanOf(tile);
    view?.data("pointed", of ? [{ from: of[0], to: of[1] }] : []).runAsync();
    update(tile);
  }
  const redraw = () => {
    body.dataset.about = chart().about;
    pick.show(chart().id);
    drawing?.draw();
    update(null);
  };
  const pick = choice("Figure", block.charts.map((c) => ({ value: c.id, name: c.name })), chart().id,
    (value) => state.set({ series: value === block.charts[0].id ? "" : value }));
  const save = h("button", { type: "button", "aria-label": `${block.title}: Vega-Lite specification`, onclick: () => saveSpec(chart().id, specOf(chart().chart, chart().about), data()) }, "Vega-Lite");
  const figure = frame(block, h("div", {}, body, h("div", { class: "under" }, readout, times)), { data, name: () => chart().data, more: [pick, save] });
  state.listen("series", () => { figure.refresh(); redraw(); });
  state.listen("time", redraw);
  link.listenPointed(point);
  body.dataset.about = chart().about;
  update(null);
  whenNear(figure, () => {
    drawing = drawn(body, spec, () => records(data()), (drawnView) => {
      view = drawnView;
      view.addSignalListener("brush", brushed);
    }, { pointed: [] });
  });
  return figure;
}
