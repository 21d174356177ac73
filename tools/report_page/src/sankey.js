// The flow of energy, from the whole through blocks to what they spent it on.
import { h, s, switches } from "./dom.js";
import { frame } from "./block.js";
import { digits, percent } from "./format.js";
import { records } from "./files.js";
import { libraries } from "./lib.js";
import * as state from "./state.js";
import * as theme from "./theme.js";

const BLOCKS = ["#2b6cb0", "#b85c12", "#17736d", "#6b4a95", "#63a0d8", "#4aa89a", "#a184c2"];
const RESTS = { clock: "#e0964a", leakage: "#8a9099" };
const SIDES = [{ value: "low", name: "low" }, { value: "nominal", name: "nominal" }, { value: "high", name: "high" }];
const ROW = 16, FLOW = 230;  // height of a label, and of all flows together

export function flow(block, data) {
  const links = records(data);
  const body = h("div", { class: "drawing sankey-drawing", tabindex: "0", role: "group", "aria-label": block.about });
  const side = () => state.get("side", "nominal");
  const buttons = switches("Energy tables", SIDES, side(), (value) => state.set({ side: value === "nominal" ? "" : value }));
  const figure = frame(block, body, { data, more: [buttons] });

  async function show() {
    const library = await libraries;
    const width = Math.max(body.clientWidth || 900, 600);
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

function drawing({ sankey, sankeyLinkHorizontal, sankeyJustify }, all, side, width, about) {
  const links = all.filter((l) => l[side] > 0).map((l) => ({ source: l.from, target: l.to, value: l[side] }));
  const names = [...new Set(links.flatMap((l) => [l.source, l.target]))];
  const root = names.find((n) => !links.some((l) => l.target === n));
  const into = new Map(names.map((n) => [n, links.filter((l) => l.target === n).reduce((sum, l) => sum + l.value, 0)]));
  const blocks = links.filter((l) => l.source === root).sort((a, b) => b.value - a.value).map((l) => l.target);
  const total = blocks.reduce((sum, name) => sum + into.get(name), 0);
  const rank = new Map(blocks.map((name, i) => [name, i]));
  const parent = new Map(links.map((l) => [l.target, l.source]));
  /** Blocks from the largest on, their events beside them in the same order, clock and leakage of all last. */
  function order({ name }) {
    if (name in RESTS) return 1e6 + Object.keys(RESTS).indexOf(name);
    if (rank.has(name)) return rank.get(name);
    return 1000 * (rank.get(parent.get(name)) ?? 0) + (name.endsWith("other events") ? 999 : 500 - 400 * (into.get(name) / total));
  }
  const height = (names.length - blocks.length - 1) * ROW + FLOW;
  const isNarrow = width < 700;
  const right = isNarrow ? 190 : 240;
  const graph = sankey().nodeId((n) => n.name).nodeAlign(sankeyJustify).nodeWidth(10).nodePadding(ROW - 2)
    .nodeSort((a, b) => order(a) - order(b)).extent([[2, 6], [width - right, height - 6]])({
      nodes: names.map((name) => ({ name })), links,
    });
  const colourOf = (name) => theme.colour(name === root ? "#8a9099" : RESTS[name] ?? BLOCKS[(rank.get(name) ?? rank.get(parent.get(name)) ?? 0) % BLOCKS.length]);
  const inner = (node) => node.x1 < width - right - 1;
  const label = (node) => {
    const words = node.name.includes(": ") ? node.name.split(": ").slice(1).join(": ") : node.name;
    const share = isNarrow && inner(node) ? "" : `, ${percent(node.value / total)}`;
    return `${words}  ${node.name === root ? digits(node.value) : Number(node.value.toPrecision(3))} mJ${share}`;
  };
  const path = sankeyLinkHorizontal();
  return s("svg", { width, height, viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${about}, ${side} tables` },
    graph.links.map((link) => s("path", { d: path(link), fill: "none", stroke: colourOf(link.source.name === root ? link.target.name : link.source.name),
      "stroke-opacity": 0.28, "stroke-width": Math.max(0.7, link.width) },
    s("title", {}, `${link.source.name} → ${link.target.name}: ${digits(link.value)} mJ`))),
    graph.nodes.map((node) => s("rect", { x: node.x0, y: node.y0, width: node.x1 - node.x0, height: Math.max(1, node.y1 - node.y0), fill: colourOf(node.name) },
      s("title", {}, `${node.name}: ${digits(node.value)} mJ`))),
    graph.nodes.map((node) => s("text", {
      x: node.x1 + 5, y: (node.y0 + node.y1) / 2, dy: "0.35em", class: inner(node) ? "inner" : null }, label(node))));
}
