// The page of two runs.
import assert from "node:assert/strict";
import fs from "node:fs";
import { test } from "node:test";
import { boxOf, json, look, nanojoulesOf, numberOf, program } from "./surroundings.mjs";

const [a, b] = [json("base", "report.json").totals, json("ports", "report.json").totals];
const data = (page) => page.evaluate(() => raywattPage.views[0].data);

test("the waterfall of cycles goes from one run to the other without a gap", () => look("diff.html", {}, async (page) => {
  const { columns, rows } = (await data(page)).cycles;
  const [from, to] = ["from", "to"].map((f) => columns.findIndex((c) => c.field === f));
  assert.equal(rows[0][to], a.cycles);
  assert.equal(rows.at(-1)[to], b.cycles);
  for (let i = 1; i < rows.length - 1; ++i) assert.ok(Math.abs(rows[i][from] - rows[i - 1][to]) < 1e-6 * a.cycles);
  assert.ok(Math.abs(rows.at(-2)[to] - b.cycles) < 1e-6 * a.cycles);
}));

test("keys and figures equal those of compare", () => look("diff.html", {}, async (page) => {
  const compared = JSON.parse(program("compare", "base", "ports", "--json")).against[0];
  const of = await data(page);
  assert.deepEqual(of.keys.rows, compared.config.map((key) => [key.key, key.a, key.b]));
  const cycles = await page.locator('[data-figure="fps"] .value').innerText();
  assert.ok(Math.abs(numberOf(cycles) / compared.figures.fps.b - 1) < 1e-3);
  const percent = Math.abs(100 * (compared.figures.cycles.relative - 1));
  assert.ok((await page.locator(".sentence").innerText()).includes(`${percent.toFixed(percent < 1 ? 2 : 1)} % ${b.cycles < a.cycles ? "fewer" : "more"} cycles`));
}));

test("pictures flip and split", () => look("diff.html", { hash: "#pair=a" }, async (page) => {
  const other = page.locator(".stage img.other");
  assert.equal(await other.isVisible(), false);
  await page.locator('[data-block="pictures-pair"] .stage').click();
  assert.equal(await other.isVisible(), true);
  assert.equal(await page.evaluate(() => location.hash), "#pair=b");
  await page.getByRole("button", { name: "split" }).click();
  await page.getByRole("slider").fill("25");
  assert.match(await other.evaluate((e) => e.style.clipPath), /25%/);
}));

/** Metrics of the tiles of a run, by row and column of the picture. */
function tilesOf(run, figure) {
  const { columns } = json(run, "tiles.json").frames[0];
  const out = [];
  columns.tile.forEach((_, i) => (out[(columns.y[i] / 16) * 4 + columns.x[i] / 16] = figure(columns, i)));
  return out;
}
const FIGURES = {
  cycles: (c, i) => c.finished[i] - c.dispatched[i], srp: (c, i) => c.srp_cycles[i], dram: (c, i) => c.dram_bytes[i],
  energy: (c, i) => 1e6 * c.energy_mj_nominal[i], steps: (c, i) => c.steps[i], tests: (c, i) => c.tests[i],
  rays: (c, i) => c.rays_primary[i] + c.rays_shadow[i] + c.rays_reflection[i] + c.rays_refraction[i],
};

test("the map has the differences of both tiles.json, on a diverging scale about zero", () => look("diff.html", {}, async (page) => {
  const map = page.locator('[data-block="differences"]'), stage = map.locator(".stage");
  const offered = await map.getByLabel("of", { exact: true }).locator("option").evaluateAll((all) => all.map((o) => o.value));
  assert.equal(offered[0], "cycles");
  const note = await page.locator("#pictures .note").innerText();
  for (const [id, figure] of Object.entries(FIGURES)) {
    const [first, second] = [tilesOf("base", figure), tilesOf("ports", figure)];
    const differences = second.map((value, i) => value - first[i]);
    if (differences.every((d) => d === 0)) {
      assert.ok(!offered.includes(id), id);
      assert.match(note, new RegExp(`Equal in every tile: .*${id === "tests" ? "triangle tests" : id} of a tile`));
      continue;
    }
    await map.getByLabel("of", { exact: true }).selectOption(id);
    await page.waitForFunction((shown) => document.querySelector('[data-block="differences"] .stage').dataset.shown === shown, id);
    const ends = (await map.locator(".ends span").allInnerTexts()).map((text) => text.replace("+", ""));
    const valueOf = id === "energy" ? nanojoulesOf : numberOf;
    const most = Math.max(...differences.map(Math.abs));
    assert.equal(numberOf(ends[1]), 0);
    assert.ok(Math.abs(valueOf(ends[0]) / -most - 1) < 1e-3 && Math.abs(valueOf(ends[2]) / most - 1) < 1e-3, ends.join());
    const box = await boxOf(stage);
    const colours = await stage.locator("canvas.over:not(.lit)").evaluate((c) => [...window.pixelsOf(c)]);
    for (let i = 0; i < differences.length; ++i) {
      const [x, y] = [16 * (i % 4) + 5.5, 16 * Math.floor(i / 4) + 5.5];
      await stage.hover({ position: { x: (box.width * x) / 64, y: (box.height * y) / 32 } });
      const said = (await map.locator(".readout").innerText()).match(/: ([^(]+) \(.*; base ([^,]+), ports ([^)]+)\)/).slice(1);
      [differences[i], first[i], second[i]].forEach((wanted, k) => {
        assert.ok(Math.abs(valueOf(said[k].replace("+", "")) - wanted) <= 1e-3 * Math.abs(wanted) + 1e-4, `${id} ${i}: ${said} ${wanted}`);
      });
      const [red, , blue] = colours.slice(4 * i);
      if (differences[i] > most / 5) assert.ok(red > blue, `${id} ${i} is more, and orange`);
      if (differences[i] < -most / 5) assert.ok(blue > red, `${id} ${i} is less, and blue`);
    }
  }
  const [download] = await Promise.all([page.waitForEvent("download"), map.getByRole("button", { name: "CSV" }).click()]);
  const [head, ...lines] = fs.readFileSync(await download.path(), "utf8").trim().split("\n").map((line) => line.split(","));
  const cycles = lines.map((line) => Number(line[head.indexOf("cycles.difference")]));
  assert.deepEqual(cycles, tilesOf("ports", FIGURES.cycles).map((value, i) => value - tilesOf("base", FIGURES.cycles)[i]));
}));

test("three runs are two pairs to choose from, beside a table of all", () => look("three.html", {}, async (page) => {
  assert.equal(await page.locator("#overview tbody tr").count(), 3);
  const before = await page.locator(".sentence").innerText();
  await page.getByLabel("Pair").selectOption("1");
  assert.notEqual(await page.locator(".sentence").innerText(), before);
  assert.match(await page.locator(".sentence").innerText(), /as many cycles/);
  await page.locator('[data-block="pictures-pair"] .switches button').first().click();
  assert.equal(await page.evaluate(() => location.hash), "#view=1&pair=a");
}));
