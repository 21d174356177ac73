// A browser, and pages written by the real program: node all.mjs RAYWATT NODE_MODULES
import assert from "node:assert/strict";
import { execFile, execFileSync } from "node:child_process";
import fs from "node:fs";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";
import { promisify } from "node:util";

export const [raywatt, modules] = process.argv.slice(2).map((p) => path.resolve(p));
const SKIPPED = 77;

function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(SKIPPED);
}

const chromium = ["/usr/bin/chromium", "/usr/bin/chromium-browser"].find((file) => fs.existsSync(file));
if (!chromium) skip("there is no chromium; tools/test installs it");
if (!fs.existsSync(modules)) skip(`there is no ${modules}; tools/test installs it`);
if (!fs.existsSync(path.join(path.dirname(path.dirname(raywatt)), "report_page", "libraries.js"))) {
  skip("the scripts of pages were not bundled, for which the build needs npm and its registry");
}

const require = createRequire(path.join(modules, "x"));
const { chromium: browsers } = require("playwright-core");
export const axe = fs.readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

export const folder = fs.mkdtempSync(path.join(os.tmpdir(), "raywatt-page-"));
process.on("exit", () => fs.rmSync(folder, { recursive: true, force: true }));

export const at = (...names) => path.join(folder, ...names);
export const program = (...words) => execFileSync(raywatt, words, { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
/** Runs the program asynchronously. */
const running = (...words) => promisify(execFile)(raywatt, words, { cwd: folder });
export const json = (...names) => JSON.parse(fs.readFileSync(at(...names), "utf8"));

fs.writeFileSync(at("sweep.yaml"), `schema: raywatt-sweep/1
question: Which axis decides?
scene: cornell
resolution: 16x16
sets: [scene.triangles=200]
axes:
  cores: [1, 2]
  tni.trvs: [1, 2, 4]
  tni.trv.l1.size: [8 KiB, 16 KiB]
`);
fs.writeFileSync(at("set.yaml"), `schema: raywatt-sweep/1
question: Which machine is best on both scenes?
resolution: 16x16
sets: [scene.triangles=200]
workloads: [cornell, teapot]
axes: {cores: [1, 2], tni.trvs: [1, 2]}
`);
fs.writeFileSync(at("search.yaml"), `schema: raywatt-optimise/1
question: Which machines are quick and frugal?
scene: cornell
resolution: 16x16
objectives: [{max: perf.fps}, {max: frames_per_joule_gpu}]
constraints: [power_w.nominal < 0.275]
budget: 12
axes: {cores: [1, 2, 4], tni.trvs: [1, 2, 4], l2.size: [128 KiB, 256 KiB]}
`);
fs.writeFileSync(at("phone.yaml"), `schema: raywatt-optimise/1
question: Which machine takes least energy for both?
workloads: [cornell, teapot]
resolution: 16x16
objectives: [min: worst(energy_mj)]
constraints: [power_w.nominal < 100, cycles > 1]
budget: 6
axes: {cores: [1, 2], tni.trvs: [1, 2, 4]}
`);
const small = ["--resolution", "64x32", "--set", "scene.triangles=1000", "--set", "render.tile=16", "--threads", "1", "--quiet"];
const runs = async () => {
  await Promise.all([
    running("run", ...small, "-o", "base"),
    running("run", ...small, "-o", "ports", "--set", "srp.array.cache_ports=2", "--set", "tni.trvs=2")]);
  await Promise.all([running("report", "base", "-o", "run.html"), running("report", "base", "ports", "-o", "diff.html"), running("report", "base", "ports", "base", "-o", "three.html")]);
};
const sweep = async () => {
  await running("sweep", "run", "sweep.yaml", "-o", "sweep", "--store", "store", "-j", "1");
  await running("report", "sweep", "-o", "sweep.html");
};
const set = async () => {
  await running("sweep", "run", "set.yaml", "-o", "set", "--store", "store", "-j", "1");
  await running("report", "set", "-o", "set.html");
};
const search = async () => {
  await running("optimise", "search.yaml", "-o", "search", "--store", "found", "-j", "1", "--quiet");
  await running("report", "search", "-o", "search.html");
  await running("optimise", "phone.yaml", "-o", "phone", "--store", "found", "-j", "1", "--quiet", "--check");
  await running("report", "phone", "-o", "phone.html");
};
const adaptive = async () => {
  await running("run", ...small, "-o", "adaptive", "--program", "multirate:under", "--debug-images");
  await running("report", "adaptive", "-o", "adaptive.html");
};
const film = async () => {
  await running("run", ...small, "-o", "film", "--scene", "chess", "--frames", "20:22", "--program", "multirate:under", "--reference", "full:1");
  await running("report", "film", "-o", "film.html");
};
const [browser] = await Promise.all([
  browsers.launch({
    executablePath: chromium,
    args: ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
  }),
  runs(), sweep(), set(), search(), adaptive(), film()]);

const open = new Map();  // pages by file
export const close = () => browser.close();

/** Opens a page and collects its console messages, errors and requests to the network. */
async function opened(name, address) {
  const context = await browser.newContext({ acceptDownloads: true, reducedMotion: "reduce" });
  const page = await context.newPage();
  page.complaints = [];
  page.on("console", (message) => page.complaints.push(`${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => page.complaints.push(String(error.stack)));
  page.on("request", (request) => /^(file|data|blob):/.test(request.url()) || page.complaints.push(`asks for ${request.url()}`));
  /** Returns the pixels of a copy of a canvas. */
  await page.addInitScript(() => {
    window.pixelsOf = (canvas) => {
      const copy = document.createElement("canvas");
      [copy.width, copy.height] = [canvas.width ?? canvas.naturalWidth, canvas.height ?? canvas.naturalHeight];
      const context = copy.getContext("2d", { willReadFrequently: true });
      context.drawImage(canvas, 0, 0);
      return context.getImageData(0, 0, copy.width, copy.height).data;
    };
  });
  await page.addInitScript(() => document.addEventListener("securitypolicyviolation", (e) => console.error("refused by the policy:", e.violatedDirective, e.sample)));
  await page.goto(address);
  open.set(name, page);
  return page;
}

/**
 * Opens a page in a state and calls `use`. Pages stay open between tests, and the state is the fragment of the address.
 * `fresh`: loads the page again. `drawings`: waits for the charts.
 */
export async function look(name, { hash = "", theme = "light", width = 1280, fresh = false, media = "screen", drawings = true } = {}, use) {
  const address = `file://${at(name)}${hash || "#"}`;
  if (fresh) await open.get(name)?.context().close();
  const page = fresh || !open.has(name) ? await opened(name, address) : open.get(name);
  if (page.viewportSize().width !== width) await page.setViewportSize({ width, height: 900 });
  await page.emulateMedia({ colorScheme: theme, media });
  if (page.url() !== address) await page.goto(address);
  if (drawings) await drawn(page);
  await use(page);
  assert.deepEqual(page.complaints, []);
}

/** Parses a number of a page: "17.07 k" is 17070. */
export function numberOf(text) {
  const [, digits, prefix] = text.trim().replace("−", "-").match(/^([\d.e+-]+)(?: ([kMGT])(?![a-z]))?/);
  return Number(digits) * { k: 1e3, M: 1e6, G: 1e9, T: 1e12 }[prefix ?? ""] || Number(digits);
}

/** Parses an energy into nanojoules: "2.3 µJ" is 2300. */
export function nanojoulesOf(text) {
  const [, digits, prefix] = text.trim().replace("−", "-").match(/^([\d.e+-]+) ([mµnp]?)J$/);
  return Number(digits) * { "": 1e9, m: 1e6, µ: 1e3, n: 1, p: 1e-3 }[prefix];
}

/** Returns the box of an element after it has not moved for 50 ms: content that loads late moves what is below it. */
export async function boxOf(locator) {
  for (let before = await locator.boundingBox(); ; ) {
    await locator.page().waitForTimeout(50);
    const now = await locator.boundingBox();
    if (JSON.stringify(now) === JSON.stringify(before)) return now;
    before = now;
  }
}

/** Waits until every chart of the page is drawn for this width and theme. */
export async function drawn(page) {
  await page.waitForFunction(() => {
    const drawings = [...document.querySelectorAll(".drawing")];
    const isShown = (image) => image.hidden || image.naturalWidth > 0;
    const isWhole = (d) => (d.querySelector(".stage") && [...d.querySelectorAll("img")].every(isShown)) || d.querySelector(".sankey-drawing, svg") || d.dataset.drawn !== undefined || d.hidden;
    return drawings.length > 0 && drawings.every(isWhole);
  }, undefined, { timeout: 30000, polling: 50 }).catch(async (error) => {
    const missing = await page.evaluate(() => [...document.querySelectorAll(".drawing:not([data-drawn])")].map((d) => d.closest("figure").dataset.block));
    throw new Error(`${error.message}; not drawn: ${missing}; said: ${page.complaints.join("\n")}`);
  });
}
