// The page of a run.
import assert from "node:assert/strict";
import fs from "node:fs";
import { test } from "node:test";
import path from "node:path";
import { pathToFileURL } from "node:url";
import { at, boxOf, json, look, nanojoulesOf, numberOf, program, raywatt } from "./surroundings.mjs";

const report = json("base", "report.json");
const figure = (page, id) => page.locator(`[data-figure="${id}"] .value`).innerText();
const near = (text, value) => assert.ok(Math.abs(numberOf(text) / value - 1) < 1e-3, `${text} is not ${value}`);
const data = (page) => page.evaluate(() => raywattPage.views[0].data);
const silent = { warn: () => silent, info: () => silent, debug: () => silent, error: assert.fail, level: () => silent };
const tiles = json("base", "tiles.json").frames[0].columns;
/** A metric of each tile, row by row. */
const figureOf = (id, of = tiles) => of.tile.map((_, i) => ({
  cycles: of.finished[i] - of.dispatched[i], srp: of.srp_cycles[i], steps: of.steps[i], tests: of.tests[i], dram: of.dram_bytes[i],
  energy: 1e6 * of.energy_mj_nominal[i], rays: of.rays_primary[i] + of.rays_shadow[i] + of.rays_reflection[i] + of.rays_refraction[i],
})[id]);
const rows = ({ columns, rows }) => rows.map((row) => Object.fromEntries(columns.map((c, i) => [c.field, row[i]])));

test("the verdict comes first and names the report's own bound", () => look("run.html", {}, async (page) => {
  const sentence = await page.locator("main").evaluate((main) => main.firstElementChild.querySelector(".sentence").innerText);
  const worths = report.totals.bottleneck.estimated_speedup;
  const most = Math.max(...Object.values(worths));
  assert.ok(sentence.includes(`×${most.toFixed(2)} if ideal`), sentence);
  assert.equal(rows((await data(page)).bounds)[0].speedup, most);
  await page.getByRole("link", { name: "where the cycles went", exact: true }).click();
  assert.equal(await page.evaluate(() => location.hash), "#at=cycles");
  assert.equal(await page.evaluate(() => document.activeElement.id), "cycles");
}));

