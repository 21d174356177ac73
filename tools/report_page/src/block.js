// A block of the page: heading, buttons, the drawing, and the same data as a table.
import { h } from "./dom.js";
import { saveCsv } from "./files.js";
import * as state from "./state.js";
import { plainTable } from "./table.js";

const shownTables = () => new Set(state.get("tables").split(",").filter(Boolean));

/**
 * Returns a block of the page. `body`: the drawing; `more`: further controls. With `data` there is a switch to a table,
 * and a download. `data` may be a function; call `refresh()` of the returned figure when its result changes.
 */
export function frame(block, body, { data, name = () => block.id, more = [], table } = {}) {
  const rows = typeof data === "function" ? data : () => data;
  const title = h("h3", { id: `block-${block.id}` }, block.title);
  const tools = h("div", { class: "tools" }, more);
  const figure = h("figure", { class: `block ${block.type}`, "data-block": block.id, "aria-labelledby": `block-${block.id}` },
    h("figcaption", {}, title, tools), body);
  if (data && !table) addTable(block, body, rows, tools, figure);
  if (data) {
    tools.append(h("button", { type: "button", onclick: () => saveCsv(name(), rows()), "aria-label": `${block.title}: CSV` },
      "CSV"));
  }
  return figure;
}

function addTable(block, body, data, tools, figure) {
  let rows = null;
  const button = h("button", { type: "button", "aria-label": `${block.title}: as a table`, onclick: toggle }, "Table");
  function toggle() {
    const all = shownTables();
    all.has(block.id) ? all.delete(block.id) : all.add(block.id);
    state.set({ tables: [...all].join(",") });
  }
  function show() {
    const on = shownTables().has(block.id);
    button.setAttribute("aria-pressed", String(on));
    if (on && !rows) body.after((rows = plainTable(block.title, data())));
    if (rows) rows.hidden = !on;
    if (body.hidden && !on) requestAnimationFrame(() => window.dispatchEvent(new Event("resize")));
    body.hidden = on;
  }
  figure.refresh = () => {
    rows?.remove();
    rows = null;
    show();
  };
  state.listen("tables", show);
  tools.append(button);
  show();
}
