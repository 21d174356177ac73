// Bundles scripts and style of the pages: node build.mjs OUT COPYRIGHT, in the folder of node_modules. COPYRIGHT: copyright file of our own code.
import { build } from "esbuild";
import fs from "node:fs";
import path from "node:path";
import { asCopyright, asText, licenceOf } from "./licences.mjs";

const [out, ours] = process.argv.slice(2);
const common = { bundle: true, minify: true, legalComments: "none", logLevel: "warning", charset: "ascii", target: "es2020" };

const used = new Set();  // folders of packages, also of those within others
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
    const found = input.match(/^(?:.*\/)?node_modules\/(?:@[^/]+\/)?[^/]+/);
    if (found) used.add(found[0]);
  }
}
await build({ ...common, entryPoints: ["src/page.css"], outfile: path.join(out, "page.css") });

const packages = [...used].sort().map(licenceOf);
fs.writeFileSync(path.join(out, "licences.txt"), asText(packages));
fs.writeFileSync(path.join(out, "copyright"), `${fs.readFileSync(ours, "utf8")}\n${asCopyright(packages)}`);