test("a malformed address shows the page", () => look("run.html", { hash: "#%" }, async (page) => {
  near(await figure(page, "time_ms"), report.totals.time_ms);
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

test("stacks, peaks, kernels and energy in its data are those of report.json to the last digit or sum to them", () => look("run.html", {}, async (page) => {
  const of = await data(page), t = report.totals;
  const stack = rows(of.stacks).filter((r) => r.who === "all cores");
  assert.equal(stack.find((r) => r.part === "kernels").share, t.top_down.gpu.kernels);
  assert.equal(stack.find((r) => r.part === "tree misses: DRAM").share, t.top_down.gpu.tree_misses.dram);
  for (const who of ["all cores", "core 1"]) {
    const sum = rows(of.stacks).filter((r) => r.who === who).reduce((all, r) => all + r.share, 0);
    assert.ok(Math.abs(sum - 1) < 1e-9, who);
  }
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

/** Labels of the flow that are outside of the drawing or the window, or overlap. */
const unreadable = () => {
  const svg = document.querySelector('[data-block="flow"] svg'), whole = svg.getBoundingClientRect();
  const labels = [...svg.querySelectorAll("text")].map((t) => ({ words: t.textContent, ...t.getBoundingClientRect().toJSON() }));
  const isOut = (l) => l.left < whole.left - 1 || l.right > Math.min(whole.right, innerWidth) + 1 || l.top < whole.top - 1 || l.bottom > whole.bottom + 1;
  const LEADING = 3;  // pixels above and below the letters of a line
  const isOver = (a, b) => a.left < b.right && b.left < a.right && a.top + LEADING < b.bottom - LEADING && b.top + LEADING < a.bottom - LEADING;
  const over = labels.flatMap((a, i) => labels.slice(i + 1).filter((b) => isOver(a, b)).map((b) => `${a.words} over ${b.words}`));
  return { labels: labels.length, bad: [...labels.filter(isOut).map((l) => `${l.words} is cut`), ...over] };
};

test("all labels of the flow of energy are readable without scrolling at any width", async () => {
  for (const surroundings of [{ width: 320 }, { width: 360, theme: "dark" }, { width: 600 }, { width: 720 }, { width: 770 }, { width: 1280 }, { width: 360, media: "print" }]) {
    await look("run.html", surroundings, async (page) => {
      await page.waitForFunction(() => {
        const body = document.querySelector('[data-block="flow"] .drawing');
        return Math.abs(body.querySelector("svg").getBoundingClientRect().width - body.clientWidth) < 2;
      });
      const { labels, bad } = await page.evaluate(unreadable);
      assert.ok(labels > 20, `${labels}`);
      assert.deepEqual(bad, [], JSON.stringify(surroundings));
    });
  }
});

test("every chart has a table and a download of all digits", async () => {
  for (const name of ["run.html", "diff.html", "sweep.html"]) {
    await look(name, {}, async (page) => {
      const charts = page.locator("figure:is(.chart, .series, .sankey, .scatter, .parallel, .map)");
      const count = await charts.count();
      assert.ok(count >= 3, `${name}: ${count}`);
      assert.equal(await charts.filter({ has: page.locator("button", { hasText: "Table" }) }).count(), count, name);
      assert.equal(await charts.filter({ has: page.locator("button", { hasText: "CSV" }) }).count(), count, name);
    });
  }
  await look("run.html", {}, async (page) => {
    const stacks = page.locator('[data-block="stacks"]');
    await stacks.getByRole("button", { name: "Table" }).click();
    assert.ok(await stacks.locator("table tbody tr").count() >= 14);
    assert.equal(await page.evaluate(() => location.hash), "#tables=stacks");
    const [download] = await Promise.all([page.waitForEvent("download"), stacks.getByRole("button", { name: "CSV" }).click()]);
    const text = fs.readFileSync(await download.path(), "utf8");
    assert.ok(text.includes(`all cores,kernels,${report.totals.top_down.gpu.kernels},`), text.slice(0, 200));
  });
});

test("specifications open elsewhere: Vega-Lite compiles each, with its data inside", async () => {
  const library = path.join(path.dirname(path.dirname(raywatt)), "report_page/work/node_modules/vega-lite/build/index.js");
  const { compile } = await import(pathToFileURL(library));
  for (const name of ["run.html", "diff.html", "sweep.html"]) {
    await look(name, {}, async (page) => {
      const buttons = await page.getByRole("button", { name: /Vega-Lite specification$/ }).all();
      assert.ok(buttons.length >= 2, name);
      for (const button of buttons) {
        const [download] = await Promise.all([page.waitForEvent("download"), button.click()]);
        const spec = JSON.parse(fs.readFileSync(await download.path(), "utf8"));
        assert.equal(spec.$schema, "https://vega.github.io/schema/vega-lite/v6.json");
        assert.ok(spec.data.values.length > 0, download.suggestedFilename());
        assert.ok(compile(spec, { logger: silent }).spec.marks.length > 0, download.suggestedFilename());
      }
    });
  }
});

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

test("the probe shows its position, under the pointer and by keys", () => look("run.html", {}, async (page) => {
  const stage = page.locator('[data-block="frame"] .stage');
  const box = await boxOf(stage);
  await stage.hover({ position: { x: (box.width * 10.5) / 64, y: (box.height * 20.5) / 32 } });
  const readout = page.locator('[data-block="frame"] .readout');
  assert.match(await readout.innerText(), /^pixel 10, 20/);
  await stage.focus();
  await page.keyboard.press("ArrowRight");
  assert.match(await readout.innerText(), /^pixel 11, 20/);
}));

test("overlays of tiles have the numbers of tiles.json, and those of pixels sum to the report's", () => look("run.html", {}, async (page) => {
  const block = (await page.evaluate(() => raywattPage.views[0].sections))
    .find((s) => s.id === "picture").blocks[0];
  const stage = page.locator('[data-block="frame"] .stage'), readout = page.locator('[data-block="frame"] .readout');
  assert.equal(tiles.tile.length, 8);
  for (const id of ["cycles", "srp", "rays", "steps", "tests", "dram", "energy"]) {
    const { values } = block.grids.find((g) => g.id === id);
    figureOf(id).forEach((value, i) => {
      const at = (tiles.y[i] / 16) * 4 + tiles.x[i] / 16;
      assert.ok(Math.abs(values[at] - value) <= 1e-4 * Math.abs(value), `${id} ${i}: ${values[at]} ${value}`);
    });
    await page.getByLabel("Overlay", { exact: true }).selectOption(id);
    await page.waitForFunction((shown) => document.querySelector(".stage").dataset.shown === shown, id);
    const box = await boxOf(stage);
    await stage.hover({ position: { x: (box.width * 20.5) / 64, y: (box.height * 3.5) / 32 } });
    const said = (await readout.innerText()).match(/^pixel 20, 3, tile 1, 0: ([^(]*) \(/)[1];
    const wanted = figureOf(id)[tiles.x.findIndex((x, i) => x === 16 && tiles.y[i] === 0)];
    assert.ok(Math.abs((id === "energy" ? nanojoulesOf : numberOf)(said) / wanted - 1) < 1e-3, `${said} is not ${wanted}`);
    assert.equal(await page.locator('[data-block="frame"] .colour-bar .mark').isVisible(), true);
  }
  const totals = { "pixel-rays": report.totals.rays.total, "pixel-steps": report.totals.traversal_steps, "pixel-tests": figureOf("tests").reduce((a, b) => a + b) };
  for (const [id, total] of Object.entries(totals)) {
    const grid = block.grids.find((g) => g.id === id);
    const sum = await page.evaluate(async ({ pixels, step }) => {
      const image = new Image();
      image.src = JSON.parse(document.getElementById("picture-data").textContent)[pixels.split(":")[1]];
      await image.decode();
      const data = window.pixelsOf(image);
      let all = 0;
      for (let i = 0; i < data.length; i += 4) all += (256 * data[i] + data[i + 1]) * step;
      return all;
    }, grid);
    assert.equal(sum, total, id);
  }
}));

const micros = (cycles) => (1e3 * report.totals.time_ms * cycles) / report.totals.cycles;

test("the tile under the pointer is marked in time", () => look("run.html", {}, async (page) => {
  const stage = page.locator('[data-block="frame"] .stage'), box = await boxOf(stage);
  await stage.hover({ position: { x: (box.width * 40.5) / 64, y: (box.height * 20.5) / 32 } });
  const i = tiles.x.findIndex((x, k) => x === 32 && tiles.y[k] === 16);
  const [, from, to] = (await page.locator('[data-block="series"] .readout').innerText()).match(/pointed at: ([\d.]+) to ([\d.]+) us/);
  assert.ok(Math.abs(from - micros(tiles.dispatched[i])) <= 1e-3 * micros(tiles.dispatched[i]) + 1e-6, from);
  assert.ok(Math.abs(to / micros(tiles.finished[i]) - 1) < 1e-3, to);
}));

test("time that is brushed, by the pointer and by keys, lights the tiles that were in flight", () => look("run.html", {}, async (page) => {
  const dimmed = () => page.locator(".stage .lit").evaluate((lit) => {
    if (lit.hidden) return null;
    const data = window.pixelsOf(lit);
    return Array.from({ length: lit.width * lit.height }, (_, i) => data[4 * i + 3] > 0);
  });
  const wanted = ([from, to]) => {
    const out = [];
    tiles.tile.forEach((_, i) => (out[(tiles.y[i] / 16) * 4 + tiles.x[i] / 16] = !(micros(tiles.dispatched[i]) < to && micros(tiles.finished[i]) > from)));
    return out;
  };
  assert.equal(await dimmed(), null);
  const canvas = page.locator('[data-block="series"] canvas');
  await canvas.scrollIntoViewIfNeeded();
  const box = await boxOf(canvas);
  await page.mouse.move(box.x + 0.6 * box.width, box.y + 80);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.8 * box.width, box.y + 90, { steps: 4 });
  await page.mouse.up();
  await page.waitForFunction(() => location.hash.startsWith("#time="));
  const span = (await page.evaluate(() => location.hash)).slice(6).split("-").map(Number);
  assert.deepEqual(await dimmed(), wanted(span));
  const ends = tiles.finished.map(micros).sort((a, b) => a - b);
  const late = [Math.ceil((ends[3] + ends[4]) / 2), Math.ceil(ends[7])];  // half of the tiles are finished
  await page.getByLabel("Brush from, us").fill(String(late[0]));
  await page.getByLabel("Brush to, us").fill(String(late[1]));
  await page.keyboard.press("Enter");
  const few = wanted(late);
  assert.ok(few.includes(true) && few.includes(false), few.join());
  assert.deepEqual(await dimmed(), few);
}));

test("an address restores the state of its sender", () => look("run.html", { fresh: true,
  hash: "#overlay=steps&opacity=40&series=bandwidth&time=2-9&side=low&tables=peaks&sort.kernel-table=ii:desc&theme=dark" }, async (page) => {
  assert.equal(await page.getByLabel("Overlay", { exact: true }).inputValue(), "steps");
  assert.equal(await page.locator(".stage .over:not(.lit)").evaluate((e) => e.style.opacity), "0.4");
  assert.equal(await page.getByLabel("Figure").inputValue(), "bandwidth");
  assert.equal(await page.getByLabel("Brush to, us").inputValue(), "9");
  assert.equal(await page.locator(".stage .lit").isVisible(), true);
  assert.equal(await page.getByRole("button", { name: "low", exact: true }).getAttribute("aria-pressed"), "true");
  assert.equal(await page.locator('[data-block="peaks"] table').isVisible(), true);
  assert.equal(await page.locator('[data-block="kernel-table"] th[aria-sort="descending"]').innerText(), "II, cycles");
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), "dark");
}));

test("an adaptive frame shows which check failed, and the rate of its tiles", () => look("adaptive.html", { hash: "#overlay=similar" }, async (page) => {
  const choices = await page.getByLabel("Overlay", { exact: true }).locator("option").allInnerTexts();
  assert.ok(choices.some((c) => c.startsWith("failed check: ")), choices.join());
  assert.match(await page.locator(".colour-bar .caption").innerText(), /similar samples/);
  const checked = await page.getByLabel("Overlay", { exact: true }).locator("option", { hasText: "failed check: " }).first().getAttribute("value");
  const before = await page.locator(".stage img").first().getAttribute("src");
  await page.getByLabel("Overlay", { exact: true }).selectOption(checked);
  await page.waitForFunction((shown) => document.querySelector(".stage").dataset.shown === shown, checked);
  assert.notEqual(await page.locator(".stage img").first().getAttribute("src"), before);
  assert.match(await page.locator(".bar .note").innerText(), /failed this check/);
}));

test("a run ends with the line that makes its page", () => {
  const lines = program("run", "--resolution", "16x16", "--set", "scene.triangles=200", "-o", "said").trim().split("\n");
  const line = lines.at(-1).match(/^page: +raywatt (report .*)$/)[1];
  program(...line.split(" "));
  assert.ok(fs.readFileSync(at("said.html"), "utf8").startsWith("<!doctype html>"));
});

test("a nearly empty report has a page that names what is missing", async () => {
  const bare = json("base", "report.json");
  for (const part of ["units", "config", "scene", "frames", "program", "resolution"]) delete bare[part];
  for (const part of ["top_down", "bottleneck", "kernels", "energy_by_block_mj", "area_band_mm2"]) delete bare.totals[part];
  fs.mkdirSync(at("lacking"), { recursive: true });
  fs.writeFileSync(at("lacking", "report.json"), JSON.stringify(bare));
  program("report", "lacking", "-o", "lacking.html");
  await look("lacking.html", { drawings: false }, async (page) => {
    assert.match(await page.locator(".sentence").innerText(), /does not say/);
    assert.match(await page.locator("#picture").innerText(), /no image\.png/);
  });
});

test("a run without pictures has a page that says so", async () => {
  fs.mkdirSync(at("bare"), { recursive: true });
  fs.copyFileSync(at("base", "report.json"), at("bare", "report.json"));
  program("report", "bare", "-o", "bare.html");
  await look("bare.html", {}, async (page) => {
    assert.match(await page.locator("#picture").innerText(), /no image\.png/);
    assert.ok(await page.locator("#cycles canvas").count() > 0);
  });
});

test("an animation shows every frame with its figures", () => look("film.html", {}, async (page) => {
  const { frames, totals } = json("film", "report.json");
  near(await figure(page, "temporal_psnr_db"), totals.temporal_psnr_db);
  const block = page.locator('[data-block="film"]'), thumbnails = block.locator(".film-strip button"), screen = block.locator("img.film-screen");
  assert.equal(await thumbnails.count(), frames.length);
  const shown = () => screen.evaluate(async (image) => (await image.decode(), [...pixelsOf(image)].join()));
  const pictures = [];
  for (const [i, frame] of frames.entries()) {
    await thumbnails.nth(i).click();
    const words = await block.locator(".readout").innerText();
    assert.ok(words.startsWith(`frame ${frame.frame}: `), words);
    assert.equal(words.includes("change"), i > 0, words);
    near(words.match(/([\d.]+) ms/)[0], frame.time_ms);
    await page.waitForFunction(([image, source]) => image.src === source.src, [await screen.elementHandle(), await thumbnails.nth(i).locator("img").elementHandle()]);
    pictures.push(await shown());
  }
  assert.equal(new Set(pictures).size, frames.length, "pictures differ");
  assert.ok((await page.evaluate(() => location.hash)).includes(`frame=${frames.at(-1).frame}`));
  await block.getByRole("button", { name: "Play" }).click();
  await page.waitForFunction(([output, first]) => output.innerText.startsWith(`frame ${first}:`), [await block.locator(".readout").elementHandle(), frames[0].frame]);
  await block.getByRole("button", { name: "Play" }).click();
}));
