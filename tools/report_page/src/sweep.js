// The view of a sweep or a search, from its results (tools/studies/report/sweep_data.h).
import { counted, digits, short } from "./format.js";
import { addSearch } from "./search.js";
import { capital, chart, dataset, headline, newView, section, table, text } from "./model.js";

/** Formats a share of variance: "62 % of its variance (95 %: 58 to 66 %)". */
function shareText({ share, low, high }) {
  const whole = (value) => (100 * value).toFixed(0);
  return `${whole(share)} % of its variance${low === high ? "" : ` (95 %: ${whole(low)} to ${whole(high)} %)`}`;
}

/** Returns a sentence on the axis that explains most of a metric, or on the two that cannot be distinguished. */
function decisionText({ points, is_grid: isGrid, effects: [first, second] }, metric, noun) {
  const all = `${counted(points, noun)}${isGrid ? "" : " (not a full grid)"}`;
  if (second && first.low <= second.high) {
    return `${all} cannot show whether ${metric} depends most on ${first.axis} or on ${second.axis}: ` +
      `${first.axis} explains ${shareText(first)}, ${second.axis} ${shareText(second)}.`;
  }
  return `${capital(metric)} depends most on ${first.axis}, which explains ${shareText(first)} over ${all}.`;
}

function addHeadlines(data, points, done, view) {
  for (const field of data.headlines.filter((f) => Object.hasOwn(data.best, f))) {
    const metric = data.metrics.find((m) => m.field === field), best = points[data.best[field]];
    const values = done.map((p) => p[field]).filter((v) => typeof v === "number");
    view.headlines.push(headline({ id: field, name: capital(metric.name), value: best[field], show: metric.show, unit: metric.unit,
      low: Math.min(...values), high: Math.max(...values),
      note: `the ${metric.more ? "most" : "least"} of ${data.has_constraints ? "eligible" : "all"} ${data.noun}s, of ${data.noun} ${best.n}; range over all ${data.noun}s` }));
  }
}

function addVerdict(data, points, done, view) {
  const metric = data.metrics.find((m) => m.field === data.headlines[0]), row = metric && data.best[metric.field];
  const found = metric && data.sensitivities.find((s) => s.metric === metric.field);
  if (data.search?.sentence) {
    const ties = row !== undefined && data.ties ? `Best: ${data.noun} ${points[row].n}${data.ties}.` : "";
    view.verdict = { sentence: data.search.sentence, more: `${found ? `${decisionText(found, metric.name, data.noun)} ` : ""}${ties}`.trim(),
      links: [{ words: "the answer", to: "answer" }, { words: `the ${data.noun}s`, to: "front" }] };
    return;
  }
  if (row === undefined) {
    view.verdict = { sentence: done.length > 0 && data.has_constraints ? `No ${data.noun} that has a result meets the constraints.` : `No ${data.noun} of this sweep has a result yet.`,
      more: "", links: [{ words: `the ${data.noun}s`, to: "front" }] };
    return;
  }
  const best = points[row], value = best[metric.field];
  const axes = data.axes.map((a) => `${a.field} ${best[a.field]}`).join(", ");
  const amount = Math.abs(value) >= 1e4 ? short(value) : digits(value);
  const links = [{ words: "the front", to: "front" }, { words: "what each axis does", to: "sensitivity" }];
  view.verdict = { sentence: found ? decisionText(found, metric.name, data.noun) : `No axis changes ${metric.name}.`,
    more: `Best: ${data.noun} ${best.n} with ${amount} ${metric.unit || metric.name} (${axes})${data.ties}.`, links: found ? links : links.slice(0, 1) };
}

function addLimits(data, points, done, view) {
  if (!data.has_constraints) return;
  const feasible = points.filter((p) => p.constraints === "met").length;
  view.facts.push({ name: "Feasible", value: `${feasible} of ${done.length} ${data.noun}s` });
  view.data.limits = dataset([["constraint", "constraint"], ["met", `${data.noun}s that meet it`, "number"], ["best", `best ${data.noun}`, "number"], ["interval", "95 %"], ["room", "room to the limit"]], data.limits);
  view.sections.push(section("limits", "Limits",
    `${feasible} of ${done.length} ${data.noun}s meet all constraints. Room is the distance of the best ${data.noun} from a limit, as a share of the limit.`,
    table("limits-table", `Constraints, and the best ${data.noun}'s room`, "limits")));
}

