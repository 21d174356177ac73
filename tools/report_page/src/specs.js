// Vega-Lite specifications of the charts, from the options of a block (`block.chart`). Fields are dataset columns.
const ACCENT = "#1f5fa8", WAIT = "#b85c12", REST = "#8a9099", TEXT = "#1c2733", INVERSE = "#ffffff";
const BAR = 22;  // height of a bar's band, in pixels
const NAMED = 0.055;  // smallest share of a part that is labelled inside its bar

const percents = (format) => ({ format, labelExpr: "replace(datum.label, '%', ' %')" });

/** Axis labels in a format of d3-format; "~s" adds metric prefixes, except to zero. */
function labels(format) {
  if (format.endsWith("%")) return percents(format);
  return format === "~s" ? { format, labelExpr: "datum.value == 0 ? '0' : datum.label" } : { format };
}

const quantity = (field, title, format) => ({ field, type: "quantitative", title, ...(format ? { axis: labels(format) } : {}) });

const category = (field, labelLimit = 250) =>
  ({ field, type: "nominal", title: null, sort: null, axis: { labelLimit, ticks: false, domain: false } });

const colourScale = (colours) => ({ domain: colours.map(([name]) => name), range: colours.map(([, colour]) => colour) });

/** Columns that fit.js writes above the bars on a narrow page. `first` is 0 in exactly one part of a stacked bar. */
const rowsAbove = (rows) => ({ usermeta: { rows } });

const endLabel = (field) => ({
  mark: { type: "text", align: "left", dx: 5, color: TEXT },
  encoding: { text: { field } },
});

/** Horizontal bars, one a row, each with its label at its end. `domain` fixes the axis; `from` is where bars begin. */
function bars({ name, value, title, format, label, from = 0, domain }) {
  const scale = domain ? { domain } : { zero: from === 0, nice: true, ...(from === 0 ? {} : { domainMin: from }) };
  return {
    width: "container", height: { step: BAR }, ...rowsAbove({ name, label }),
    encoding: { y: category(name), x: { ...quantity(value, title, format), scale } },
    layer: [
      { mark: { type: "bar", color: ACCENT, height: { band: 0.62 } },
        encoding: { x2: { datum: from }, tooltip: [{ field: name, title: " " }, { field: label, title }] } },
      endLabel(label),
    ],
  };
}

/** Horizontal bars of length 1, divided into coloured parts in the order of `colours`; large parts are labelled. */
function stack({ name, nameTitle, part, share, colours }) {
  const x = { field: share, type: "quantitative", title: null, stack: "zero", scale: { domain: [0, 1] }, axis: percents(".0%") };
  const order = { field: "order", type: "quantitative" };
  const tooltip = [{ field: name, title: nameTitle }, { field: part, title: "part" },
    { field: share, title: "share", format: ".2%" }, { field: "meaning", title: "meaning" }];
  const color = { field: part, type: "nominal", title: null, sort: null, scale: colourScale(colours),
    legend: { orient: "bottom", columns: 6, symbolType: "square", labelLimit: 220 } };
  return {
    width: "container", height: { step: BAR + 6 }, ...rowsAbove({ name, first: "order" }),
    encoding: { y: category(name), order },
    layer: [
      { mark: { type: "bar", stroke: INVERSE, strokeWidth: 0.7, height: { band: 0.78 } }, encoding: { x, color, tooltip } },
      { mark: { type: "text", fontSize: 10.5, limit: 120 },
        encoding: {
          x: { ...x, bandPosition: 0.5 }, detail: { field: part },
          text: { condition: { test: `datum['${share}'] >= ${NAMED}`, field: share, format: ".0%" }, value: "" },
          color: { condition: { test: "datum.pale", value: TEXT }, value: INVERSE },
        } },
    ],
  };
}

