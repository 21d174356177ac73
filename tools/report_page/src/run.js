// The view of a run, from its report and what C++ adds to it (tools/studies/report/report.h).
import { counted, digits, percent, short } from "./format.js";
import { at, capital, chart, dataset, entriesAt, flattened, hasNumber, headline, itemsAt, newView, numberAt, printable, section, table, text, textAt } from "./model.js";

// Colours on a light ground; theme.js maps them to those on a dark one. Neighbours differ in hue and in lightness.
const WORK = ["#2b6cb0", "#63a0d8", "#a9cbea"], WAIT = ["#b85c12", "#e0964a", "#f2c793"], TRACE = ["#17736d", "#4aa89a", "#9cd3c7"];
const TREE = ["#6b4a95", "#a184c2", "#cebfdf"], RASTER = ["#b3446c", "#d487a3", "#ecc4d2"], RASTER_WORK = "#7a7414";
const REST = "#8a9099", PALE_REST = "#d3d7dc";
const BLOCKS = { tni: TRACE[0], srp: WORK[0], l2: TREE[0], tile_buffer: TREE[1], dma: WORK[1], interconnect: REST, dram: WAIT[0], raster: RASTER[0], build: RASTER[1] };

/**
 * Parts of a core's time (totals.top_down): group, level of a miss, name, colour, whether its text is dark, meaning.
 */
const PARTS = [
  ["kernels", "", "kernels", WORK[0], false, "a kernel's loop ran on the array"],
  ["switches", "", "kernel switches", WORK[1], true, "the array was configured for another kernel"],
  ["banks", "", "tile-buffer banks", WORK[2], true, "bank conflicts in the tile buffer"],
  ["data_misses", "interconnect", "data-cache misses: interconnect", WAIT[2], true, "the array was stalled for a line of the data cache, which was between core and L2"],
  ["data_misses", "l2", "data-cache misses: L2", WAIT[1], true, "the array was stalled for a line of the data cache, which was in the L2"],
  ["data_misses", "dram", "data-cache misses: DRAM", WAIT[0], false, "the array was stalled for a line of the data cache, which was in memory"],
  ["boxes", "", "box tests", TRACE[0], false, "the array waited for rays, traversal units tested nodes"],
  ["triangles", "", "triangle tests", TRACE[1], true, "the array waited for rays, triangles were tested"],
  ["pipes", "", "T&I pipelines", TRACE[2], true, "too few rays to fill the pipelines of the T&I unit"],
  ["tree_misses", "interconnect", "tree misses: interconnect", TREE[2], true, "rays waited for a line of nodes or triangles, which was between core and L2"],
  ["tree_misses", "l2", "tree misses: L2", TREE[1], true, "rays waited for a line of nodes or triangles, which was in the L2"],
  ["tree_misses", "dram", "tree misses: DRAM", TREE[0], false, "rays waited for a line of nodes or triangles, which was in memory"],
  ["raster", "", "rasteriser", RASTER_WORK, false, "no ray was in flight, the rasteriser of the core worked"],
  ["raster_misses", "interconnect", "rasteriser's misses: interconnect", RASTER[2], true, "the rasteriser waited for a line, which was between core and L2"],
  ["raster_misses", "l2", "rasteriser's misses: L2", RASTER[1], true, "the rasteriser waited for a line, which was in the L2"],
  ["raster_misses", "dram", "rasteriser's misses: DRAM", RASTER[0], false, "the rasteriser waited for a line, which was in memory"],
  ["build", "", "tree builder", RASTER_WORK, false, "no core had a tile, the tree builder worked"],
  ["build_misses", "interconnect", "tree builder's misses: interconnect", RASTER[2], true, "the tree builder waited for a line, which was between core and L2"],
  ["build_misses", "l2", "tree builder's misses: L2", RASTER[1], true, "the tree builder waited for a line, which was in the L2"],
  ["build_misses", "dram", "tree builder's misses: DRAM", RASTER[0], false, "the tree builder waited for a line, which was in memory"],
  ["transfers", "", "transfers", REST, false, "no ray was in flight, launches waited for the DMA"],
  ["no_tile", "", "no tile", PALE_REST, true, "the core had no tile"],
].map(([group, level, words, colour, pale, meaning]) => ({ group, level, words, colour, pale, meaning }));
const shareOf = (time, { group, level }) => (level ? numberAt(time, group, level) : numberAt(time, group));

