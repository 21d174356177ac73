// Accessibility: axe finds no serious violation in light and dark theme, on a narrow window and on paper.
import assert from "node:assert/strict";
import { test } from "node:test";
import { axe, drawn, look } from "./surroundings.mjs";

async function check(page) {
  await page.evaluate(axe);
  // Later rows of a table are made like the first ones, and there are thousands.
  const rows = { include: ["html"], exclude: ["tbody tr:nth-child(n + 12)"] };
  const { violations } = await page.evaluate((rows) => window.axe.run(rows, { resultTypes: ["violations"] }), rows);
  const grave = violations.filter((v) => ["serious", "critical"].includes(v.impact));
  assert.deepEqual(grave.map((v) => `${v.id}: ${v.nodes.map((n) => n.html.slice(0, 120)).slice(0, 3).join(" | ")}`), []);
}

for (const name of ["run.html", "diff.html", "sweep.html", "set.html"]) {
  for (const surroundings of [{ theme: "light" }, { theme: "dark" }, { width: 360 }]) {
    test(`${name} ${JSON.stringify(surroundings)}`, () => look(name, surroundings, async (page) => {
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
      assert.ok(wide <= 0, `${wide} pixels stand out of the window`);
      await check(page);
    }));
  }
  test(`${name} on paper`, () => look(name, { media: "print" }, async (page) => {
    assert.equal(await page.locator("nav").isVisible(), false);
    assert.equal(await page.locator(".sentence").isVisible(), true);
    assert.ok((await page.pdf({ format: "A4" })).length > 20000);
    await check(page);
  }));
}

/** Selects the last choice of each list, and a point. */
async function chooseOthers(page) {
  for (const box of await page.locator("select:visible").all()) {
    const values = await box.locator("option").evaluateAll((options) => options.map((o) => o.value));
    if (await box.evaluate((select) => select.labels[0]?.innerText) !== "Theme") await box.selectOption(values.at(-1));
  }
  const point = page.locator("tr.choosable").first();
  if (await point.count() > 0) await point.click();
  await drawn(page);
}

async function openTables(page) {
  const closed = page.locator('button[aria-pressed="false"]', { hasText: /^Table$/ });
  await closed.evaluateAll((buttons) => buttons.forEach((button) => button.click()));
  await drawn(page);
  assert.deepEqual([await closed.count(), await page.locator("figure table").count() > 3], [0, true]);
}

for (const name of ["run.html", "adaptive.html", "diff.html", "sweep.html", "search.html", "set.html", "phone.html"]) {
  for (const surroundings of [{ theme: "light" }, { theme: "dark", width: 360 }]) {
    test(`${name} with all opened ${JSON.stringify(surroundings)}`, () => look(name, { hash: "#opened=1", ...surroundings }, async (page) => {
      await chooseOthers(page);
      if (surroundings.theme === "dark") await check(page);
      await openTables(page);
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
      assert.ok(wide <= 0, `${wide} pixels stand out of the window`);
      await check(page);
    }));
  }
}

test("paper is light for any theme", () => look("sweep.html", { theme: "dark" }, async (page) => {
  const has = (wanted) => page.waitForFunction((wanted) => {
    const canvas = document.querySelector('[data-block="shares"] canvas'), data = window.pixelsOf(canvas);
    let dark = 0, light = 0;
    for (let i = 0; i < data.length; i += 4) {
      const isLabel = (i / 4) % canvas.width < 0.08 * canvas.width && data[i + 3] > 200;  // the left margin contains only text
      if (isLabel) data[i] < 100 ? ++dark : data[i] > 180 && ++light;
    }
    return (dark > light ? "dark" : "light") === wanted;
  }, wanted, { timeout: 10000 });
  await has("light");
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  await has("dark");
  await page.evaluate(() => dispatchEvent(new Event("afterprint")));
  await has("light");
}));

test("the chosen theme is part of the address and recolours the charts", () => look("run.html", {}, async (page) => {
  const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const before = await ground();
  await page.getByLabel("Theme").selectOption("dark");
  assert.notEqual(await ground(), before);
  assert.equal(await page.evaluate(() => location.hash), "#theme=dark");
}));

test("everything that can be clicked can be reached with the keyboard", () => look("sweep.html", {}, async (page) => {
  const lost = await page.evaluate(() => [...document.querySelectorAll("button, a, select, input, .choosable, .stage")].filter((e) => e.tabIndex < 0).length);
  assert.equal(lost, 0);
}));
