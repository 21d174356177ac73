// Names that contain markup run nothing and are shown as text.
import assert from "node:assert/strict";
import fs from "node:fs";
import { test } from "node:test";
import { at, boxOf, json, look, program } from "./surroundings.mjs";

const HOSTILE = "</script><img src=x onerror=alert(1)>\u2028<!--<script>alert(2)//";

function everywhere(node) {
  if (Array.isArray(node)) return node.map(everywhere);
  if (node && typeof node === "object") return Object.fromEntries(Object.entries(node).map(([k, v]) => [k, everywhere(v)]));
  return node;
}

test("a hostile name of a scene, a program, a kernel, a warning, a key", async () => {
  const report = everywhere(json("base", "report.json"));
  report.scene.name = HOSTILE;
  report.program = HOSTILE;
  report.warnings = [HOSTILE];
  report.provenance.argv = ["raywatt", HOSTILE];
  report.config[HOSTILE] = HOSTILE;
  report.totals.kernels[HOSTILE] = { ...Object.values(report.totals.kernels)[0] };
  report.totals.energy_by_block_mj[HOSTILE] = report.totals.energy_mj;
  report.totals.dram_bytes_by_client[HOSTILE] = 5;
  fs.mkdirSync(at("hostile"), { recursive: true });
  fs.writeFileSync(at("hostile", "report.json"), JSON.stringify(report));
  for (const [name, what] of [["hostile.html", ["hostile"]], ["hostile-diff.html", ["base", "hostile"]]]) {
    program("report", ...what, "-o", name);
    await look(name, {}, async (page) => {
      page.on("dialog", () => assert.fail("a script of a name ran"));
      assert.equal(await page.locator("img[src=x]").count(), 0);
      assert.equal(await page.locator("script:not([id]):not([type])").count() <= 2, true);
      assert.ok((await page.locator("body").innerText()).includes("<img src=x onerror=alert(1)>"));
    });
  }
});

test("hostile axes, values, files of scenes and questions of a sweep", async () => {
  const image = "<img src=x onerror=alert(1)>", axis = `a.b[0]"'\\ </script>${image}`, scene = `./</script>${image}.glb`;
  fs.mkdirSync(at("<"), { recursive: true });
  program("scenes", "export", "cornell", "-o", scene, "--set", "scene.triangles=200");
  fs.writeFileSync(at("hostile.yaml"), JSON.stringify({
    schema: "raywatt-sweep/1", question: HOSTILE, resolution: "16x16",
    axes: { [axis]: { keys: ["tni.trv.l1.size", "tni.ist.l1.size"], values: ["8 KiB", "16 KiB"] }, scene: [scene, "cornell"] },
  }));
  program("sweep", "run", "hostile.yaml", "-o", "hostile-sweep", "--store", "hostile-store", "-j", "1");
  program("report", "hostile-sweep", "-o", "hostile-sweep.html");
  await look("hostile-sweep.html", { hash: "#point=1" }, async (page) => {
    page.on("dialog", () => assert.fail("a script of a name ran"));
    const isClean = async () => {
      assert.equal(await page.locator("img[src=x]").count(), 0);
      assert.equal(await page.locator("script:not([id]):not([type])").count() <= 2, true);
    };
    await isClean();
    const text = await page.locator("body").innerText();
    for (const words of [image, scene, "alert(2)"]) assert.ok(text.includes(words), words);
    await page.getByLabel("colour", { exact: true }).selectOption(axis);
    const canvas = page.locator('[data-block="scatter"] .drawing canvas, [data-block="scatter"] .drawing svg').first();
    const { width, height } = await boxOf(canvas);
    for (let i = 0; i < 40; ++i) await canvas.hover({ position: { x: width * (0.06 + 0.9 * ((i * 0.618) % 1)), y: height * (0.05 + 0.02 * i) } });
    await isClean();
    const closed = page.locator('button[aria-pressed="false"]', { hasText: /^Table$/ });
    assert.equal(await closed.count(), 3);
    await closed.evaluateAll((buttons) => buttons.forEach((button) => button.click()));
    assert.equal(await closed.count(), 0);
    await isClean();
    assert.ok((await page.locator("figure table").allTextContents()).some((table) => table.includes(image)));
  });
});

test("a hostile question of a search", async () => {
  fs.cpSync(at("search"), at("hostile-search"), { recursive: true });
  const file = at("hostile-search", "sweep.yaml");
  fs.writeFileSync(file, fs.readFileSync(file, "utf8").replace(/question: .*/, `question: ${JSON.stringify(HOSTILE)}`));
  program("report", "hostile-search", "-o", "hostile-search.html");
  await look("hostile-search.html", {}, async (page) => {
    page.on("dialog", () => assert.fail("a script of a name ran"));
    assert.equal(await page.locator("img[src=x]").count(), 0);
    assert.ok((await page.locator("body").innerText()).includes("<img src=x onerror=alert(1)>"));
  });
});
