/**
 * A case as plain data, like a case file: its place in the address, and its text as TOML and Python.
 *
 *     { gravity, link: [{mass, length, center, inertia}], effect: [{kind, ...}],
 *       start: {q, qd}, run: {t_start, t_end, method, rtol, atol, ...} }
 */

import { knownCase } from "./known_case.mjs";

/** JSON has no infinity, so that it is written as a word; a run may have that word as its name. */
export function parseCase(text) {
  return JSON.parse(text, (key, value) =>
    key === "name" ? value : value === "inf" ? Infinity : value === "-inf" ? -Infinity : value,
  );
}

export function writeCase(given) {
  return JSON.stringify(given, (_key, value) =>
    value === Infinity ? "inf" : value === -Infinity ? "-inf" : value,
  );
}

/** The case in the address, or null if there is none. What is no case is refused with an error. */
export function caseInAddress(known) {
  const found = /[#&]case=([^&]+)/.exec(location.hash);
  if (!found) return null;
  let given;
  try {
    given = parseCase(decodeURIComponent(found[1]));
  } catch {
    throw new Error("it is damaged, or was cut short");
  }
  return knownCase(given, known);
}

export function addressOf(given) {
  return `#case=${encodeURIComponent(writeCase(given))}`;
}

function tomlValue(value) {
  if (Array.isArray(value)) return `[${value.map(tomlValue).join(", ")}]`;
  if (typeof value === "string") return JSON.stringify(value).replaceAll("\x7f", "\\u007f");
  if (typeof value === "object") {
    const parts = Object.entries(value).map(([name, one]) => `${name} = ${tomlValue(one)}`);
    return `{ ${parts.join(", ")} }`;
  }
  return String(value)
    .replace("Infinity", "inf")
    .replace(/^(-?\d+)e/, "$1.0e");
}

function tomlTable(table) {
  const lines = Object.entries(table).map(([name, value]) => `${name} = ${tomlValue(value)}\n`);
  return lines.join("");
}

/** The text of a case file, which `pendcore run` takes. */
export function toToml(given) {
  const { link, effect, start, run, ...top } = given;
  return [
    tomlTable(top),
    ...link.map((one) => `\n[[link]]\n${tomlTable(one)}`),
    ...effect.map((one) => `\n[[effect]]\n${tomlTable(one)}`),
    `\n[start]\n${tomlTable(start)}`,
    `\n[run]\n${tomlTable(run)}`,
  ].join("");
}

function pythonValue(value) {
  if (Array.isArray(value)) return `[${value.map(pythonValue).join(", ")}]`;
  if (typeof value === "string") return JSON.stringify(value);
  if (typeof value === "boolean") return value ? "True" : "False";
  if (value === Infinity || value === -Infinity) return `float("${value > 0 ? "inf" : "-inf"}")`;
  return String(value);
}

function pythonCall(name, parameters, partOf) {
  const given = Object.entries(parameters).map(([key, value]) => {
    const isPart = typeof value === "object" && !Array.isArray(value);
    return `${key}=${isPart ? pythonCall(`pc.effects.${partOf[key]}`, value, partOf) : pythonValue(value)}`;
  });
  return `${name}(${given.join(", ")})`;
}

/** The same run in Python. `kinds` are the descriptors of effects. */
export function toPython(given, kinds) {
  const lines = ["import pendcore as pc", "", "scene = pc.Scene("];
  lines.push("    links=[");
  for (const one of given.link) lines.push(`        ${pythonCall("pc.Link", one, {})},`);
  lines.push("    ],", `    gravity=${pythonValue(given.gravity)},`);
  if (given.effect.length > 0) {
    lines.push("    effects=[");
    for (const { kind, ...parameters } of given.effect) {
      const known = kinds.find((one) => one.kind === kind);
      const partOf = Object.fromEntries(known.parameters.map((one) => [one.name, one.type]));
      lines.push(`        ${pythonCall(`pc.effects.${known.name}`, parameters, partOf)},`);
    }
    lines.push("    ],");
  }
  lines.push(")", "sol = pc.simulate(");
  const { t_start, t_end, ...options } = given.run;
  lines.push(`    scene, q0=${pythonValue(given.start.q)}, qd0=${pythonValue(given.start.qd)},`);
  lines.push(`    t_span=(${t_start ?? 0}, ${t_end}),`);
  for (const [name, value] of Object.entries(options))
    lines.push(`    ${name}=${pythonValue(value)},`);
  lines.push(")", "");
  return lines.join("\n");
}
