// Downloads of the page's data.

function save(name, type, text) {
  const url = URL.createObjectURL(new Blob([text], { type }));
  const link = document.createElement("a");
  link.href = url;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** A cell of CSV, quoted so that a spreadsheet does not evaluate it as a formula. */
function cell(value) {
  if (value === null || value === undefined) return "";
  if (typeof value === "number" || typeof value === "boolean") return String(value);
  let text = String(value);
  if (/^[=+\-@\t\r]/.test(text)) text = "'" + text;
  return /[",\n\r]/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text;
}

/** Returns the data as CSV: all rows, with all digits. */
export function csvOf(data) {
  const lines = [data.columns.map((c) => c.field), ...data.rows];
  return lines.map((line) => line.map(cell).join(",")).join("\n") + "\n";
}

export const saveCsv = (name, data) => save(`${name}.csv`, "text/csv", csvOf(data));

const SCHEMA = "https://vega.github.io/schema/vega-lite/v6.json";

/** Saves the specification with its data, for notebooks and the Vega editor. */
export const saveSpec = (name, spec, data) =>
  save(`${name}.vl.json`, "application/json", JSON.stringify({ $schema: SCHEMA, ...spec, data: { values: records(data) } }, null, 1));

/** Returns the rows of a dataset as objects. */
export function records(data) {
  const names = data.columns.map((c) => c.field);
  return data.rows.map((row) => Object.fromEntries(names.map((name, i) => [name, row[i]])));
}