function addPoints(data, view) {
  const { noun } = data, title = `${capital(noun)}s`;
  const shared = { data: "points", axes: data.axes, metrics: data.metrics, noun };
  view.sections.push(section("front", `${title} and their front`,
    `A ${noun} is on the front if no other ${data.has_constraints ? "that meets the constraints " : ""}is as good in both figures and better in one. ` +
    `A click on a ${noun}, or on its row below, shows the ${data.workloads ? "commands that run" : "command that runs"} it again.`,
    data.start && { type: "scatter", id: "scatter", title: `All ${noun}s`, ...shared, start: data.start, about: `All ${noun}s by two figures, with those on the front` },
    { type: "points", id: "points", title, ...shared }));
  if (!data.start || data.axes.length < 2) return;
  view.sections.push(section("parallel", "Parallel axes",
    `A line is a ${noun}, from axis to axis and to its figures. The filter of the table above applies here, too.`,
    { type: "parallel", id: "parallel-axes", title: `All ${noun}s over axes and figures`, ...shared, start: data.start, about: `Each ${noun} as a line over its axes and figures` }));
}

function addWorkloads(data, view) {
  const { workloads } = data;
  if (!workloads || workloads.figures.length === 0) return;
  const best = data.best[data.headlines[0]] ?? null;
  view.sections.push(section("workloads", "On each workload",
    `Every machine is evaluated on ${workloads.names.length} workloads. The bars show the best machine${data.headlines[0] ? `, by ${data.metrics.find((m) => m.field === data.headlines[0]).name}` : ""}, and the one that is chosen above.`,
    { type: "workloads", id: "workload-bars", title: "Machines on each workload", data: "points", ...workloads, best, about: "A figure of the best and of the chosen machine on each workload" }));
}

function addSensitivities(data, view) {
  const rows = data.sensitivities.flatMap(({ metric, effects }) => effects.map((e) => [data.metrics.find((m) => m.field === metric).name, e.axis,
    e.share, `${(100 * e.share).toFixed(0)} %`, e.low, e.high, e.range, e.levels]));
  view.data.sensitivity = dataset([["metric", "figure"], ["axis", "axis"], ["share", "share of variance", "percent"], ["label", "shown"], ["low", "95 % from", "percent"],
    ["high", "95 % to", "percent"], ["range", "range of means", "percent"], ["levels", "values", "number"]], rows);
  const isGrid = data.sensitivities.every((s) => s.is_grid);
  view.sections.push(section("sensitivity", "What each axis does on its own",
    `The share of a figure's variance over all ${data.noun}s that an axis explains, averaged over all other axes. The remainder to 100 % is noise and the combined effect of axes.`,
    rows.length === 0 ? text("No figure changes with any axis.")
      : [!isGrid && text(`The ${data.noun}s are not a full grid: shares are estimates.`),
        chart("shares", "Shares of variance", "Share of the variance of each figure that each axis explains", "sensitivity", { kind: "sensitivity" }),
        table("shares-table", "Shares with their intervals", "sensitivity")]));
}

export function sweepView(data) {
  const view = newView(data.name);
  const metrics = data.metrics.map((m) => [m.field, m.name, m.show, m.unit]);
  const columns = [["n", "n", "number"], ["status", "status"], ...data.axes.map((a) => [a.field, a.field]), ...metrics,
    ["constraints", "constraints"], ["error", "error"], ["command", "command"]];
  const eligible = columns.length - 3, isShown = (_, c) => data.has_constraints || c !== eligible;
  const words = (row) => row.map((value, c) => (c !== eligible ? value : row[1] !== "done" ? "" : value ? "met" : "broken"));
  view.data.points = dataset(columns.filter(isShown), data.points.map((row) => words(row).filter(isShown)));
  const points = data.points.map((row) => Object.fromEntries(words(row).map((value, c) => [columns[c][0], value])));
  const done = points.filter((p) => p.status === "done");

  if (data.question) view.facts.push({ name: "Question", value: data.question });
  if (data.workloads) view.facts.push({ name: "Workloads", value: data.workloads.names.join(", ") });
  view.facts.push({ name: `${capital(data.noun)}s`, value: done.length === points.length ? `${points.length}` : `${done.length} of ${points.length}` },
    { name: "Axes", value: data.axes.map((a) => a.field).join(", ") || "none" });
  if (data.goals.length > 0) view.facts.push({ name: "Goals", value: data.goals.join(", ") });
  view.notices = data.notices;
  addVerdict(data, points, done, view);
  addLimits(data, points, done, view);
  addHeadlines(data, points, done, view);
  addPoints(data, view);
  addWorkloads(data, view);
  if (!data.search || data.sensitivities.length > 0) addSensitivities(data, view);
  if (data.search) addSearch(data.search, view);
  return view;
}
