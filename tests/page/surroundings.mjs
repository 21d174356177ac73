// A browser, and pages that the real program has written: node all.mjs RAYWATT NODE_MODULES
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";

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
export const json = (...names) => JSON.parse(fs.readFileSync(at(...names), "utf8"));

const small = ["--resolution", "64x32", "--set", "scene.triangles=1000", "--threads", "1", "--quiet"];
program("run", ...small, "-o", "base");
program("run", ...small, "-o", "ports", "--set", "srp.array.cache_ports=2", "--set", "tni.trvs=2");
fs.writeFileSync(at("sweep.yaml"), `schema: raywatt-sweep/1
question: Which axis decides?
scene: cornell
resolution: 32x16
sets: [scene.triangles=500]
axes:
  cores: [1, 2]
  tni.trvs: [1, 2, 4]
  tni.trv.l1.size: [8 KiB, 16 KiB]
`);
program("sweep", "run", "sweep.yaml", "-o", "sweep", "--store", "store", "-j", "1");
program("report", "base", "-o", "run.html");
program("report", "base", "ports", "-o", "diff.html");
program("report", "sweep", "-o", "sweep.html");

const browser = await browsers.launch({
  executablePath: chromium,
  args: ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
});
export const close = () => browser.close();

/** Has `use` look at a page; whatever it complains of, or asks the network for, fails. */
export async function look(name, { hash = "", theme = "light", width = 1280, still = false } = {}, use) {
  const context = await browser.newContext({ colorScheme: theme, viewport: { width, height: 900 }, acceptDownloads: true, reducedMotion: "reduce" });
  const page = await context.newPage();
  const complaints = [];
  page.on("console", (message) => complaints.push(`${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => complaints.push(String(error.stack)));
  page.on("request", (request) => /^(file|data|blob):/.test(request.url()) || complaints.push(`asks for ${request.url()}`));
  await page.addInitScript(() => document.addEventListener("securitypolicyviolation", (e) => console.error("refused by the policy:", e.violatedDirective, e.sample)));
  try {
    await page.goto(`file://${at(name)}${hash}`);
    if (!still) await drawn(page);
    await use(page);
    assert.deepEqual(complaints, []);
  } finally {
    await context.close();
  }
}

/** A number as pages show it: "17.07 k" is 17070. */
export function numberOf(text) {
  const [, digits, prefix] = text.trim().match(/^([\d.e+-]+)(?: ([kMGT])(?![a-z]))?/);
  return Number(digits) * { k: 1e3, M: 1e6, G: 1e9, T: 1e12 }[prefix ?? ""] || Number(digits);
}

/** Waits until every chart of the page is drawn. */
export async function drawn(page) {
  await page.evaluate(() => window.dispatchEvent(new Event("beforeprint")));
  await page.waitForFunction(() => {
    const drawings = [...document.querySelectorAll(".drawing")];
    const isWhole = (d) => d.querySelector(".sankey-drawing, svg, .stage") || d.dataset.drawn !== undefined || d.hidden;
    return drawings.length > 0 && drawings.every(isWhole);
  }, undefined, { timeout: 30000 });
}