/** From a first total through signed changes to a last total. Columns: name, from, to, right, kind, label. */
function waterfall({ title, unit, format }) {
  const x = (field) => ({ ...quantity(field, title, format), scale: { zero: false, nice: false } });
  const color = { field: "kind", type: "nominal", title: null,
    scale: { domain: ["total", "less", "more"], range: [REST, ACCENT, WAIT] },
    legend: { orient: "bottom", symbolType: "square" } };
  const label = endLabel("label");
  return {
    width: "container", height: { step: BAR }, ...rowsAbove({ name: "name", label: "label" }),
    encoding: { y: category("name") },
    layer: [
      { mark: { type: "bar", height: { band: 0.66 } },
        encoding: { x: x("from"), x2: { field: "to" }, color,
          tooltip: [{ field: "name", title: " " }, { field: "label", title: unit }] } },
      { ...label, encoding: { x: x("right"), ...label.encoding } },
    ],
  };
}

/** A line chart of y over x, both numbers. */
const lines = ({ x, xTitle, xFormat, y, yTitle }) => ({
  width: "container", height: 180, mark: { type: "line", point: true, color: ACCENT },
  encoding: { x: quantity(x, xTitle, xFormat), y: quantity(y, yTitle),
    tooltip: [{ field: x, title: xTitle }, { field: y, title: yTitle }] },
});

/** Points below ceilings on logarithmic axes. Columns: x, y, line (empty for points), name, and label: where it is written. */
function roofline() {
  const axis = (field, title) => ({ field, type: "quantitative", title, scale: { type: "log", nice: false },
    axis: { format: "~s", labelOverlap: true, tickCount: 6 } });
  const only = (filter) => [{ filter }];
  const text = { text: { field: "name" } };
  const ceiling = (side, dy) => ({ transform: only(`datum.label == '${side}'`),
    mark: { type: "text", align: "left", dy, dx: 4, color: TEXT }, encoding: text });
  // The point's name has two lines: "this run: 100 Mrays/s at 60 B a ray".
  const point = (side, align, dx) => ({ transform: only(`datum.line == '' && datum.label == '${side}'`),
    mark: { type: "text", align, dx, dy: 12, lineBreak: " at ", fontWeight: 600, color: ACCENT }, encoding: text });
  return {
    width: "container", height: 300,
    encoding: { x: axis("x", "DRAM bytes per ray"), y: axis("y", "rays per second") },
    layer: [
      { transform: only("datum.line != ''"), mark: { type: "line", color: REST, strokeWidth: 1.6 },
        encoding: { detail: { field: "line" }, order: { field: "x" } } },
      ceiling("above", -7),
      ceiling("below", 13),
      { transform: only("datum.line == ''"), mark: { type: "point", filled: true, size: 90, color: ACCENT, opacity: 1 },
        encoding: { tooltip: [{ field: "name", title: " " }, { field: "x", title: "bytes per ray", format: ".4s" },
          { field: "y", title: "rays/s", format: ".4s" }] } },
      point("right of point", "left", 9),
      point("left of point", "right", -9),
    ],
  };
}

/** Values over time, one column each, as stacked areas or as lines. `colours` is empty for the default colours. */
const series = ({ names, unit, stacked, colours }) => ({
  width: "container", height: 220,
  transform: [{ fold: names, as: ["name", "value"] }],
  mark: stacked ? { type: "area", interpolate: "step-after" } : { type: "line", interpolate: "step-after", strokeWidth: 1.5 },
  encoding: {
    x: { field: "begin_us", type: "quantitative", title: "us of simulated time", scale: { nice: false } },
    y: { field: "value", type: "quantitative", title: unit, axis: { tickCount: 5 }, stack: stacked ? "zero" : null },
    color: { field: "name", type: "nominal", title: null, sort: null,
      scale: colours.length > 0 ? colourScale(colours) : { domain: names },
      legend: { orient: "bottom", columns: 6, symbolType: "square" } },
  },
});

