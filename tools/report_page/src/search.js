// What the page of a search adds to that of a sweep (tools/studies/report/search_data.h).
import { chart, dataset, section, table, text } from "./model.js";

const percent = (share) => `${(100 * share).toFixed(0)} %`;

function addAnswer(search, view) {
  view.data.answer = dataset([["workload", "workload"], ["frames", "frames"], ["limit", "limit"], ["value", "value", "number"], ["half", "95 % ±", "number"],
    ["room", "room to the limit"], ["met", "met"], ["probability", "probability on all workloads"]], search.limits);
  const broken = search.limits.filter((row) => row[6] !== "yes").length;
  const whole = search.limits.every((row) => row[1] === "whole");
  const check = search.limits.length === 0 ? "" : `${whole ? "Whole frames" : "Sampled frames"} of it ${broken === 0 ? "meet every limit" : `break ${broken} limits`}${search.checked ? ", as --check found" : ""}. `;
  const odds = search.probability === null ? "" : `By the noise and the bands of the energy and area tables it meets all limits with a probability of ${percent(search.probability)}.`;
  return section("answer", "The answer", `${search.sentence} ${check}${odds}`,
    text(`Fidelity: ${search.fidelity}.`),
    search.limits.length > 0 && table("answer-table", "Limits on each workload", "answer"));
}

function addCharts(search, view) {
  const blocks = [];
  if (search.scatter) {
    const { x, y, limit, rows } = search.scatter;
    view.data.limited = dataset([["n", "machine", "number"], ["x", x, "number"], ["y", y, "number"], ["x_low", `${x}, low`, "number"], ["x_high", `${x}, high`, "number"],
      ["y_low", `${y}, low`, "number"], ["y_high", `${y}, high`, "number"], ["place", "place"], ["axes", "axes"],
      ["band_low", `${x}, tables: 10 %`, "number"], ["band_high", `${x}, tables: 90 %`, "number"]], rows);
    blocks.push(chart("limited", `${y} against ${x}, with the limit`, `All machines by ${y} and ${x}, with 95 % intervals, and 80 % of the draws of the energy tables for the best; the limit of ${limit} is a dashed line`, "limited",
      { kind: "limited", xTitle: x, yTitle: y, limit }));
  }
  if (search.shares.length > 0) {
    view.data.shares_of_limits = dataset([["name", "workload and figure"], ["share", "share of the limit", "percent"], ["label", "value"]], search.shares);
    blocks.push(chart("shares-of-limits", "The best machine on each workload, as shares of the limits", "Bars of each figure on each workload divided by its limit; the limit is a dashed line", "shares_of_limits",
      { kind: "shares" }));
  }
  return blocks.length === 0 ? null : section("room", "Room to the limits", "The worst workload counts. Machines that a workload ruled out have the values of the workloads before it. Thin lines are 95 % intervals by the noise; the wide one holds 80 % of the draws of the energy tables for the best machine.", blocks);
}

function addTrades(search, view) {
  if (search.trades.rows.length === 0) return null;
  view.data.trades = dataset([["axis", "axis"], ["from", "best"], ["to", "instead"], ["gain", `gain in ${search.objective}`, "number"],
    ...search.trades.metrics.map((metric, i) => [`m${i}`, metric, "number"]), ["breaks", "breaks"], ["values", "values are"]], search.trades.rows);
  return section("trades", "Around the best machine", "One axis at a time: what changes, which limit breaks, and what a wider limit or a larger machine would buy.",
    search.trade_sentences.map((sentence) => text(`${sentence}.`)),
    table("trades-table", "Neighbours of the best machine", "trades"));
}

function addCommands(search, view) {
  if (search.commands.length === 0) return null;
  view.data.commands = dataset([["workload", "workload"], ["command", "command"]], search.commands);
  return section("commands", "Commands", "They run the best machine again.", table("commands-table", "The best machine again", "commands"));
}

/** Puts the answer of a search first. */
export function addSearch(search, view) {
  const own = [addAnswer(search, view), addCharts(search, view), addTrades(search, view), addCommands(search, view)];
  view.sections.unshift(...own.filter(Boolean));
}
