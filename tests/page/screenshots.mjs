// Pictures of pages for docs/pages.md: node screenshots.mjs RAYWATT NODE_MODULES OUT [FOLDER_OF_RUNS]
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";

const [raywatt, modules, out, kept] = process.argv.slice(2).map((p) => path.resolve(p));
const { chromium } = createRequire(path.join(modules, "x"))("playwright-core");
const folder = kept ?? fs.mkdtempSync(path.join(os.tmpdir(), "raywatt-screenshots-"));
const program = (...words) => execFileSync(raywatt, words, { cwd: folder, stdio: ["ignore", "ignore", "inherit"] });

const run = (name, ...more) => fs.existsSync(path.join(folder, name)) || program("run", "--scene", "chess", "--resolution", "512x256", "--quiet", "-o", name, ...more);
run("base");
run("multiply-add", "--set", "srp.array.mul_add=true", "--set", "tni.trv.l1.size=8 KiB");
fs.writeFileSync(path.join(folder, "caches.yaml"), `schema: raywatt-sweep/1
question: Which of cores, traversal units and first-level caches decides frames per joule?
scene: cornell
resolution: 96x48
axes:
  cores: [1, 2, 4, 8]
  tni.trvs: [1, 2, 4]
  tni.trv.l1.size: [4 KiB, 8 KiB, 16 KiB, 32 KiB]
`);
program("sweep", "run", "caches.yaml", "-o", "caches", "--store", "store", "--quiet");
program("report", "base", "-o", "run.html");
program("report", "base", "multiply-add", "-o", "diff.html");
program("report", "caches", "-o", "sweep.html");

const browser = await chromium.launch({
  executablePath: "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
});
/** Takes a picture of the page from an element on, after everything is drawn. */
async function shoot(file, hash, name, { from = "header", height = 860, theme = "light" } = {}) {
  const page = await browser.newPage({ colorScheme: theme, viewport: { width: 1180, height }, reducedMotion: "reduce" });
  await page.goto(`file://${path.join(folder, file)}${hash}`);
  await page.waitForFunction(() => [...document.querySelectorAll(".drawing")].every((d) => d.querySelector("svg, .stage, .drawing") || d.dataset.drawn !== undefined || d.hidden));
  if (from !== "header") await page.locator(from).evaluate((element) => window.scrollTo(0, element.offsetTop - 60));
  await page.waitForTimeout(400);
  await page.screenshot({ path: path.join(out, `${name}.png`) });
  await page.close();
}
await shoot("run.html", "#overlay=cycles&opacity=70", "page-run", { height: 1010 });
await shoot("run.html", "", "page-run-cycles", { from: "#cycles", theme: "dark", height: 940 });
await shoot("diff.html", "", "page-diff");
await shoot("diff.html", "#split=40", "page-diff-map", { from: "#pictures", height: 600 });
await shoot("sweep.html", "#point=42", "page-sweep");
await browser.close();
if (!kept) fs.rmSync(folder, { recursive: true, force: true });
