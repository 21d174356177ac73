// The frame of a block: heading, what it can do, the drawing, and the same as a table.
import { h } from "./dom.js";
import { saveCsv } from "./files.js";
import * as state from "./state.js";
import { plainTable } from "./table.js";

const shownTables = () => new Set(state.get("tables").split(",").filter(Boolean));

/** `body` is the drawing; `more` are further controls. With `data` there is a switch to a table, and a download. */
export function frame(block, body, { data, more = [], table } = {}) {
  const title = h("h3", { id: `block-${block.id}` }, block.title);
  const tools = h("div", { class: "tools" }, more);
  const figure = h("figure", { class: `block ${block.type}`, "data-block": block.id, "aria-labelledby": `block-${block.id}` },
    h("figcaption", {}, title, tools), body);
  if (data && !table) addTable(block, body, data, tools, figure);
  if (data) {
    tools.append(h("button", { type: "button", onclick: () => saveCsv(block.id, data), "aria-label": `${block.title}: CSV` },
      "CSV"));
  }
  return figure;
}

function addTable(block, body, data, tools, figure) {
  let rows = null;
  const button = h("button", { type: "button", "aria-pressed": "false", "aria-label": `${block.title}: as a table`,
    onclick: () => toggle(true) }, "Table");
  function toggle(byHand) {
    const all = shownTables();
    if (byHand) {
      all.has(block.id) ? all.delete(block.id) : all.add(block.id);
      state.set({ tables: [...all].join(",") }, show);
    }
    show();
  }
  function show() {
    const on = shownTables().has(block.id);
    button.setAttribute("aria-pressed", String(on));
    if (on && !rows) figure.append((rows = plainTable(block.title, data)));
    if (rows) rows.hidden = !on;
    if (body.hidden && !on) requestAnimationFrame(() => window.dispatchEvent(new Event("resize")));
    body.hidden = on;
  }
  state.listen("tables", show);
  tools.prepend(button);
  show();
}
