// Bundles scripts and style of the pages: node build.mjs OUT, where node_modules is.
import { build } from "esbuild";
import fs from "node:fs";
import path from "node:path";

const [out] = process.argv.slice(2);
const common = { bundle: true, minify: true, legalComments: "none", logLevel: "warning", charset: "ascii", target: "es2020" };

const used = new Set();  // packages
for (const [from, to] of [["src/main.js", "page.js"], ["src/libraries.js", "libraries.js"]]) {
  const { metafile } = await build({
    ...common,
    entryPoints: [from],
    outfile: path.join(out, to),
    format: "iife",
    metafile: true,
    supported: { "inline-script": false },  // no text of it ends a script element
  });
  for (const input of Object.keys(metafile.inputs)) {
    const found = input.match(/^node_modules\/((?:@[^/]+\/)?[^/]+)/);
    if (found) used.add(found[1]);
  }
}
await build({ ...common, entryPoints: ["src/page.css"], outfile: path.join(out, "page.css") });

const licences = [...used].sort().map((name) => {
  const folder = path.join("node_modules", name);
  const { version, license } = JSON.parse(fs.readFileSync(path.join(folder, "package.json"), "utf8"));
  const file = fs.readdirSync(folder).find((each) => /^licen[sc]e/i.test(each));
  return `${name} ${version} (${license})\n\n${file ? fs.readFileSync(path.join(folder, file), "utf8") : ""}`;
});
fs.writeFileSync(path.join(out, "licences.txt"), licences.join("\n----\n\n"));
