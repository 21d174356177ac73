// Views of two or more runs, each compared with the first, from raywatt compare (schema raywatt-compare/1).
import { digits, short } from "./format.js";
import { at, chart, dataset, headline, itemsAt, newView, numberAt, printable, section, table, text, textAt } from "./model.js";
import { partWords } from "./run.js";

/** Figures at the top of a comparison: key, name, unit, format. */
const FIGURES = [
  ["cycles", "Cycles", "", "si"], ["fps", "Frame rate", "frames/s", "number"], ["energy_mj", "Energy", "mJ", "number"],
  ["power_w", "Power", "W", "number"], ["power_at_fps_w", "Power at the target rate", "W", "number"], ["frames_per_joule_gpu", "Efficiency", "frames/J", "number"],
  ["mrays_per_s", "Ray rate", "Mrays/s", "number"], ["dram_bytes", "DRAM traffic", "B", "si"], ["area_mm2", "Area", "mm²", "number"],
];

/** Formats a number with four digits, or from 10,000 on with three digits and a metric prefix. */
const numberText = (value) => (Math.abs(value) >= 1e4 ? short(value) : digits(value));
const valueText = (value, unit, show) => (show === "si" ? short(value, unit) : `${numberText(value)} ${unit}`);

/** Formats the change of a value: "+1.4 %", "x2.08", "new", "gone", "=". */
export function changeText({ a, b }) {
  if (a === b) return "=";
  if (a === 0) return "new";
  if (b === 0) return "gone";
  const times = b / a, change = 100 * (times - 1);
  if (times >= 2) return `x${digits(Number(times.toPrecision(3)))}`;
  return `${change < 0 ? "" : "+"}${change.toFixed(Math.abs(change) < 1 ? 2 : 1)} %`;
}

const changed = ({ a, b }) => {
  const change = Math.abs(100 * (b / a - 1));
  return `${change.toFixed(change < 1 ? 2 : 1)} %`;
};
const besideNoise = ({ noise }) => (noise ? `, which is ${noise.outside ? "outside" : "within"} the noise` : "");
const twoDigits = (value) => String(Number(value.toPrecision(2)));

function pictureWords({ picture }) {
  if (typeof at(picture, "why_not") === "string") return `The pictures are not compared: ${textAt(picture, "why_not")}.`;
  return at(picture, "identical") === true ? "The pictures are identical." : `PSNR of the pictures ${numberAt(picture, "psnr_db").toFixed(2)} dB.`;
}

/** Returns the verdict on two runs. `found`: an entry of `against`; `first`, `second`: names of the runs. */
export function diffVerdict(found, first, second) {
  const links = [{ words: "what made the difference", to: "waterfall" }, { words: "keys that differ", to: "keys" }];
  const cycles = at(found, "figures", "cycles"), energy = at(found, "figures", "energy_mj");
  const hasEnergy = energy && energy.a !== energy.b && energy.a > 0;
  const more = (hasEnergy ? `Energy ${energy.b < energy.a ? "−" : "+"}${changed(energy)}${besideNoise(energy)}. ` : "") + pictureWords(found);
  if (!cycles || !(cycles.a > 0) || !(cycles.b > 0)) return { sentence: `The times of ${second} and ${first} cannot be compared.`, more, links };
  if (cycles.a === cycles.b) return { sentence: `${second} takes as many cycles as ${first}.`, more, links };
  return { sentence: `${second} takes ${changed(cycles)} ${cycles.b < cycles.a ? "fewer" : "more"} cycles than ${first}${besideNoise(cycles)}.`, more, links };
}

function addHeadlines(found, view) {
  for (const [id, name, unit, show] of FIGURES) {
    const pair = at(found, "figures", id);
    if (!pair) continue;
    const noise = pair.noise ? `; ${pair.noise.outside ? "outside" : "within"} a noise of ±${twoDigits(100 * pair.noise.half_width)} %` : "";
    view.headlines.push(headline({ id, name, value: pair.b, show, unit, note: `${changeText(pair)}, was ${valueText(pair.a, unit, show)}${noise}` }));
  }
}

/** Adds a table of all runs side by side, if there are more than two. */
function addOverview({ names, against }, view) {
  if (names.length < 3) return;
  const valueOf = (i, id) => at(against[Math.max(0, i - 1)], "figures", id, i === 0 ? "a" : "b");
  view.data.overview = dataset([["run", "run"], ...FIGURES.map(([id, words, unit, show]) => [id, words, show, unit])],
    names.map((name, i) => [name, ...FIGURES.map(([id]) => valueOf(i, id))]));
  view.sections.push(section("overview", "All runs side by side", "", table("overview-table", "Figures of all runs", "overview")));
}

const LEAST = 0.002;  // changes below this share of the larger total are merged
const MOST_ROWS = 12;
const MARGIN = 0.12;  // space before the smallest end of a bar, as a share of the axis

/**
 * Returns the rows of a waterfall chart: the first total, the changes, the largest first, and the second total. Changes
 * below two thousandths of the larger total, and those after the twelfth, form one row.
 */