/** Returns the description of a part of totals.top_down, such as "tree_misses.dram". */
export const partWords = (name) => PARTS.find((p) => name === (p.level ? `${p.group}.${p.level}` : p.group))?.words ?? name;

/** Returns a function from a path, such as "core.tni.trv.counters.l1_hits", to its sum over all units of a kind. */
export function unitSums(units) {
  const sums = new Map();
  const add = (path, value) => sums.set(path, (sums.get(path) ?? 0) + value);
  function visit(node, path) {
    const kindOf = (name) => (Object.hasOwn(node, `${name.replace(/\d+$/, "")}0`) ? name.replace(/\d+$/, "") : name);
    for (const [key, value] of entriesAt(node)) {
      if (typeof value === "number") add(path + key, value);
      else visit(value, `${path}${kindOf(key)}.`);
    }
    if (hasNumber(node, "elapsed")) add(`${path}units`, 1);
  }
  visit(units, "");
  return (path) => sums.get(path) ?? 0;
}

/** Returns the data of the view: the report, its totals, sums over units, and seconds of the run. */
function runOf(data) {
  const { report } = data, totals = at(report, "totals") ?? {}, sum = unitSums(at(report, "units"));
  const share = (unit, reasons) => {
    const elapsed = sum(`${unit}.elapsed`);
    return elapsed > 0 ? reasons.reduce((all, reason) => all + sum(`${unit}.why.${reason}`), 0) / elapsed : 0;
  };
  return { ...data, report, totals, sum, share, seconds: numberAt(totals, "time_ms") / 1e3 };
}

const WORTH_SAYING = 1.01;  // speed-up below which no resource is named as the limit

/** Returns the estimated speed-up by each ideal resource, the largest first. */
function boundsOf({ totals, resources }) {
  return entriesAt(totals, "bottleneck", "estimated_speedup").filter(([, speedup]) => typeof speedup === "number")
    .map(([name, speedup]) => ({ words: resources[name] ?? printable(name), speedup })).sort((a, b) => b.speedup - a.speedup);
}

function addVerdict(run, view) {
  const bounds = boundsOf(run), cycles = { words: "where the cycles went", to: "cycles" };
  const links = [cycles, { words: "what each resource is worth", to: "bounds" }];
  if (bounds.length === 0) {
    view.verdict = { sentence: "This report does not say what limits the run.", more: "It has no estimate of the limits.", links: [cycles] };
    return;
  }
  const [first, next] = bounds;
  const source = "An estimate from this run's counters; raywatt bottleneck measures it.";
  view.verdict = first.speedup < WORTH_SAYING
    ? { sentence: "No single resource limits this run: none would gain 1 % if ideal.", more: "", links }
    : { sentence: `${capital(first.words)} limit this run: ×${first.speedup.toFixed(2)} if ideal.`,
      more: next ? `Next: ${next.words}, ×${next.speedup.toFixed(2)} if ideal. ${source}` : source, links };
  view.data.bounds = dataset([["resource", "resource made ideal"], ["speedup", "speed-up", "number"], ["label", "shown"]],
    bounds.map((b) => [capital(b.words), b.speedup, `×${b.speedup.toFixed(2)}`]));
}

/** Name, unit, format, note and path below totals of each headline. A path to a band gives its nominal value. */
const HEADLINES = [
  ["time_ms", "Time", "ms", "number", "", "time_ms"],
  ["fps", "Frame rate", "frames/s", "number", "", "perf.fps"],
  ["energy_mj", "Energy", "mJ", "number", "GPU with memory, low to high", "energy_mj"],
  ["power_w", "Power", "W", "number", "GPU with memory, low to high", "power_w"],
  ["power_at_fps_w", "Power at the target rate", "W", "number", "with idle time, low to high", "power_at_fps_w"],
  ["fps_margin", "Rate over target", "×", "number", "of the slowest frame; 1 and more: met", "fps_margin"],
  ["frames_per_joule_gpu", "Efficiency", "frames/J", "number", "GPU with memory, nominal", "perf.frames_per_joule_gpu"],
  ["nj_per_ray", "Energy of a ray", "nJ", "number", "nominal", "perf.nj_per_ray"],
  ["mrays_per_s", "Ray rate", "Mrays/s", "number", "", "perf.mrays_per_s"],
  ["rays", "Rays", "", "si", "", "rays.total"],
  ["cycles", "Cycles", "", "si", "of the T&I clock", "cycles"],
  ["area_mm2", "Area", "mm²", "number", "low to high", "area_band_mm2"],
  ["traced_ratio", "Samples traced", "", "percent", "of those of the picture", "traced_ratio"],
];

