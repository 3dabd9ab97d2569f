/** Reads addresses as the page does; prints what each of them is as a case, as TOML and as Python. */

import {
  addressOf,
  caseInAddress,
  toPython,
  toToml,
  writeCase,
} from "../../python/pendcore/page/case.mjs";

/** @type {any} */
const here = globalThis;
let text = "";
for await (const piece of process.stdin) text += piece;
const { known, addresses } = JSON.parse(text);
const found = addresses.map((hash) => {
  here.location = { hash };
  try {
    const given = caseInAddress(known);
    if (given === null) return null;
    const again = addressOf(given);
    return {
      text: writeCase(given),
      toml: toToml(given),
      python: toPython(given, known.kinds),
      again,
    };
  } catch (error) {
    return { refused: error.message };
  }
});
console.log(JSON.stringify(found));
