// Tables that sort; long ones have a filter.
import { h } from "./dom.js";
import { shown } from "./format.js";
import * as state from "./state.js";

const MARKS = new Set(["shown", "order", "pale", "labelled", "right"]);
const LONG = 36;  // characters from which a cell wraps
const WIDE = 7;  // columns above which no cell wraps
const isNumeric = (column) => column.show !== "text";

/** Returns the columns for readers, without those that only order, place or label the marks of a chart. */
export function readable(data) {
  return data.columns.map((column, i) => ({ ...column, i }))
    .filter((c) => !MARKS.has(c.title));
}

function heading(column) {
  const unit = column.unit && column.show !== "si" ? `, ${column.unit}` : "";
  return column.title + unit;
}

function cellOf(row, column) {
  const text = shown(row[column.i], column, column.show === "si");
  return h("td", { class: isNumeric(column) ? "number" : text.length > LONG ? "long" : null }, text);
}

/** Returns a table without filter and state. */
export function plainTable(title, data) {
  return sortableTable({ id: "", title }, data, {}).element;
}

const compare = (a, b) => {
  const none = (v) => v === null || v === undefined || v === "";
  if (none(a) || none(b)) return none(a) - none(b);
  if (typeof a === "number" && typeof b === "number") return a - b;
  return String(a).localeCompare(String(b), "en", { numeric: true });
};

const plainName = (name) => name.replaceAll(" ", "").replaceAll("totals.", "");

/** True if a typed name denotes a column's name: its end, or a function of such an end, as worst(fps). */
function denotes(typed, name) {
  const [short, whole] = [plainName(typed), plainName(name)];
  const inner = short.match(/^(.*[(,])([^(),]+)\)$/);
  if (whole === short || whole.endsWith("." + short)) return true;
  return inner !== null && whole.startsWith(inner[1]) && whole.endsWith(`.${inner[2]})`);
}

/** A filter of words and comparisons such as fps>=100. A row passes if it contains all words and meets all comparisons. */
export function filterOf(text, columns) {
  const tests = [];
  for (const word of text.match(/[^\s(]*\([^)]*\)\S*|\S+/g) ?? []) {
    const found = word.match(/^([^<>=!]+)(<=|>=|!=|=|<|>)(.+)$/);
    const column = found && columns.find((c) => [c.field, c.title].some((n) => denotes(found[1], n)));
    if (!column) {
      const low = word.toLowerCase();
      tests.push((row) => columns.some((c) => String(row[c.i] ?? "").toLowerCase().includes(low)));
      continue;
    }
    const [, , op, wanted] = found;
    tests.push((row) => {
      const value = row[column.i];
      if (value === null || value === undefined) return false;
      const as = typeof value === "number" && wanted !== "" && Number.isFinite(Number(wanted)) ? Number(wanted) : wanted;
      const order = compare(value, as);
      return { "<": order < 0, ">": order > 0, "<=": order <= 0, ">=": order >= 0, "=": order === 0, "!=": order !== 0 }[op];
    });
  }
  return (row) => tests.every((test) => test(row));
}

/** Returns an example of a filter, with an existing column. */
function hint(columns) {
  const column = columns.find((c) => isNumeric(c) && c.field !== "n") ?? columns[0];
  const name = column.field.split(".").at(-1);
  const isUnique = columns.filter((c) => c.field === name || c.field.endsWith("." + name)).length === 1;
  return `words, or comparisons: ${isUnique ? name : column.field}>=0.1`;
}

/**
 * Returns a table whose headings sort. `id` names its state in the address. `chosen(i, row)` is called for a click on a
 * row, `filtered(rows)` with the rows that pass the filter.
 */
export function sortableTable({ id, title }, data, { filter = false, chosen, filtered, hidden = new Set() } = {}) {
  const columns = readable(data).filter((c) => !hidden.has(c.field));
  let [sorted, direction] = ["", ""];
  const body = h("tbody");
  const heads = columns.map((column) => {
    const sort = h("button", { type: "button", onclick: () => turn(column.field) }, heading(column));
    return h("th", { scope: "col", class: isNumeric(column) ? "number" : null }, sort);
  });
  const count = h("span", { class: "count", role: "status" });
  const scroller = h("div", { class: "scroller", tabindex: "0", role: "region", "aria-label": `${title}, table` },
    h("table", { class: columns.length > WIDE ? "wide" : null }, h("thead", {}, h("tr", {}, heads)), body));
  const input = filter && h("input", { type: "search", "aria-label": `Filter of ${title}`,
    placeholder: hint(columns), oninput: () => state.set({ [`filter.${id}`]: input.value }) });

  function turn(field) {
    if (sorted !== field) [sorted, direction] = [field, "asc"];
    else if (direction === "asc") direction = "desc";
    else [sorted, direction] = ["", ""];
    if (id) state.set({ [`sort.${id}`]: sorted ? `${sorted}:${direction}` : "" });
    else show();
  }
  /** Reads the state in the address. */
  function follow() {
    [sorted, direction] = state.get(`sort.${id}`).split(":");
    if (input && input.value !== state.get(`filter.${id}`)) input.value = state.get(`filter.${id}`);
    show();
  }

  function show() {
    const column = columns.find((c) => c.field === sorted);
    heads.forEach((head, i) => {
      if (columns[i] === column) head.setAttribute("aria-sort", direction === "desc" ? "descending" : "ascending");
      else head.removeAttribute("aria-sort");
    });
    const fits = input ? filterOf(input.value, columns) : () => true;
    const rows = data.rows.map((row, i) => [row, i]).filter(([row]) => fits(row));
    if (column) {
      rows.sort(([a], [b]) => {
        const [x, y] = [a[column.i], b[column.i]];
        const none = (v) => v === null || v === undefined || v === "";
        if (none(x) || none(y)) return none(x) - none(y);
        return direction === "desc" ? compare(y, x) : compare(x, y);
      });
    }
    body.replaceChildren(...rows.map(([row, i]) => {
      const line = h("tr", { "data-row": i }, columns.map((c) => cellOf(row, c)));
      if (chosen) {
        line.classList.add("choosable");
        line.tabIndex = 0;
        line.addEventListener("click", () => chosen(i, row));
        line.addEventListener("keydown", (event) => event.key === "Enter" && chosen(i, row));
      }
      return line;
    }));
    if (input) count.textContent = `${rows.length} of ${data.rows.length}`;
    filtered?.(new Set(rows.map(([, i]) => i)));
  }
  if (id) {
    state.listen(`sort.${id}`, follow);
    state.listen(`filter.${id}`, follow);
    follow();
  } else {
    show();
  }
  const element = input ? h("div", {}, h("div", { class: "filter" }, input, count), scroller) : scroller;
  return { element, body, show, mark: (i) => body.querySelectorAll("tr").forEach((r) => r.classList.toggle("chosen", r.dataset.row === String(i))) };
}