function addHeadlines({ report, totals }, view) {
  for (const [id, name, unit, show, note, path] of HEADLINES) {
    const found = at(totals, ...path.split(".")), hasBand = hasNumber(found, "nominal");
    const value = hasBand ? found.nominal : found;
    if (typeof value !== "number" || (id === "traced_ratio" && value === 1)) continue;
    view.headlines.push(headline({ id, name, value, show, unit, note, low: hasBand ? at(found, "low") : null, high: hasBand ? at(found, "high") : null }));
  }
  const time = view.headlines.find((f) => f.id === "time_ms");
  for (const [by, note] of [["sampled", "estimated from sampled tiles, 95 % interval"], ["representative", "estimated from representative frames, 95 % interval"], ["sliced", "sum of slices, 95 % interval"]]) {
    const interval = at(totals, by, "time_ms");
    if (time && hasNumber(interval, "low") && hasNumber(interval, "high")) Object.assign(time, { low: interval.low, high: interval.high, note });
  }
  const identical = at(totals, "identical");
  if (typeof identical === "boolean") {
    view.headlines.push(headline({ id: "psnr_db", name: "Picture", value: identical ? "identical" : at(totals, "psnr_db"), unit: identical ? "" : "dB", note: "PSNR against the reference program" }));
    const change = at(totals, "temporal_psnr_db");
    if (Object.hasOwn(totals, "temporal_psnr_db"))
      view.headlines.push(headline({ id: "temporal_psnr_db", name: "Flicker", value: change ?? "none", unit: change === null ? "" : "dB", note: "PSNR of the worst change from frame to frame" }));
    if (hasNumber(totals, "relative", "speedup"))
      view.headlines.push(headline({ id: "speedup", name: "Speed", value: totals.relative.speedup, unit: "×", note: "against the reference program" }));
  }
  const of = (count, words, ...keys) => counted(numberAt(count, ...keys), words);
  view.facts.push(
    { name: "Scene", value: [textAt(report, "scene", "name"), of(report, "triangle", "scene", "triangles"), of(report, "light", "scene", "lights")].join(", ") },
    { name: "Picture", value: `${numberAt(report, "resolution", 0)}x${numberAt(report, "resolution", 1)}` },
    { name: "Program", value: textAt(report, "program") },
    { name: "Machine", value: `${of(report, "core", "config", "cores")}, ${of(report, "traversal unit", "config", "tni", "trvs")} each, T&I at ${textAt(report, "config", "clocks", "tni")}` });
  if (at(report, "partial") === true) view.notices.push("This run was interrupted: its figures are those of the finished part.");
  const timed = numberAt(totals, "sampled", "timed"), tiles = numberAt(totals, "sampled", "tiles");
  if (timed < tiles) view.notices.push(`Timed: ${timed} of ${counted(tiles, "tile")}; all other figures are estimates.`);
  const simulated = numberAt(totals, "representative", "simulated"), sequence = numberAt(totals, "representative", "frames");
  if (simulated < sequence) view.notices.push(`Simulated: ${simulated} of ${counted(sequence, "frame")}; all other figures are estimates.`);
  view.notices.push(...itemsAt(report, "warnings").filter((w) => typeof w === "string").map((w) => printable(w)));
}

/** Series over time by group: name, title, description, whether they are stacked. */
const GROUPS = [
  ["power", "Power by block", "power of each block of the GPU over time", true],
  ["power_by_kind", "Power by kind", "dynamic, clock and leakage power over time", true],
  ["bandwidth", "Bandwidth", "bandwidth of memory and of the L2 over time", false],
  ["hit_rate", "Hit rates", "hit rates of caches over time", false],
  ["utilisation", "Utilisation", "utilisation of T&I units, shader cores and memory over time", false],
  ["stack.srp", "Cycles of the shader cores", "shares of the shader cores' cycles by reason over time", true],
  ["stack.tni", "Cycles of the traversal units", "shares of the traversal units' cycles by reason over time", true],
  ["stack.ist", "Cycles of the intersection units", "shares of the intersection units' cycles by reason over time", true],
  ["stack.dram", "Cycles of the memory channels", "shares of the channels' cycles by reason over time", true],
  ["rays", "Rays traced", "rays traced per second over time", false],
  ["rays_in_flight", "Rays in flight", "rays inside the T&I units over time", false],
];

