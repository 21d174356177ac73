// The flow of energy from the total through blocks to events, clock and leakage.
import { h, s, switches } from "./dom.js";
import { frame } from "./block.js";
import { digits, percent } from "./format.js";
import { records } from "./files.js";
import { LETTER, NARROW } from "./fit.js";
import { libraries } from "./lib.js";
import * as state from "./state.js";
import * as theme from "./theme.js";

const BLOCKS = ["#2b6cb0", "#b85c12", "#17736d", "#6b4a95", "#63a0d8", "#4aa89a", "#a184c2", "#b3446c"];
const RESTS = { clock: "#e0964a", leakage: "#8a9099" };
const SIDES = [{ value: "low", name: "low" }, { value: "nominal", name: "nominal" }, { value: "high", name: "high" }];
const ROW = 16, FLOW = 230;  // height of a label; height of all flows together
const NODE = 10, GAP = 5;  // width of a node; gap before its label
const THREE_COLUMNS = 700;  // width from which total, blocks and events have a column each
const LEAST = 300;  // width below which the drawing is scaled down

export function flow(block, data) {
  const links = records(data);
  const body = h("div", { class: "drawing sankey-drawing" });
  const side = () => state.get("side", "nominal");
  const buttons = switches("Energy tables", SIDES, side(), (value) => state.set({ side: value === "nominal" ? "" : value }));
  const figure = frame(block, body, { data, more: [buttons] });

  async function show() {
    const library = await libraries;
    const width = Math.max(body.clientWidth || 900, LEAST);
    body.replaceChildren(drawing(library, links, side(), width, block.about));
  }
  state.listen("side", () => {
    buttons.press(side());
    show();
  });
  theme.listen(show);
  new ResizeObserver(show).observe(figure);
  return figure;
}

const wordsOf = (name) => (name.includes(": ") ? name.split(": ").slice(1).join(": ") : name);

/** Draws the flow of energy. If the width is too small for three columns, the total is a line above its blocks. */
function drawing({ sankey, sankeyLinkHorizontal, sankeyJustify }, all, side, width, about) {
  const hasWhole = width >= THREE_COLUMNS;
  const every = all.filter((l) => l[side] > 0).map((l) => ({ source: l.from, target: l.to, value: l[side] }));
  const root = every.find((l) => !every.some((other) => other.target === l.source))?.source;
  const into = new Map(every.map(({ target }) => [target, every.filter((l) => l.target === target).reduce((sum, l) => sum + l.value, 0)]));
  const blocks = every.filter((l) => l.source === root).sort((a, b) => b.value - a.value).map((l) => l.target);
  const total = blocks.reduce((sum, name) => sum + into.get(name), 0);
  const rank = new Map(blocks.map((name, i) => [name, i]));
  const parent = new Map(every.map((l) => [l.target, l.source]));
  /** Returns the sort key of a node: blocks by size, their events in the same order, then clock and leakage. */
  function order({ name }) {
    if (name in RESTS) return 1e6 + Object.keys(RESTS).indexOf(name);
    if (rank.has(name)) return rank.get(name);
    return 1000 * (rank.get(parent.get(name)) ?? 0) + (name.endsWith("other events") ? 999 : 500 - 400 * (into.get(name) / total));
  }
  const isInner = (name) => name === root || rank.has(name);
  const label = (name) => {
    const share = percent((into.get(name) ?? total) / total);
    if (width < NARROW) return `${wordsOf(name)}  ${share}`;
    const value = name === root ? digits(total) : Number(into.get(name).toPrecision(3));
    return `${wordsOf(name)}  ${value} mJ, ${share}`;
  };
  const links = hasWhole ? every : every.filter((l) => l.source !== root);
  const names = [...new Set(links.flatMap((l) => [l.source, l.target]))];
  const ends = names.filter((name) => !isInner(name));
  const right = GAP + LETTER * Math.max(0, ...ends.map((name) => label(name).length));
  const top = hasWhole ? 6 : 2 * ROW;
  const height = top + ends.length * ROW + FLOW;
  const graph = sankey().nodeId((n) => n.name).nodeAlign(sankeyJustify).nodeWidth(NODE).nodePadding(ROW - 2)
    .nodeSort((a, b) => order(a) - order(b)).extent([[2, top], [width - right, height - 6]])({
      nodes: names.map((name) => ({ name })), links,
    });
  const colourOf = (name) => theme.colour(name === root ? "#8a9099" : RESTS[name] ?? BLOCKS[(rank.get(name) ?? rank.get(parent.get(name)) ?? 0) % BLOCKS.length]);
  const path = sankeyLinkHorizontal();
  return s("svg", { width, height, viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${about}, ${side} tables` },
    !hasWhole && s("text", { x: 2, y: ROW }, `${root}  ${digits(total)} mJ`),
    graph.links.map((link) => s("path", { d: path(link), fill: "none", stroke: colourOf(link.source.name === root ? link.target.name : link.source.name),
      "stroke-opacity": 0.28, "stroke-width": Math.max(0.7, link.width) },
    s("title", {}, `${link.source.name} → ${link.target.name}: ${digits(link.value)} mJ`))),
    graph.nodes.map((node) => s("rect", { x: node.x0, y: node.y0, width: node.x1 - node.x0, height: Math.max(1, node.y1 - node.y0), fill: colourOf(node.name) },
      s("title", {}, `${node.name}: ${digits(node.value)} mJ`))),
    graph.nodes.map((node) => s("text", { x: node.x1 + GAP, y: (node.y0 + node.y1) / 2, dy: "0.35em" }, label(node.name))));
}