/** Bars of shares with their intervals, side by side for each metric. Columns: metric, axis, share, low, high, label. */
function sensitivity() {
  const x = (field) => ({ field, type: "quantitative", title: "share of variance", scale: { domain: [0, 1] }, axis: percents(".0%") });
  // The label is right of the interval, or inside the bar where there is no room.
  const inside = "datum.high > 0.85 && datum.low > 0.25";
  const label = (filter, field, align, dx, color) => ({ transform: [{ filter }],
    mark: { type: "text", align, dx, color, dy: 3 }, encoding: { x: x(field), text: { field: "label" } } });
  return {
    width: "container", height: { step: 15 },
    encoding: { y: category("metric", 160), yOffset: { field: "axis", type: "nominal", sort: null } },
    layer: [
      { mark: { type: "bar", height: { band: 0.8 } },
        encoding: {
          x: x("share"),
          color: { field: "axis", type: "nominal", title: null, sort: null,
            legend: { orient: "bottom", symbolType: "square", labelLimit: 260 } },
          tooltip: [{ field: "metric", title: "figure" }, { field: "axis", title: "axis" },
            { field: "share", title: "share", format: ".1%" }],
        } },
      { mark: { type: "rule", color: TEXT }, encoding: { x: x("low"), x2: { field: "high" } } },
      label(`!(${inside})`, "high", "left", 5, TEXT),
      label(inside, "low", "right", -5, INVERSE),
    ],
  };
}

/** Points with intervals, the best one's band by the tables, and a limit. Columns: n, x, y, x_low, x_high, y_low, y_high, place, axes, band_low, band_high. */
function limited({ xTitle, yTitle, limit }) {
  const axis = (field, title) => ({ field, type: "quantitative", title, scale: { zero: false, nice: true } });
  const interval = (a, b, other) => ({ mark: { type: "rule", color: REST, opacity: 0.7 },
    encoding: { [a]: axis(`${a}_low`, a === "x" ? xTitle : yTitle), [`${a}2`]: { field: `${a}_high` }, [b]: axis(b, other) } });
  return {
    width: "container", height: 320,
    layer: [
      { mark: { type: "rule", color: WAIT, strokeDash: [5, 4], strokeWidth: 1.5 }, encoding: { x: { datum: limit, type: "quantitative" } } },
      { transform: [{ filter: "datum.place === 'best' && isValid(datum.band_low)" }], mark: { type: "rule", color: WAIT, strokeWidth: 7, opacity: 0.3 },
        encoding: { x: axis("band_low", xTitle), x2: { field: "band_high" }, y: axis("y", yTitle) } },
      interval("x", "y", yTitle),
      interval("y", "x", xTitle),
      { mark: { type: "point", filled: true, size: 60, opacity: 0.95 },
        encoding: {
          x: axis("x", xTitle), y: axis("y", yTitle),
          size: { condition: { test: "datum.place === 'best'", value: 160 }, value: 50 },
          color: { field: "place", type: "nominal", title: null, scale: { domain: ["best", "meets all limits", "breaks a limit"], range: [WAIT, ACCENT, REST] },
            legend: { orient: "bottom", symbolType: "circle" } },
          tooltip: [{ field: "n", title: "machine" }, { field: "axes", title: "axes" }, { field: "x", title: xTitle, format: ".4~g" }, { field: "y", title: yTitle, format: ".4~g" }],
        } },
    ],
  };
}

/** Bars of values as shares of their limits, with a mark at the limit. Columns: name, share, label. */
const shares = () => {
  const bar = bars({ name: "name", value: "share", title: "share of the limit", format: ".0%", label: "label" });
  return { ...bar, layer: [...bar.layer, { mark: { type: "tick", orient: "vertical", color: WAIT, thickness: 2, height: 18 }, encoding: { x: { datum: 1 } } }] };
};

const KINDS = { bars, stack, waterfall, lines, roofline, series, sensitivity, limited, shares };

/** The specification of a chart whose `about` sentence describes it to readers who do not see it. */
export const specOf = (chart, about) =>
  ({ ...KINDS[chart.kind](chart), description: about, autosize: { type: "fit-x", contains: "padding" } });