function addSeries({ series }, view) {
  const charts = [];
  for (const [group, title, about, stacked] of GROUPS) {
    const members = (series.all ?? []).filter((s) => s.group === group && !(stacked && s.name === "total"));
    if (members.length === 0) continue;
    const { unit } = members[0], names = members.map((s) => s.name), data = `series ${group}`;
    view.data[data] = dataset([["begin_us", "from", "number", "us"], ["end_us", "to", "number", "us"], ...names.map((n) => [n, n, "number", unit])],
      series.begin_us.map((begin, i) => [begin, series.end_us[i], ...members.map((s) => s.values[i])]));
    const colours = names.every((n) => Object.hasOwn(BLOCKS, n)) ? names.map((n) => [n, BLOCKS[n]]) : [];
    charts.push({ id: group, name: title, about, data, chart: { kind: "series", names, unit, stacked, colours } });
  }
  view.sections.push(section("time", "Over time",
    "Brush a stretch of time, and the picture above shows the tiles that were in flight in it; point at a tile, and its time is marked here.",
    series.note && text(series.note), charts.length > 0 && { type: "series", id: "series", title: "Over time", charts }));
}

/** Units: title, path, reasons of cycles at peak rate, counters of the items processed then, name of an item. */
const PEAKS = [
  ["Traversal units: box pipes", "core.tni.trv", ["visiting"], ["visits"], "nodes"],
  ["Intersection units: triangle pipes", "core.tni.ist", ["testing"], ["tests"], "triangles"],
  ["Ray dispatchers", "core.tni.dispatcher", ["dispatching"], ["rays_in"], "rays"],
  ["Shader cores: arrays", "core.srp", ["running"], ["items"], "items"],
  ["Core ports to the L2", "core.cache_port", ["line"], ["lines_down", "lines_up"], "lines"],
  ["Core ports of the DMA", "core.dma_port", ["line"], ["lines_down", "lines_up"], "lines"],
  ["DMA", "core.dma", ["moving"], ["lines_written", "lines_read"], "lines"],
  ["L2 banks", "l2.bank", ["serving"], ["reads", "writes"], "look-ups"],
  ["DRAM data buses", "dram.channel", ["reading", "writing"], ["bytes"], "B"],
];

function addUnits({ sum, share, seconds }, view) {
  const rows = PEAKS.filter(([, unit]) => sum(`${unit}.elapsed`) > 0).map(([words, unit, reasons, counters, each]) => {
    const busy = share(unit, reasons);
    const rate = seconds > 0 ? counters.reduce((all, name) => all + sum(`${unit}.counters.${name}`), 0) / seconds : 0;
    const suffix = each === "B" ? "B/s" : "", of = each === "B" ? "" : ` ${each}/s`;
    const rates = rate > 0 && busy > 0 ? `, ${short(rate, suffix)}${of}, ${short(rate / busy, suffix)} when busy` : "";
    return [words, busy, rate, each, sum(`${unit}.units`), percent(busy) + rates];
  });
  view.data.peaks = dataset([["unit", "unit"], ["share", "of its peak", "percent"], ["rate", "rate", "si"], ["each", "of"], ["units", "units", "number"], ["label", "shown"]], rows);
  view.sections.push(section("units", "Units, in percent of their peak",
    "The share of its cycles in which a unit worked at its peak rate. The reasons for the other cycles are listed by unit in the next section.",
    rows.length === 0 ? text("This report has no counters.")
      : chart("peaks", "Busy at their peak", "Share of the cycles of each kind of unit in which it worked at its peak rate", "peaks",
        { kind: "bars", name: "unit", value: "share", title: "of the unit's peak", format: ".0%", label: "label", domain: [0, 1] })));
}

const KINDS = [
  ["working", "own work, or the latency of own pipelines", WORK[0]], ["waiting", "for another unit", WAIT[1]],
  ["idle", "nothing to do, the clock is gated", PALE_REST], ["background", "independent of work, such as refresh", TRACE[2]],
];

