/**
 * Runs a program that was compiled for WebAssembly:
 *
 *     node --experimental-wasm-relaxed-simd cpp/wasm/run.mjs [--emulated] PROGRAM [ARGUMENT ...]
 *
 * Node 20 has the fused instruction only with that option. With --emulated, a b + c is computed from
 * sums and products whatever the engine offers. What is used, and by how many calls, is said on
 * standard error.
 */

import { readFileSync } from "node:fs";
import { fuses, imports, PendcoreError, withInstructions } from "./engine.mjs";

const words = process.argv.slice(2);
const emulated = words[0] === "--emulated";
if (emulated) words.shift();
const given = readFileSync(words[0]);
let bytes = given;
if (!emulated && fuses()) {
  const found = withInstructions(given);
  bytes = found.bytes;
  console.error(`fma by the engine's instruction, in ${found.calls} places`);
} else {
  console.error("fma from sums and products");
}

const host = {
  arguments: words,
  print: (line, file) => (file === 1 ? console.log(line) : console.error(line)),
  exit: (code) => process.exit(code),
};
const module = await WebAssembly.compile(bytes);
const { exports } = await WebAssembly.instantiate(module, imports(host));
host.memory = exports.memory;
try {
  exports._initialize();
  exports.exit(exports.__main_void());
} catch (error) {
  if (!(error instanceof PendcoreError)) throw error;
  console.error(error.message);
  process.exit(1);
}
