// The page of a search.
import assert from "node:assert/strict";
import fs from "node:fs";
import { test } from "node:test";
import { at, look, numberOf, program } from "./surroundings.mjs";

const cells = (line) => line.match(/("([^"]|"")*"|[^,]*)(,|$)/g).map((cell) => cell.replace(/,$/, ""));
const table = (...names) => {
  const [head, ...lines] = fs.readFileSync(at(...names), "utf8").trim().split("\n").map(cells);
  return lines.map((line) => Object.fromEntries(head.map((name, i) => [name, line[i]])));
};
const LIMIT = 0.275;  // watts: some points meet it and some do not
const front = table("search", "front.csv");

test("the page shows the question and the goals, and begins with the front of the search", () => look("search.html", {}, async (page) => {
  const text = await page.locator("body").innerText();
  for (const words of ["Which machines are quick and frugal?", "max perf.fps", "max frames_per_joule_gpu", `power_w.nominal < ${LIMIT}`]) {
    assert.ok(text.includes(words), words);
  }
  assert.equal(await page.getByLabel("y", { exact: true }).inputValue(), "totals.perf.fps");
  assert.equal(await page.getByLabel("x", { exact: true }).inputValue(), "totals.perf.frames_per_joule_gpu");
  const found = await page.locator('[data-block="scatter"]').evaluate((figure) => figure.front());
  assert.deepEqual([...found].sort((a, b) => a - b), front.map((row) => Number(row.n)).sort((a, b) => a - b));
}));

test("no point that breaks a constraint is best or on a front, whatever the figures are", () => look("search.html", {}, async (page) => {
  const points = table("search", "results.csv");
  const power = (n) => Number(points.find((row) => row.n === String(n))["totals.power_w.nominal"]);
  assert.ok(points.some((row) => Number(row["totals.power_w.nominal"]) >= LIMIT), "the constraint refuses some");
  const eligible = points.filter((row) => Number(row["totals.power_w.nominal"]) < LIMIT);
  const best = Math.max(...eligible.map((row) => Number(row["totals.perf.fps"])));
  assert.ok(best < Math.max(...points.map((row) => Number(row["totals.perf.fps"]))), "and the quickest of all");
  const shown = await page.locator('[data-figure="totals.perf.fps"] .value').innerText();
  assert.ok(Math.abs(numberOf(shown) / best - 1) < 1e-3, `${shown} is not ${best}`);
  for (const x of ["totals.power_w.nominal", "totals.cycles"]) {
    await page.getByLabel("x", { exact: true }).selectOption(x);
    const found = await page.locator('[data-block="scatter"]').evaluate((figure) => figure.front());
    assert.ok(found.length > 0 && found.every((n) => power(n) < LIMIT), `${x}: ${found}`);
  }
  await page.locator('[data-block="points"]').getByRole("searchbox").fill("constraints=met");
  assert.equal(await page.locator('[data-block="points"] tbody tr').count(), eligible.length);
}));

test("points of a search show the commands of front.csv", () => look("search.html", { hash: `#point=${front[0].n}` }, async (page) => {
  assert.equal(await page.locator(".command code").innerText(), front[0].command.replace(/^"|"$/g, "").replaceAll('""', '"'));
  assert.equal(await page.locator('[data-block="points"] tbody tr').count(), table("search", "results.csv").length);
}));

test("the page shows how many points meet the constraint, and the distance of the best one", () => look("search.html", {}, async (page) => {
  const powers = table("search", "results.csv").map((row) => Number(row["totals.power_w.nominal"]));
  const met = powers.filter((power) => power < LIMIT).length;
  assert.ok((await page.locator("body").innerText()).includes(`${met} of ${powers.length} machines meet all constraints`));
  const cells = await page.locator('[data-block="limits-table"] tbody tr').first().locator("td, th").allInnerTexts();
  assert.equal(cells[0], `power_w.nominal < ${LIMIT}`);
  assert.equal(numberOf(cells[1]), met);
  const room = 100 * (1 - numberOf(cells[2]) / LIMIT);
  assert.ok(Math.abs(numberOf(cells[4]) - room) < 0.06, `${cells[4]} is not ${room} %`);
}));

test("the page of a search on two workloads begins with the answer, its limits on both, and its neighbours", () => look("phone.html", {}, async (page) => {
  const search = JSON.parse(fs.readFileSync(at("phone", "search.json"), "utf8"));
  assert.equal(await page.locator(".sentence").innerText(), search.sentence);
  assert.match(search.sentence, /least worst\(energy_mj\.nominal\) of 6 machines/);
  assert.equal(await page.locator('[data-block="answer-table"] tbody tr').count(), 4);
  assert.ok((await page.locator("#answer").innerText()).includes("Whole frames of it meet every limit, as --check found."));
  assert.equal(await page.locator('[data-block="points"] tbody tr').count(), 6, "a point per machine");
  assert.equal(await page.locator('[data-block="trades-table"] tbody tr').count(), search.trades.length);
  assert.equal(await page.locator('[data-block="commands-table"] tbody tr').count(), 3);
  for (const id of ["limited", "shares-of-limits"]) {
    await page.locator(`[data-block="${id}"]`).scrollIntoViewIfNeeded();
    await page.locator(`[data-block="${id}"] canvas`).waitFor();
  }
}));
