// Bytes and first paint of pages, the median of five openings: node paint.mjs NODE_MODULES FILE.html...
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

const OPENINGS = 5;
const [modules, ...files] = process.argv.slice(2).map((p) => path.resolve(p));
const { chromium } = createRequire(path.join(modules, "x"))("playwright-core");
const browser = await chromium.launch({
  executablePath: "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
});
for (const file of files) {
  const paints = [], wholes = [];
  for (let i = 0; i < OPENINGS; ++i) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 900 } });
    const page = await context.newPage();
    await page.goto(`file://${file}`);
    paints.push(await page.evaluate(() => new Promise((resolve) => new PerformanceObserver((list) => list.getEntriesByName("first-contentful-paint").forEach((e) => resolve(e.startTime)))
      .observe({ type: "paint", buffered: true }))));
    await page.waitForFunction(() => [...document.querySelectorAll(".drawing")].every((d) => d.querySelector("svg, .stage, .drawing") || d.dataset.drawn !== undefined || d.hidden));
    wholes.push(await page.evaluate(() => performance.now()));
    await context.close();
  }
  const median = (values) => values.sort((a, b) => a - b)[OPENINGS >> 1].toFixed(0);
  console.log(`${path.basename(file)}: ${fs.statSync(file).size} bytes, first paint ${median(paints)} ms, all charts ${median(wholes)} ms`);
}
await browser.close();
