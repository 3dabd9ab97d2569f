// Runs cases in the WebAssembly module, as its users do: reads a list of cases as JSON from standard
// input and writes what came of each.
//
//     node [--experimental-wasm-relaxed-simd] tests/elsewhere/javascript.mjs PACKAGE < cases.json

import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const folder = resolve(process.argv[2]);
const { load, PendcoreError } = await import(pathToFileURL(join(folder, "pendcore.mjs")));
const core = await load(readFileSync(join(folder, "pendcore.wasm")));

function digest(...arrays) {
  const hash = createHash("sha256");
  for (const array of arrays) hash.update(new Uint8Array(array.buffer));
  return hash.digest("hex");
}

function outcome({ scene, start, options, at, t_longer }) {
  try {
    const built = core.scene(scene);
    const run = built.simulate({ ...start, ...options });
    const { q0, qd0 } = start;
    const longer = t_longer === undefined ? run : run.resume(t_longer);
    return {
      status: run.status,
      method: run.method,
      message: run.message,
      accepted: run.statistics.accepted,
      hash: run.hash,
      run: digest(run.t, run.states),
      at: digest(run.at(at)),
      longer: digest(longer.t, longer.states),
      state: digest(
        built.accelerations(0, q0, qd0),
        built.reactions(0, q0, qd0),
        built.energies(0, q0, qd0),
        built.positions(0, q0),
      ),
    };
  } catch (error) {
    if (!(error instanceof PendcoreError)) throw error;
    return { error: error.message };
  }
}

const cases = JSON.parse(readFileSync(0, "utf8"));
console.log(JSON.stringify(cases.map(outcome)));