function addReasons({ unit_kinds: units, sum }, view) {
  const reasons = [], kinds = [];
  for (const unit of units) {
    const elapsed = sum(`${unit.name}.elapsed`), byKind = KINDS.map(() => 0);
    if (elapsed === 0) continue;
    for (const { name, kind, meaning } of unit.reasons) {
      const share = sum(`${unit.name}.why.${name}`) / elapsed;
      byKind[kind] += share;
      if (share > 0) reasons.push([unit.name, name, KINDS[kind][0], share, meaning]);
    }
    KINDS.forEach(([kind, meaning], k) => kinds.push([unit.name, kind, byKind[k], k, k >= 1, meaning]));
  }
  const share = ["share", "share of its cycles", "percent"];
  view.data.reasons = dataset([["unit", "unit"], ["reason", "reason"], ["kind", "kind"], share, ["meaning", "meaning"]], reasons);
  view.data.kinds = dataset([["unit", "unit"], ["kind", "kind"], share, ["order", "order", "number"], ["pale", "pale"], ["meaning", "meaning"]], kinds);
}

function addCycles(run, view) {
  const { totals } = run, reference = at(totals, "reference", "top_down"), all = at(totals, "top_down", "gpu");
  const cycles = section("cycles", "Where the cycles went",
    "Every cycle of a core is in one part, as seen from its shader core. Blue: the array was busy. Orange: it was stalled for data. " +
    "Green and purple: it waited while rays were traced. Olive and red: it waited while the rasteriser or the tree builder worked. Grey: there was nothing to do.");
  view.sections.push(cycles);
  if (all === null) return cycles.blocks.push(text("This report has no cycle stacks."));
  const parts = PARTS.filter((p) => !/^(raster|build)/.test(p.group) || shareOf(all, p) > 0 || shareOf(reference, p) > 0);
  const cores = itemsAt(totals, "top_down", "cores");
  const stacks = [["all cores", all], ...(cores.length > 1 ? cores.map((time, i) => [`core ${i}`, time]) : []), ...(reference ? [["reference program", reference]] : [])];
  view.data.stacks = dataset([["who", "core"], ["part", "part"], ["share", "share of time", "percent"], ["order", "order", "number"], ["pale", "pale"], ["meaning", "meaning"]],
    stacks.flatMap(([name, time]) => parts.map((p, i) => [name, p.words, shareOf(time, p), i, p.pale, p.meaning])));
  addReasons(run, view);
  cycles.blocks.push(
    chart("stacks", "Cycle stacks of the cores", "Shares of each core's time by part", "stacks",
      { kind: "stack", name: "who", nameTitle: "core", part: "part", share: "share", colours: parts.map((p) => [p.words, p.colour]) }),
    ...(view.data.bounds ? [chart("bounds", "What each resource would be worth, made ideal", "Estimated speed-up of the frame for each resource made ideal, one at a time", "bounds",
      { kind: "bars", name: "resource", value: "speedup", title: "times as fast", label: "label", from: 1 })] : []),
    chart("kinds", "Cycles of every unit by kind", "Shares of the cycles of each kind of unit: working, waiting, idle, background", "kinds",
      { kind: "stack", name: "unit", part: "kind", share: "share", colours: KINDS.map(([kind, , colour]) => [kind, colour]) }),
    table("reasons", "Every reason of every unit", "reasons"));
}

function addEnergy({ totals, flow, not_priced: notPriced }, view) {
  const mj = (name) => [name, name, "number", "mJ"], all = numberAt(totals, "energy_mj", "nominal");
  const rowsOf = (group, prefix) => entriesAt(totals, group).map(([name, band]) => {
    const nominal = numberAt(band, "nominal");
    return [prefix + printable(name), numberAt(band, "low"), nominal, numberAt(band, "high"), all > 0 ? nominal / all : 0];
  });
  view.data.blocks = dataset([["block", "block"], mj("low"), mj("nominal"), mj("high"), ["share", "share, nominal", "percent"]],
    [...rowsOf("energy_by_block_mj", ""), ...rowsOf("energy_by_kind_mj", "of all: ")]);
  if (flow) view.data.flow = dataset([["from", "from"], ["to", "to"], mj("low"), mj("nominal"), mj("high")], flow);
  view.sections.push(section("energy", "Where the energy went",
    "From the total to its blocks to their counted events, clock tree and leakage. The flow counts the standby energy of memory as an event, " +
    "the table as leakage. The band is that of the energy tables; ratios under one side are more reliable than the joules of one.",
    flow ? { type: "sankey", id: "flow", title: "Energy by block, event, clock and leakage", data: "flow", about: "Flow of energy from the total through blocks to events, clock and leakage, in mJ" }
      : text(`Energy by event is not shown under low and high tables: ${notPriced}`),
    table("blocks", "Energy by block, and by kind", "blocks")));
}

