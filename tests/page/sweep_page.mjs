// The page of a sweep.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { test } from "node:test";
import { folder, look, numberOf, program, raywatt } from "./surroundings.mjs";

test("the table sorts, filters, and shows all points", () => look("sweep.html", {}, async (page) => {
  const table = page.locator('[data-block="points"]');
  assert.equal(await table.locator("tbody tr").count(), 12);
  await table.getByRole("button", { name: "frame rate, frames/s" }).click();
  const titles = await table.locator("thead th").allInnerTexts();
  const place = titles.findIndex((t) => t.startsWith("frame rate")) + 1;
  const rates = (await table.locator(`tbody tr td:nth-child(${place})`).allInnerTexts()).map(numberOf);
  assert.deepEqual(rates, [...rates].sort((a, b) => a - b));
  await table.getByRole("searchbox").fill("cores=2 tni.trvs>=2");
  assert.equal(await table.locator("tbody tr").count(), 4);
  assert.match(await page.evaluate(() => decodeURIComponent(location.hash)), /filter\.points=cores=2/);
}));

test("headlines are the best of all points, with the range over all points", () => look("sweep.html", {}, async (page) => {
  const best = (way) => numberOf(program("sweep", "best", "sweep", way, "totals.perf.fps").match(/^perf\.fps +(.+)$/m)[1]);
  const figure = page.locator('[data-figure="totals.perf.fps"]');
  assert.ok(Math.abs(numberOf(await figure.locator(".value").innerText()) / best("--max") - 1) < 1e-3);
  const [low, high] = (await figure.locator(".band").innerText()).split(" to ").map(numberOf);
  assert.ok(Math.abs(low / best("--min") - 1) < 1e-3 && Math.abs(high / best("--max") - 1) < 1e-3);
}));

test("the filter of the table leaves its points in the chart and on the parallel axes", () => look("sweep.html", { hash: "#filter.points=cores%3D2&tables=scatter%2Cparallel-axes" }, async (page) => {
  const rows = (block) => page.locator(`[data-block="${block}"] table tbody tr`);
  await page.waitForFunction(() => document.querySelectorAll('[data-block="scatter"] table tbody tr').length === 6);
  assert.equal(await page.getByRole("searchbox").first().inputValue(), "cores=2");
  assert.equal(await rows("points").count(), 6);
  assert.equal(await rows("scatter").count(), 6);
}));

test("the front is that of sweep pareto, for the first figures and for any others", () => look("sweep.html", {}, async (page) => {
  for (const [x, y] of [["totals.power_w.nominal", "totals.perf.fps"], ["totals.cycles", "totals.energy_mj.nominal"]]) {
    const lines = program("sweep", "pareto", "sweep", "--x", x, "--y", y, "--csv").trim().split("\n").slice(1).map((l) => l.split(","));
    const wanted = lines.filter((l) => l[0] !== "~").map((l) => Number(l[1])).sort((a, b) => a - b);
    await page.getByLabel("x", { exact: true }).selectOption(x);
    await page.getByLabel("y", { exact: true }).selectOption(y);
    const found = await page.locator('[data-block="scatter"]').evaluate((figure) => figure.front());
    assert.deepEqual([...found].sort((a, b) => a - b), wanted);
  }
}));

test("a chosen point shows the command that runs it again, and that command does", () => look("sweep.html", { hash: "#point=7" }, async (page) => {
  const command = await page.locator(".command code").innerText();
  assert.match(command, /^raywatt run sgrt-2016 .*--set cores=2/);
  const rerun = JSON.parse(execFileSync("/bin/sh", ["-c", `${command.replace(/^raywatt/, raywatt)} --json --quiet -o again`], { cwd: folder }));
  const shown = await page.locator(".details dl > div", { hasText: /^frame rate/ }).locator("dd").innerText();
  assert.ok(Math.abs(numberOf(shown) / rerun.perf.fps - 1) < 1e-3, `${shown} ${rerun.perf.fps}`);
  await page.locator('[data-block="points"] tbody tr').first().click();
  assert.match(await page.locator(".details h4").innerText(), /Point 0/);
  assert.match(await page.evaluate(() => location.hash), /point=0/);
}));

test("over several workloads rows are machines, with aggregates and every workload", () => look("set.html", {}, async (page) => {
  const table = page.locator('[data-block="points"]');
  assert.equal(await table.locator("tbody tr").count(), 4);
  const titles = await table.locator("thead th").allInnerTexts();
  for (const title of ["frame rate, worst, frames/s", "frame rate, geomean, frames/s", "frame rate on cornell, frames/s", "frame rate on teapot, frames/s"]) {
    assert.ok(titles.includes(title), `${title} in ${titles}`);
  }
  const lines = program("sweep", "table", "set", "--columns", "n,worst(fps)", "--csv").trim().split("\n").slice(1).map((l) => l.split(",").map(Number));
  const place = titles.indexOf("frame rate, worst, frames/s") + 1;
  const shown = (await table.locator(`tbody tr td:nth-child(${place})`).allInnerTexts()).map(numberOf);
  lines.forEach(([machine, rate]) => assert.ok(Math.abs(shown[machine] / rate - 1) < 1e-3));
  await page.getByRole("searchbox").first().fill(`worst(fps)>=${Math.max(...lines.map((l) => l[1]))}`);
  assert.equal(await table.locator("tbody tr").count(), lines.filter((l) => l[1] === Math.max(...lines.map((m) => m[1]))).length);
}));

test("bars compare the best machine with the chosen one on each workload", () => look("set.html", { hash: "#point=0&tables=workload-bars" }, async (page) => {
  const rows = page.locator('[data-block="workload-bars"] table tbody tr');
  const best = Number(program("sweep", "best", "set", "--max", "geomean(frames_per_joule_gpu)").match(/: machine (\d+)/)[1]);
  assert.equal(await rows.count(), best === 0 ? 2 : 4);
  const cells = await rows.first().locator("td").allInnerTexts();
  const wanted = program("sweep", "table", "set", "--columns", "n,on(cornell, fps)", "--csv").trim().split("\n")[best + 1].split(",")[1];
  assert.deepEqual(cells.slice(0, 2), ["cornell", `machine ${best}, the best`]);
  assert.ok(Math.abs(numberOf(cells[2]) / Number(wanted) - 1) < 1e-3);
  const commands = (await page.locator(".command code").innerText()).split(" && ");
  assert.equal(commands.length, 2);
  assert.match(commands[1], /^raywatt run sgrt-2016 --scene teapot /);
  await page.getByLabel("figure", { exact: true }).selectOption("power");
  await page.waitForFunction(() => document.querySelector('[data-block="workload-bars"] table thead')?.innerText.includes("power"));
}));