export function waterfall(first, a, changes, last, b, unit) {
  const total = (value) => (unit ? `${numberText(value)} ${unit}` : short(Math.abs(value) < 1000 ? Math.round(value) : value));
  const signed = (value) => (value > 0 ? "+" : "−") + total(Math.abs(value));
  const step = (name, from, to) => [name, to - from, from, to, Math.max(from, to), to < from ? "less" : "more", signed(to - from)];
  const sorted = [...changes].sort((x, y) => Math.abs(y.b - y.a) - Math.abs(x.b - x.a));
  const least = LEAST * Math.max(a, b), steps = [];
  let end = a;
  for (const change of sorted) {
    const difference = change.b - change.a;
    if (steps.length === MOST_ROWS || Math.abs(difference) < least) break;
    steps.push(step(change.name, end, end + difference));
    end += difference;
  }
  const left = sorted.length - steps.length;
  if (left > 0 && Math.abs(b - end) > 1e-9 * Math.max(a, b)) steps.push(step(left === 1 ? sorted.at(-1).name : `${left} others`, end, b));
  const ends = [a, b, ...steps.flatMap((row) => [row[2], row[3]])], low = Math.min(...ends), high = Math.max(...ends);
  const begin = Math.max(0, low - MARGIN * (high - low));  // the axis and the bars of both totals begin here
  const bar = (name, value) => [name, null, begin, value, value, "total", total(value)];
  return dataset([["name", "part"], ["change", "change", "si", unit], ["from", "from", "si", unit], ["to", "to", "si", unit], ["right", "right"], ["kind", "kind"], ["label", "shown"]],
    [bar(first, a), ...steps, bar(last, b)]);
}

function addWaterfalls(found, first, second, view) {
  const blocks = [], figures = at(found, "figures");
  const add = (id, figure, changes, unit, format, title, about) => {
    const pair = at(figures, figure);
    if (!pair || changes.length === 0) return;
    view.data[id] = waterfall(first, pair.a, changes, second, pair.b, unit);
    blocks.push(chart(`${id}-waterfall`, title, about, id, { kind: "waterfall", title: unit || "T&I cycles", unit: unit || "cycles", format }));
  };
  add("cycles", "cycles", itemsAt(found, "time").map((p) => ({ ...p, name: partWords(p.name) })), "", "~s", "Cycles of an average core",
    "Cycles of the first run, the change by each part of a core's time, cycles of the second");
  if (blocks.length === 0) blocks.push(text("Both runs spent the same cycles in the same parts."));
  add("energy", "energy_mj", itemsAt(found, "energy_by_block_mj"), "mJ", "~g", "Energy by block, nominal",
    "Energy of the first run, the change by each block, energy of the second");
  view.sections.push(section("waterfall", "What made the difference",
    "From the first run to the second: blue, less; orange, more. The steps add up to the difference. Axes need not begin at 0.", blocks));
}

function addKeys(found, first, second, view) {
  const keys = itemsAt(found, "config");
  if (keys.length > 0) view.data.keys = dataset([["key", "key"], ["a", first], ["b", second]], keys.map((k) => [k.key, k.a || "none", k.b || "none"]));
  view.sections.push(section("keys", "Keys that differ", "", keys.length > 0 ? table("key-table", "Configuration", "keys") : text("The configurations are equal.")));
}

const LISTS = [
  ["ratios", "ratios", "Rates and mean times", "number", ""], ["reasons", "reasons", "Cycles of an average unit, by reason", "si", ""],
  ["events", "energy_by_event_mj", "Energy by event", "number", "mJ"], ["counters", "counters", "Counters", "si", ""],
];

function energyWords(found, first, second) {
  const { draws, gpu, why_not: whyNot } = at(found, "energy_ratio") ?? {};
  if (!gpu) return whyNot ? `Energies are not compared under other tables: ${printable(whyNot)}.` : "";
  const four = (value) => value.toFixed(4);
  return `Energy of ${second} over that of ${first} is ${four(gpu.together.nominal)} under nominal tables, ${four(gpu.interval[0])} to ` +
    `${four(gpu.interval[1])} in 95 % of ${draws} draws of all their entries, and less than 1 in ${(100 * gpu.less).toFixed(1)} % of them.`;
}

function addExplanations(found, first, second, view) {
  const lists = LISTS.filter(([, key]) => itemsAt(found, key).length > 0).map(([id, key, title, show, unit]) => {
    const value = (field, words) => [field, words, show, unit];
    view.data[id] = dataset([["name", "what"], value("a", first), value("b", second), value("difference", "difference"), ["change", "change"]],
      itemsAt(found, key).map((p) => [id === "ratios" ? p.name.replace(" a ", " per ") : p.name, p.a, p.b, p.difference, changeText(p)]));
    return table(`${id}-table`, title, id);
  });
  const energy = energyWords(found, first, second);
  view.sections.push(section("more", "What else has changed", "The largest difference first; headings sort.", lists, energy && text(energy)));
}

export function diffViews(data) {
  const { names, against } = data;
  return against.map((found, i) => {
    const [first, second] = [names[0], names[i + 1]], view = newView(`${second} against ${first}`);
    view.facts = [["First", 0], ["Second", i + 1]].map(([name, run]) => ({ name, value: `${names[run]}: ${data.titles[run]}` }));
    view.notices = data.warnings[i].map((w) => printable(w));
    view.verdict = diffVerdict(found, first, second);
    addHeadlines(found, view);
    addOverview(data, view);
    addWaterfalls(found, first, second, view);
    addKeys(found, first, second, view);
    view.sections.push(section("pictures", "Pictures and tiles",
      "Both pictures, to flip between and to split, and what each tile took in the second run less what it took in the first: blue, less; orange, more.",
      data.pictures[i].missing && text(data.pictures[i].missing), data.pictures[i].type && data.pictures[i]));
    addExplanations(found, first, second, view);
    return view;
  });
}
