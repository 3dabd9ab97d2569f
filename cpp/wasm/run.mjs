/**
 * Runs a program that was compiled for WebAssembly:
 *
 *     node --experimental-wasm-relaxed-simd cpp/wasm/run.mjs [--emulated] PROGRAM [ARGUMENT ...]
 *
 * Node 20 has the fused instruction only with that option. The program runs with that instruction,
 * and an engine without it is an error. With --emulated, a b + c is computed from sums and products
 * whatever the engine offers.
 */

import { readFileSync } from "node:fs";
import { fuses, imports, PendcoreError, withInstructions } from "./engine.mjs";

function fail(why) {
  console.error(why);
  process.exit(1);
}

const words = process.argv.slice(2);
const emulated = words[0] === "--emulated";
if (emulated) words.shift();
const given = readFileSync(words[0]);
let bytes = given;
if (!emulated) {
  if (!fuses()) fail("this engine has no instruction that fuses: give --emulated");
  const found = await withInstructions(given);
  if (found.calls === 0) fail(`${words[0]} has no call of pendcore_fma to replace`);
  bytes = found.bytes;
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
