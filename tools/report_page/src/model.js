// Data structures of a view, which main.js draws, and access to reports, which may be incomplete or malformed.

export const newView = (name) => ({ name, verdict: null, facts: [], notices: [], headlines: [], sections: [], data: {} });

/** A dataset, for charts, tables and downloads. `columns`: [field, title, show, unit]; `show`: format of values. */
export const dataset = (columns, rows = []) => ({
  columns: columns.map(([field, title, show = "text", unit = ""]) => ({ field, title, show, unit })), rows,
});

export const section = (id, title, lead, ...blocks) => ({ id, title, lead, blocks: blocks.flat().filter(Boolean) });
export const text = (words) => ({ type: "text", text: words });
export const table = (id, title, data, more = {}) => ({ type: "table", id, title, data, ...more });
/** A chart of a dataset. `about` describes it to screen readers; `options`: its kind and what specs.js needs. */
export const chart = (id, title, about, data, options) => ({ type: "chart", id, title, about, data, chart: options });
export const headline = (figure) => ({ show: "number", unit: "", low: null, high: null, note: "", ...figure });

const isObject = (node) => typeof node === "object" && node !== null && !Array.isArray(node);

/** Returns the value at a path of keys, or null. */
export function at(node, ...keys) {
  for (const key of keys) {
    if (typeof node !== "object" || node === null || !Object.hasOwn(node, key)) return null;
    node = node[key];
  }
  return node;
}
export const numberAt = (node, ...keys) => (typeof at(node, ...keys) === "number" ? at(node, ...keys) : 0);
export const hasNumber = (node, ...keys) => typeof at(node, ...keys) === "number";
export const textAt = (node, ...keys) => (typeof at(node, ...keys) === "string" ? printable(at(node, ...keys)) : "");
export const entriesAt = (node, ...keys) => (isObject(at(node, ...keys)) ? Object.entries(at(node, ...keys)) : []);
export const itemsAt = (node, ...keys) => (Array.isArray(at(node, ...keys)) ? at(node, ...keys) : []);

const LONGEST = 2000;
/** Returns `words` as one line without control characters. */
export const printable = (words, most = LONGEST) => words.replace(/[\u0000-\u001f\u007f]/g, "?").slice(0, most);

export const capital = (words) => words.charAt(0).toUpperCase() + words.slice(1);

/** Returns the leaves of a tree of keys, [["tni.trv.l1.size", "16 KiB"], ...]; figures with a band are leaves. */
export function flattened(node, prefix = "") {
  return entriesAt(node).flatMap(([key, value]) => (isObject(value) && !Object.hasOwn(value, "nominal") ? flattened(value, `${prefix}${key}.`)
    : [[printable(prefix + key), printable(typeof value === "string" ? value : JSON.stringify(value))]]));
}
