// usage: node validate.mjs SCHEMA.xsd FILE.xml
// The exit code is 1, with a line for each error, when FILE does not satisfy SCHEMA.
import { readFileSync } from "node:fs";
import { validateXML } from "xmllint-wasm";

const [schema, file] = process.argv.slice(2).map((path) => readFileSync(path, "utf8"));
const { valid, errors } = await validateXML({ xml: [{ fileName: "report.xml", contents: file }], schema: [schema] });
for (const { message, rawMessage } of errors) console.error(message ?? rawMessage);
process.exit(valid ? 0 : 1);
