// Validates every .gltf and .glb file below a folder with Khronos' validator. Resources are read from disk.
// usage: node validate.mjs <folder>; the exit code is 1 when a file has errors, or when there is no file to validate.
import { readdir, readFile } from "node:fs/promises";
import path from "node:path";
import process from "node:process";
import validator from "gltf-validator";

const SEVERITIES = ["error", "warning"];

const [folder] = process.argv.slice(2);
if (!folder) {
  console.error("usage: node validate.mjs <folder>");
  process.exit(2);
}

const names = await readdir(folder, { recursive: true });
const files = names.filter((name) => /\.gl(tf|b)$/i.test(name)).sort();
let errors = 0;
for (const name of files) {
  const file = path.join(folder, name);
  const report = await validator.validateBytes(new Uint8Array(await readFile(file)), {
    uri: name,
    maxIssues: 0,
    externalResourceFunction: async (uri) =>
      new Uint8Array(await readFile(path.join(path.dirname(file), decodeURIComponent(uri)))),
  });
  errors += report.issues.numErrors;
  console.log(`${name}: ${report.issues.numErrors} error(s), ${report.issues.numWarnings} warning(s)`);
  for (const { severity, code, message, pointer } of report.issues.messages) {
    if (severity < SEVERITIES.length) {
      console.log(`  ${SEVERITIES[severity]} ${code} at ${pointer}: ${message}`);
    }
  }
}
if (files.length === 0) {
  console.error(`${folder}: expected .gltf or .glb files, found none`);
}
process.exit(errors > 0 || files.length === 0 ? 1 : 0);