function addKernels({ totals, kernels: known }, view) {
  const kernels = entriesAt(totals, "kernels").sort(([, a], [, b]) => numberAt(b, "share") - numberAt(a, "share"));
  const lead = "A kernel is a loop; its initiation interval (II) is the number of cycles from one item to the next.";
  if (kernels.length === 0) return view.sections.push(section("kernels", "Kernels on the shader cores", lead, text("No kernel ran.")));
  const over = (a, b) => (b > 0 ? a / b : null);
  view.data.kernels = dataset([["kernel", "kernel"], ["share", "share of SRP cycles", "percent"], ["label", "shown"], ["ii", "II", "number", "cycles"],
    ["bound", "II is bound by"], ["depth", "depth", "number", "cycles"], ["items", "items", "si"], ["launches", "launches", "si"], ["cycles", "cycles", "si"],
    ["per_item", "cycles per item", "number"], ["starved", "T&I unit starved", "percent"], ["meaning", "what it does"]],
  kernels.map(([name, k]) => [printable(name), numberAt(k, "share"), percent(numberAt(k, "share")), at(k, "ii"), at(known, name, "bound"), at(k, "depth"), at(k, "items"),
    at(k, "launches"), numberAt(k, "cycles"), over(numberAt(k, "cycles"), numberAt(k, "items")), over(numberAt(k, "starved"), numberAt(k, "cycles")), at(known, name, "meaning")]));
  view.sections.push(section("kernels", "Kernels on the shader cores", lead,
    chart("kernel-shares", "Shares of the shader cores' cycles", "Share of the cycles of all kernels, by kernel", "kernels",
      { kind: "bars", name: "kernel", value: "share", title: "of the cycles of all kernels", format: ".0%", label: "label" }),
    table("kernel-table", "Intervals, and what bounds them", "kernels")));
}

/** Caches: title, unit, and its counters of accesses, hits, fills and miss cycles. */
const CACHES = [
  ["node L1", "core.tni.trv", "l1_accesses", "l1_hits", "l1_fills", "l1_miss_cycles"],
  ["triangle L1", "core.tni.ist", "l1_accesses", "l1_hits", "l1_fills", "l1_miss_cycles"],
  ["data cache", "core.srp", "cache_accesses", "cache_hits", "cache_fills", "cache_miss_cycles"],
  ["L2", "l2.bank", "reads", "hits", "fills", "line_cycles"],
];

function dramRows({ report, totals, sum, share, seconds }) {
  const count = (name) => sum(`dram.channel.counters.${name}`), lines = count("reads") + count("writes");
  const bus = share("dram.channel", ["reading", "writing"]), rate = seconds > 0 ? numberAt(totals, "dram_bytes") / seconds : 0;
  if (!(lines > 0) || !(bus > 0)) return [];
  const longest = Math.max(0, ...entriesAt(report, "units", "dram").map(([, channel]) => numberAt(channel, "counters", "read_latency_max")));
  return [
    ["bandwidth used", `${short(rate, "B/s")} of ${short(rate / bus, "B/s")} (${percent(bus)})`],
    ["lines whose row was open", percent(count("row_hits") / lines)],
    ["lines for which another row was closed", percent(count("row_conflicts") / lines)],
    ["mean read latency", `${(count("read_latency") / count("reads")).toFixed(1)} command clocks`],
    ["longest read latency of a channel", `${longest.toFixed(0)} command clocks`],
    ["cycles in refresh", percent(share("dram.channel", ["refresh"]))]];
}

