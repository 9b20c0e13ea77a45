// Runs the engine of the browser page in Node, with the page's own WASI.
//
//   node browser/run_engine.mjs ENGINE DATA OPTIONS OUTPUT [FILE...]
//
// ENGINE and DATA: retarget.wasm and data.bundle. OPTIONS: a JSON object of options by name. FILE...: are copied to /job,
// where options refer to them. OUTPUT: a folder for what the engine writes. Prints the seconds of the run.

import fs from "node:fs";
import path from "node:path";
import { unpackBundle } from "./page/bundle.js";
import { MemoryFiles, runProgram } from "./page/wasi.js";

const [engine, data, options, output, ...given] = process.argv.slice(2);
const files = unpackBundle(new Uint8Array(fs.readFileSync(data)));
for (const file of given) files.push([`job/${path.basename(file)}`, new Uint8Array(fs.readFileSync(file))]);
files.push(["job/options.json", new TextEncoder().encode(JSON.stringify({ output: "/out/motion.csv", ...JSON.parse(options) }))]);
const compiled = await WebAssembly.compile(fs.readFileSync(engine));
const words = options === "{}" ? ["options"] : ["solve", "/job/options.json"];
const begin = performance.now();
const result = runProgram(compiled, ["retarget", ...words], new MemoryFiles(files));
const seconds = (performance.now() - begin) / 1000;
for (const line of result.errors) if (!line.startsWith("progress ")) console.error(line);
fs.mkdirSync(output, { recursive: true });
for (const [name, bytes] of result.files) {
  if (name.startsWith("out/")) fs.writeFileSync(path.join(output, name.slice(4)), bytes);
}
console.log(seconds.toFixed(3));
process.exitCode = result.code;
