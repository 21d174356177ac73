// The page of a run.
import assert from "node:assert/strict";
import fs from "node:fs";
import { test } from "node:test";
import { at, json, look, numberOf } from "./surroundings.mjs";

const report = json("base", "report.json");
const figure = (page, id) => page.locator(`[data-figure="${id}"] .value`).innerText();
const near = (text, value) => assert.ok(Math.abs(numberOf(text) / value - 1) < 1e-3, `${text} is not ${value}`);
const data = (page) => page.evaluate(() => JSON.parse(document.getElementById("data").textContent).views[0].data);
const rows = ({ columns, rows }) => rows.map((row) => Object.fromEntries(columns.map((c, i) => [c.field, row[i]])));

test("the verdict comes first and names the report's own bound", () => look("run.html", {}, async (page) => {
  const sentence = await page.locator("main").evaluate((main) => main.firstElementChild.querySelector(".sentence").innerText);
  const worths = report.totals.bottleneck.estimated_speedup;
  assert.ok(sentence.includes(`×${Math.max(...Object.values(worths)).toFixed(2)} if perfect`), sentence);
  await page.getByRole("link", { name: "where the cycles went", exact: true }).click();
  assert.equal(await page.evaluate(() => location.hash), "#at=cycles");
  assert.equal(await page.evaluate(() => document.activeElement.id), "cycles");
}));

test("figures equal report.json", () => look("run.html", {}, async (page) => {
  const t = report.totals;
  for (const [id, value] of [["time_ms", t.time_ms], ["fps", t.perf.fps], ["energy_mj", t.energy_mj.nominal], ["power_w", t.power_w.nominal],
    ["frames_per_joule_gpu", t.perf.frames_per_joule_gpu], ["nj_per_ray", t.perf.nj_per_ray], ["area_mm2", t.area_mm2]]) {
    near(await figure(page, id), value);
  }
  const band = await page.locator('[data-figure="energy_mj"] .band').innerText();
  near(band.split(" to ")[0], t.energy_mj.low);
  near(band.split(" to ")[1], t.energy_mj.high);
}));

test("stacks, peaks, kernels and energy in its data are those of report.json to the last digit or sum to them", () => look("run.html", { still: true }, async (page) => {
  const of = await data(page), t = report.totals;
  const stack = rows(of.stacks).filter((r) => r.who === "all cores");
  assert.equal(stack.find((r) => r.part === "kernels").share, t.top_down.gpu.kernels);
  assert.equal(stack.find((r) => r.part === "tree misses: DRAM").share, t.top_down.gpu.tree_misses.dram);
  assert.ok(Math.abs(stack.reduce((sum, r) => sum + r.share, 0) - 1) < 1e-9);
  const peaks = rows(of.peaks);
  const share = (name) => peaks.find((r) => r.unit.startsWith(name)).share;
  assert.ok(Math.abs(share("Traversal") - t.utilisation.tni) < 1e-12);
  assert.ok(Math.abs(share("DRAM") - t.utilisation.dram) < 1e-12);
  for (const kernel of rows(of.kernels)) {
    assert.equal(kernel.share, t.kernels[kernel.kernel].share);
    assert.equal(kernel.ii, t.kernels[kernel.kernel].ii);
    assert.ok(kernel.bound, kernel.kernel);
  }
  const flow = rows(of.flow);
  for (const side of ["low", "nominal", "high"]) {
    const sum = (from) => flow.filter((l) => l.from === from).reduce((all, l) => all + l[side], 0);
    const whole = flow.find((l) => l.from.startsWith("GPU")).from;
    assert.ok(Math.abs(sum(whole) / t.energy_mj[side] - 1) < 1e-9);
    for (const [block, spread] of Object.entries(t.energy_by_block_mj)) assert.ok(Math.abs(sum(block) / spread[side] - 1) < 1e-9, block);
  }
  assert.equal(rows(of.roofline)[0].x, t.dram_bytes / t.rays.total);
}));

