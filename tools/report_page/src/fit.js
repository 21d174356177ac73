// Fits charts to their width: legends in columns, and names above bars on a narrow window.

export const NARROW = 560;  // pixels; below this width names are above their bars
export const LETTER = 6.7;  // mean width of a letter, in pixels
const SYMBOL = 34;  // width of the symbol of a legend entry, with gaps
const LINE = 15, BAR = 12;  // heights of a line of text and of a bar

const layersOf = (spec) => [spec, ...(spec.layer ?? []).flatMap(layersOf)];

/** Sets the number of columns of a legend by its width. */
function fitLegend(colour, values, width) {
  const names = colour.scale?.domain ?? [...new Set(values.map((v) => v[colour.field]))];
  const longest = Math.max(1, ...names.map((name) => String(name ?? "").length));
  colour.legend.columns = Math.max(1, Math.min(names.length, Math.floor(width / (longest * LETTER + SYMBOL))));
}

/** Moves names and labels of bars to lines above each bar. */
function stackRows(spec, values, width) {
  const { name, label, first } = spec.usermeta.rows;
  const lengthOf = (value) => String(value[name] ?? "").length + String((label && value[label]) ?? "").length + 3;
  const lines = label && Math.max(0, ...values.map(lengthOf)) * LETTER > width ? 2 : 1;
  const above = lines * LINE, step = above + BAR + 10, middle = step / 2;
  const text = (field, align, x, line) => ({
    ...(first ? { transform: [{ filter: `datum['${first}'] === 0` }] } : {}),
    mark: { type: "text", align, baseline: "top", fontSize: 12, yOffset: 4 + line * LINE - middle, limit: width, clip: false },
    encoding: { x: { value: x }, text: { field } },
  });
  spec.height = { step };
  spec.encoding.y = { ...spec.encoding.y, axis: null };
  for (const layer of spec.layer) {
    if (layer.mark.type === "bar") Object.assign(layer.mark, { height: BAR, yOffset: above / 2 });
    else layer.mark.yOffset = above / 2;
  }
  if (label) spec.layer = spec.layer.filter((layer) => layer.encoding.text?.field !== label);
  spec.layer.push(text(name, "left", 0, 0));
  if (label) spec.layer.push(lines === 2 ? text(label, "left", 0, 1) : text(label, "right", "width", 0));
}

/** Returns a specification fitted to a width in pixels. */
export function fitted(spec, values, width) {
  if (!width) return spec;
  const out = structuredClone(spec);
  for (const layer of layersOf(out)) {
    if (layer.encoding?.color?.legend?.orient === "bottom") fitLegend(layer.encoding.color, values, width);
  }
  if (width < NARROW && out.usermeta?.rows) stackRows(out, values, width);
  return out;
}
