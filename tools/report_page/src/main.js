// Draws the page from its data.
import { h, choice } from "./dom.js";
import * as charts from "./chart.js";
import { flow } from "./sankey.js";
import { picture } from "./picture.js";
import { film } from "./film.js";
import { pair } from "./pair.js";
import { parallel, pointsTable, scatter } from "./points.js";
import { series } from "./series.js";
import { headlines } from "./headlines.js";
import { frame } from "./block.js";
import { diffViews } from "./diff.js";
import { runView } from "./run.js";
import { sweepView } from "./sweep.js";
import { sortableTable } from "./table.js";
import { workloadBars } from "./workloads.js";
import { readLibraries } from "./lib.js";
import * as state from "./state.js";
import * as theme from "./theme.js";

const { kind, title, data } = JSON.parse(document.getElementById("data").textContent);
const views = kind === "run" ? [runView(data)] : kind === "sweep" ? [sweepView(data)] : diffViews(data);
globalThis.raywattPage = { kind, title, views };  // for tests
const page = document.getElementById("page");

const LONG = 12;  // number of rows above which a table has a filter

function tableBlock(block, data) {
  const { element } = sortableTable(block, data, { filter: data.rows.length > LONG });
  const figure = frame(block, element, { data, table: true });
  if (!block.folded) return figure;
  return h("details", {}, h("summary", {}, block.title), figure);
}

const DRAWERS = {
  text: (block) => h("p", {}, block.text),
  chart: (block, data) => charts.chart(block, data),
  table: tableBlock,
  sankey: flow,
  picture,
  film,
  pair,
  scatter,
  series,
  points: pointsTable,
  parallel,
  workloads: workloadBars,
};

function section(part, view) {
  return h("section", { id: part.id, tabindex: "-1", "aria-labelledby": `title-${part.id}` },
    h("h2", { id: `title-${part.id}` }, part.title),
    part.lead && h("p", { class: "lead" }, part.lead),
    part.blocks.map((block) => DRAWERS[block.type](block, view.data[block.data], view.data)));
}

export function go(id) {
  const target = document.getElementById(id) ?? document.querySelector(`[data-block="${CSS.escape(id)}"]`);
  target?.scrollIntoView();
  target?.focus?.({ preventScroll: true });
}

const link = (words, id) => h("a", { href: `#${id}`, onclick: (event) => { event.preventDefault(); state.set({ at: id }); } }, words);

function verdict(view) {
  const { sentence, more, links } = view.verdict;
  return h("div", { class: "verdict" }, h("p", { class: "sentence" }, sentence),
    h("p", {}, more, more ? " " : "", "Evidence: ", links.flatMap(({ words, to }, i) => [i ? ", " : "", link(words, to)]), "."));
}

function draw() {
  state.freshView();
  theme.freshView();
  charts.freshView();
  const index = Math.min(Number(state.get("view", "0")) || 0, views.length - 1);
  const view = views[index];
  const pairs = views.length > 1 &&
    choice("Pair", views.map((v, i) => ({ value: String(i), name: v.name })), String(index), (value) => state.set({ view: value === "0" ? "" : value }));
  page.replaceChildren(
    h("header", {},
      h("div", { class: "top" }, h("h1", {}, title), h("div", { class: "tools" }, pairs,
        choice("Theme", theme.choices, state.get("theme"), (value) => state.set({ theme: value })))),
      view.facts.length > 0 && h("dl", { class: "facts" }, view.facts.map((f) => h("div", {}, h("dt", {}, f.name), h("dd", {}, f.value)))),
      h("nav", { "aria-label": "Parts of this page" }, view.sections.map((part) => link(part.id[0].toUpperCase() + part.id.slice(1), part.id)))),
    h("main", {},
      view.verdict && verdict(view),
      view.notices.length > 0 && h("ul", { class: "notices", "aria-label": "Notices" }, view.notices.map((n) => h("li", {}, n))),
      headlines(view.headlines),
      view.sections.map((part) => section(part, view))));
  charts.drawRest();
}

state.listen("view", draw);
state.listen("at", (id) => id && go(id));
draw();
readLibraries();
if (state.get("at")) requestAnimationFrame(() => go(state.get("at")));
