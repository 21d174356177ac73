// Vega-Lite charts. Vega interprets expressions, because the page's security policy does not allow generated code.
import { h } from "./dom.js";
import { frame } from "./block.js";
import { records, saveSpec } from "./files.js";
import { fitted } from "./fit.js";
import { libraries } from "./lib.js";
import { specOf } from "./specs.js";
import * as theme from "./theme.js";

const options = (expressionInterpreter) => ({
  mode: "vega-lite", actions: false, ast: true, expr: expressionInterpreter, defaultStyle: false, config: theme.config(),
  tooltip: { disableDefaultStyle: true, theme: "page" }, renderer: "canvas",
  logLevel: 1,  // errors only: a height in steps together with a container width causes a warning
});

const RESIZE = 50;  // change of the width, in pixels, above which a chart is drawn again

/** Draws a specification into an element, and again when theme or width changes. Calls `ready` with the Vega view. */
export function drawn(element, spec, data, ready, more = {}) {
  let view = null, width = 0, waiting = 0;
  async function draw() {
    const { embed, expressionInterpreter } = await libraries;
    if (view && !element.isConnected) return;
    view?.finalize();
    width = element.clientWidth;
    const values = typeof data === "function" ? data() : records(data);
    const shown = fitted(typeof spec === "function" ? spec() : spec, values, width);
    const colours = theme.coloured({ ...shown, data: { name: "rows" }, datasets: { rows: values, ...more } });
    view = (await embed(element, colours, options(expressionInterpreter))).view;
    const canvas = element.querySelector("canvas");
    canvas?.setAttribute("role", "img");
    canvas?.setAttribute("aria-label", element.dataset.about ?? "");
    element.dataset.drawn = "";
    ready?.(view);
  }
  theme.listen(draw);
  const done = draw();
  new ResizeObserver(() => {
    const now = element.clientWidth;
    if (!now || !view || Math.abs(now - width) < RESIZE) return;
    clearTimeout(waiting);
    waiting = setTimeout(draw, 100);
  }).observe(element);
  return { done, draw };
}

/** Returns the block of a chart. It is drawn when it is near the window, so that the first screen is not delayed. */
export function chart(block, data) {
  const body = h("div", { class: "drawing", "data-about": block.about });
  const spec = specOf(block.chart, block.about);
  const save = h("button", { type: "button", "aria-label": `${block.title}: Vega-Lite specification`,
    onclick: () => saveSpec(block.id, spec, data) }, "Vega-Lite");
  const figure = frame(block, body, { data, more: [save] });
  whenNear(figure, () => drawn(body, spec, data).done);
  return figure;
}

const waiting = new Map();
const near = new IntersectionObserver((entries) => {
  for (const entry of entries) if (entry.isIntersecting) start(entry.target);
}, { rootMargin: "600px" });

function start(element) {
  const draw = waiting.get(element);
  if (!draw) return;
  waiting.delete(element);
  near.unobserve(element);
  draw();
}

export function whenNear(element, draw) {
  waiting.set(element, draw);
  near.observe(element);
}

// Charts that are further away are drawn when the browser is idle, and before printing.
const idle = (draw) => (window.requestIdleCallback ? requestIdleCallback(draw, { timeout: 300 }) : setTimeout(draw, 200));
function drawNext() {
  const [next] = waiting.keys();
  if (next) start(next);
  if (waiting.size > 0) idle(drawNext);
}
/** Drops charts that wait to be drawn, before another view is drawn. */
export const freshView = () => waiting.clear();
export const drawRest = () => libraries.then(() => idle(drawNext));
window.addEventListener("beforeprint", () => [...waiting.keys()].forEach(start));
