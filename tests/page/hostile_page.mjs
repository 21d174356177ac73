// Names that would be markup run nothing and are shown as they are.
import assert from "node:assert/strict";
import fs from "node:fs";
import { test } from "node:test";
import { at, json, look, program } from "./surroundings.mjs";

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
