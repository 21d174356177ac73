// node validate.mjs NODE_MODULES <LIST: the Khronos validator's errors and warnings about the files of the list, which has
// a path a line; a line each, for a file at most ten. Ends with 1 if there are any.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { basename, resolve } from "node:path";

const { validateBytes } = createRequire(resolve(process.argv[2], "x"))("gltf-validator");
const kWarning = 1; // severities: 0 error, 1 warning, 2 information, 3 hint
const kMostLines = 10;
// Meshes without normals have none of the tangents either: glTF defines how readers make both.
const kAllowed = ["MESH_PRIMITIVE_GENERATED_TANGENT_SPACE"];

let complaints = 0;
for (const file of readFileSync(0, "utf8").split("\n").filter((line) => line !== "")) {
  const report = await validateBytes(new Uint8Array(readFileSync(file)), { uri: file, maxIssues: 0 });
  const found = report.issues.messages.filter(({ severity, code }) => severity <= kWarning && !kAllowed.includes(code));
  for (const { severity, code, message, pointer } of found.slice(0, kMostLines)) {
    console.log(`${basename(file)}: ${severity === 0 ? "error" : "warning"} ${code} at ${pointer}: ${message}`);
  }
  complaints += found.length;
}
process.exit(complaints === 0 ? 0 : 1);
