// The page of two runs.
import assert from "node:assert/strict";
import { test } from "node:test";
import { json, look, numberOf, program } from "./surroundings.mjs";

const [a, b] = [json("base", "report.json").totals, json("ports", "report.json").totals];
const data = (page) => page.evaluate(() => JSON.parse(document.getElementById("data").textContent).views[0].data);

test("the waterfall of cycles goes from one run to the other without a gap", () => look("diff.html", {}, async (page) => {
  const { columns, rows } = (await data(page)).cycles;
  const [from, to] = ["from", "to"].map((f) => columns.findIndex((c) => c.field === f));
  assert.equal(rows[0][to], a.cycles);
  assert.equal(rows.at(-1)[to], b.cycles);
  for (let i = 1; i < rows.length - 1; ++i) assert.ok(Math.abs(rows[i][from] - rows[i - 1][to]) < 1e-6 * a.cycles);
  assert.ok(Math.abs(rows.at(-2)[to] - b.cycles) < 1e-6 * a.cycles);
}));

test("keys and figures are those of compare", () => look("diff.html", {}, async (page) => {
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
  await page.locator(".stage").click();
  assert.equal(await other.isVisible(), true);
  assert.equal(await page.evaluate(() => location.hash), "#pair=b");
  await page.getByRole("button", { name: "split" }).click();
  await page.getByRole("slider").fill("25");
  assert.match(await other.evaluate((e) => e.style.clipPath), /25%/);
}));

test("three runs are two pairs to choose from, beside a table of all", async () => {
  program("report", "base", "ports", "base", "-o", "three.html");
  await look("three.html", {}, async (page) => {
    assert.equal(await page.locator("#overview tbody tr").count(), 3);
    const before = await page.locator(".sentence").innerText();
    await page.getByLabel("Pair").selectOption("1");
    assert.notEqual(await page.locator(".sentence").innerText(), before);
    assert.match(await page.locator(".sentence").innerText(), /as many cycles/);
  });
});