function addMemory(run, view) {
  const { totals, sum } = run, all = numberAt(totals, "dram_bytes");
  view.data.caches = dataset([["cache", "cache"], ["rate", "hit rate", "percent"], ["label", "shown"], ["accesses", "accesses", "si"], ["fills", "lines filled", "si"],
    ["miss", "cycles from miss to line", "number"], ["units", "of them", "number"]],
  CACHES.flatMap(([words, unit, ...names]) => {
    const [accesses, hits, fills, cycles] = names.map((name) => sum(`${unit}.counters.${name}`));
    return accesses === 0 ? [] : [[words, hits / accesses, percent(hits / accesses), accesses, fills, fills > 0 ? cycles / fills : null, sum(`${unit}.units`)]];
  }));
  view.data.traffic = dataset([["client", "client"], ["bytes", "bytes", "si", "B"], ["share", "share", "percent"], ["label", "shown"]],
    entriesAt(totals, "dram_bytes_by_client").filter(([, bytes]) => typeof bytes === "number" && all > 0)
      .map(([name, bytes]) => [printable(name.replaceAll("_", " ")), bytes, bytes / all, `${short(bytes, "B")}, ${percent(bytes / all)}`]));
  view.data.dram = dataset([["what", "memory channels"], ["value", "value"]], dramRows(run));
  view.sections.push(section("memory", "Caches and memory", "",
    chart("hit-rates", "Hit rates", "Hit rate of each kind of cache", "caches", { kind: "bars", name: "cache", value: "rate", title: "of its accesses, retries included", format: ".0%", label: "label" }),
    table("cache-table", "Caches, all units of a kind", "caches"),
    chart("traffic", "DRAM traffic by client", "Bytes over the memory channels, by client", "traffic", { kind: "bars", name: "client", value: "bytes", title: "bytes", format: "~s", label: "label" }),
    table("dram-table", "Memory channels", "dram")));
}

const BEYOND = 5;  // factor by which the axis extends beyond the points of interest

/** Adds the roofline. Ceilings: rays per second if only that resource limited, with this frame's work per ray. */
function addRoofline({ totals, share, seconds }, view) {
  const rays = numberAt(totals, "rays", "total"), bytes = numberAt(totals, "dram_bytes"), bus = share("dram.channel", ["reading", "writing"]);
  const lead = "Rays per second against bytes of DRAM traffic per ray. Ceilings are what each resource would allow if it were always busy at its peak, with this frame's work per ray.";
  if (!(rays > 0 && bytes > 0 && seconds > 0 && bus > 0))
    return view.sections.push(section("roofline", "Roofline", lead, text("This run moved no bytes, or has no counters, so there is no roofline.")));
  const rate = rays / seconds, perRay = bytes / rays, bandwidth = bytes / seconds / bus;
  const ceilings = [["T&I units", share("core.tni.trv", ["visiting"])], ["shader cores", share("core.srp", ["running", "switching"])]]
    .filter(([, busy]) => busy > 0).map(([name, busy]) => ({ name, at: rate / busy })).sort((a, b) => b.at - a.at);
  const most = ceilings[0]?.at ?? rate, least = ceilings.at(-1)?.at ?? rate;
  const low = Math.min(perRay, bandwidth / most) / BEYOND, high = Math.max(perRay, bandwidth / least) * BEYOND;
  const isLeft = Math.log(perRay / low) < Math.log(high / low) / 2;
  const line = (words, ceiling, unit, atLow, atHigh, label) => {
    const name = `${words}: ${short(ceiling, unit)}`;
    return [[name, low, atLow, words, label], [name, high, atHigh, words, ""]];
  };
  view.data.roofline = dataset([["name", "what"], ["x", "DRAM bytes per ray", "si", "B"], ["y", "rays per second", "si", "rays/s"], ["line", "ceiling"], ["label", "labelled"]], [
    [`this run: ${short(rate, "rays/s")} at ${short(perRay, "B")} a ray`, perRay, rate, "", isLeft ? "right of point" : "left of point"],
    ...line("DRAM", bandwidth, "B/s", bandwidth / low, bandwidth / high, "above"),
    ...ceilings.flatMap((c, i) => line(c.name, c.at, "rays/s", c.at, c.at, i === 0 ? "above" : "below"))]);
  view.sections.push(section("roofline", "Roofline", lead, chart("roofline-chart", "Rays per second against bytes per ray",
    "This run below the ceilings of memory, T&I units and shader cores, on logarithmic axes", "roofline", { kind: "roofline" })));
}

/** "5.1 ms, 7.2 mJ, picture 38.1 dB, change 40.2 dB" of a frame. */
function frameWords(f) {
  const decibels = (words, key) => Object.hasOwn(f, key) && `${words} ${f[key] === null ? "identical" : `${digits(f[key])} dB`}`;
  return [`${digits(numberAt(f, "time_ms"))} ms`, `${digits(numberAt(f, "energy_mj", "nominal"))} mJ`, decibels("picture", "psnr_db"),
    decibels("change", "temporal_psnr_db")].filter(Boolean).join(", ");
}