test("the flow of energy follows the switch, and the address keeps it", () => look("run.html", { hash: "#side=high" }, async (page) => {
  const whole = page.locator('[data-block="flow"] svg text', { hasText: "GPU with memory" });
  near((await whole.textContent()).match(/[\d.]+ mJ/)[0], report.totals.energy_mj.high);
  await page.getByRole("button", { name: "low", exact: true }).click();
  await page.waitForFunction(() => location.hash === "#side=low");
  await page.waitForFunction((low) => Math.abs(Number.parseFloat([...document.querySelectorAll('[data-block="flow"] svg text')].find((t) => t.textContent.startsWith("GPU")).textContent.match(/([\d.]+) mJ/)[1]) / low - 1) < 1e-3, report.totals.energy_mj.low);
}));

test("every chart has a table and a download of all digits", () => look("run.html", {}, async (page) => {
  const charts = await page.locator("figure.chart").count();
  assert.ok(charts >= 6, String(charts));
  assert.equal(await page.locator("figure.chart button", { hasText: "Table" }).count(), charts);
  assert.equal(await page.locator("figure.chart button", { hasText: "CSV" }).count(), charts);
  const stacks = page.locator('[data-block="stacks"]');
  await stacks.getByRole("button", { name: "Table" }).click();
  assert.ok(await stacks.locator("table tbody tr").count() >= 14);
  assert.equal(await page.evaluate(() => location.hash), "#tables=stacks");
  const [download] = await Promise.all([page.waitForEvent("download"), stacks.getByRole("button", { name: "CSV" }).click()]);
  const text = fs.readFileSync(await download.path(), "utf8");
  assert.ok(text.includes(`all cores,kernels,${report.totals.top_down.gpu.kernels},`), text.slice(0, 200));
  const [spec] = await Promise.all([page.waitForEvent("download"), stacks.getByRole("button", { name: "Vega-Lite" }).click()]);
  const chart = JSON.parse(fs.readFileSync(await spec.path(), "utf8"));
  assert.equal(chart.$schema, "https://vega.github.io/schema/vega-lite/v6.json");
  assert.ok(chart.data.values.length >= 14);
}));

test("tables sort by a click on a heading, both ways", () => look("run.html", {}, async (page) => {
  const table = page.locator('[data-block="kernel-table"]');
  const column = async () => (await table.locator("tbody tr td:nth-child(3)").allInnerTexts()).map(Number);
  const head = table.getByRole("button", { name: "II, cycles" });
  await head.click();
  const up = await column();
  assert.deepEqual(up, [...up].sort((a, b) => a - b));
  assert.equal(await table.locator('th[aria-sort="ascending"]').count(), 1);
  await head.click();
  assert.deepEqual(await column(), [...up].sort((a, b) => b - a));
}));

test("the probe says where it is, under the pointer and by keys", () => look("run.html", {}, async (page) => {
  const stage = page.locator('[data-block="frame"] .stage');
  const box = await stage.boundingBox();
  await stage.hover({ position: { x: (box.width * 10.5) / 64, y: (box.height * 20.5) / 32 } });
  const readout = page.locator('[data-block="frame"] .readout');
  assert.match(await readout.innerText(), /^pixel 10, 20/);
  await stage.focus();
  await page.keyboard.press("ArrowRight");
  assert.match(await readout.innerText(), /^pixel 11, 20/);
}));

test("a run without pictures still has its page, which says so", async () => {
  fs.mkdirSync(at("bare"), { recursive: true });
  fs.copyFileSync(at("base", "report.json"), at("bare", "report.json"));
  const { program } = await import("./surroundings.mjs");
  program("report", "bare", "-o", "bare.html");
  await look("bare.html", {}, async (page) => {
    assert.match(await page.locator("#picture").innerText(), /no image\.png/);
    assert.ok(await page.locator("#cycles canvas").count() > 0);
  });
});
