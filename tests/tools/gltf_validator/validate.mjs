// node validate.mjs NODE_MODULES FILE...: the Khronos validator's errors and warnings, a line each; ends with 1 if there
// are any.
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { resolve } from "node:path";

const [modules, ...files] = process.argv.slice(2);
const { validateBytes } = createRequire(resolve(modules, "x"))("gltf-validator");
const kWarning = 1; // severities: 0 error, 1 warning, 2 information, 3 hint

let complaints = 0;
for (const file of files) {
  const report = await validateBytes(new Uint8Array(await readFile(file)), { uri: file, maxIssues: 0 });
  for (const { severity, code, message, pointer } of report.issues.messages) {
    if (severity > kWarning) continue;
    console.log(`${severity === 0 ? "error" : "warning"} ${code} at ${pointer}: ${message}`);
    ++complaints;
  }
}
process.exit(complaints === 0 ? 0 : 1);