function addFrames({ report, film }, view) {
  const frames = itemsAt(report, "frames");
  if (frames.length < 2) return;
  const compared = frames.some((f) => Object.hasOwn(f, "temporal_psnr_db"));
  view.data.frames = dataset([["frame", "frame", "number"], ["time_ms", "time", "number", "ms"], ["energy_mj", "energy", "number", "mJ"], ["rays", "rays", "si"], ["limiter", "limited by"],
    ...(compared ? [["psnr_db", "PSNR", "number", "dB"], ["temporal_psnr_db", "PSNR of the change", "number", "dB"]] : [])],
  frames.map((f) => [at(f, "frame"), at(f, "time_ms"), at(f, "energy_mj", "nominal"), at(f, "rays", "total"), textAt(f, "limiter"),
    ...(compared ? [at(f, "psnr_db"), at(f, "temporal_psnr_db")] : [])]));
  const line = (y, yTitle) => ({ kind: "lines", x: "frame", xTitle: "frame", xFormat: "d", y, yTitle });
  const words = new Map(frames.map((f) => [at(f, "frame"), frameWords(f)]));
  view.sections.push(section("frames", "Frames", Number.isFinite(numberAt(report, "totals", "representative", "frames"))
    ? `Simulated frames. The figures above are estimates for all ${numberAt(report, "totals", "representative", "frames")} frames.` : "The figures above are sums and means of all frames.",
    film && { ...film, frames: film.frames.map((f) => ({ ...f, words: words.get(f.frame) ?? "" })) },
    chart("frame-times", "Time of each frame", "Time of each frame in milliseconds", "frames", line("time_ms", "ms")),
    chart("frame-energies", "Energy of each frame", "Nominal energy of each frame in millijoules", "frames", line("energy_mj", "mJ")),
    compared && chart("frame-flicker", "PSNR of the change since the frame before",
      "PSNR of the difference of consecutive frames against that of the reference, by frame, in decibels", "frames", line("temporal_psnr_db", "dB"))));
}

const ORIGIN = [["version", "version"], ["commit", "git"], ["model", "model_id"], ["configuration", "config_hash"], ["scene", "scene_sha256"], ["tree", "bvh_hash"], ["compiler", "compiler"]];

function addOrigin({ report, command }, view) {
  const rows = [...ORIGIN.map(([words, key]) => [words, textAt(report, "provenance", key)]), ["date", textAt(report, "host", "date")], ["command", command]];
  view.data.origin = dataset([["what", "what"], ["value", "value"]], rows.filter(([, value]) => value));
  view.data.config = dataset([["key", "key"], ["value", "value"]], flattened(at(report, "config")));
  view.sections.push(section("origin", "Where this comes from", "", table("origin-table", "Program, inputs, command", "origin"),
    table("config", "Configuration, every key", "config", { folded: true })));
}

/** Meaning of the colours in debug pictures (docs/adaptive.md), by the beginning of the picture's name. */
const DEBUG = [
  ["similar", "yellow: interpolated; blue: traced; green: traced by post-correction; grey: references"],
  ["interpolated", "the picture where it is interpolated, black elsewhere"],
  ["check ", "white: samples that failed this check, over the darkened picture"],
  ["rates", "blocks of a tile: dark 2, bright 4; green: similar, red: not similar"],
  ["propagated", "white: pixels corrected by rounds of propagation"],
  ["active", "active sub-pixels of a pixel: black, red, green, blue, white for 0 to 4"],
  ["differs ", "white: pixels with an active sub-pixel whose attribute disagreed"],
  ["weights", "remaining weight of the shaded samples at all samples of a pixel: white 1, black 0"],
  ["edges ", "white: pixels with a sample that this filter separates from a shaded one"],
  ["overdraw", "triangles that cover a pixel: black none, blue one, red eight or more"],
  ["quads", "quads of triangles that contain a pixel: black none, blue one, red eight or more"],
];

function pictureBlock(picture) {
  if (!picture.type) return text(picture.missing);
  const overlays = picture.debug.map(({ name, picture: url }) => ({ id: `debug ${name}`, picture: url,
    name: name.replace(/^check /, "failed check: "), note: DEBUG.find(([begin]) => name.startsWith(begin))?.[1] ?? "" }));
  return { ...picture, overlays };
}

export function runView(data) {
  const run = runOf(data), view = newView(data.title);
  addVerdict(run, view);
  addHeadlines(run, view);
  view.sections.push(section("picture", "The picture", "", pictureBlock(data.picture)));
  for (const add of [addSeries, addUnits, addCycles, addEnergy, addKernels, addMemory, addRoofline, addFrames, addOrigin]) add(run, view);
  return view;
}
