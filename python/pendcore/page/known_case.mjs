/**
 * The door for a case that comes from outside: what is let in has known keys alone, each with a
 * value of its type, so that it may be written as code. The core checks ranges.
 */

const isNumber = (value) => typeof value === "number" && !Number.isNaN(value);
const isRow = (value) => Array.isArray(value) && value.every(isNumber);
/** Half of a surrogate pair is no text: neither TOML nor a file of Python can hold it. */
const isText = (value) => typeof value === "string" && !/\p{Surrogate}/u.test(value);

/** What copies a value that passes a test, or throws an error that names it. */
function mustBe(told, test) {
  return (where, value) => {
    if (!test(value)) throw new Error(`${where}: must be ${told}`);
    return Array.isArray(value) ? [...value] : value;
  };
}

/** What reads values of each type. */
const TYPES = {
  int: mustBe("a whole number", Number.isInteger),
  float: mustBe("a number", isNumber),
  "optional float": mustBe("a number", isNumber),
  pair: mustBe("two numbers", (value) => isRow(value) && value.length === 2),
  floats: mustBe("a list of numbers", isRow),
  "float or floats": mustBe("a number, or a list of them", (x) => isNumber(x) || isRow(x)),
  bool: mustBe("true or false", (value) => typeof value === "boolean"),
};
const finite = mustBe("a finite number", Number.isFinite);

function oneOf(words) {
  return mustBe(`one of ${words.join(", ")}`, (value) => words.includes(value));
}

/** A field that a table may have, and what reads its value. */
function field(name, read, required = true) {
  return { name, read, required };
}

/** A copy of a table with the fields that it may have. What is null counts as left out. */
function table(where, given, fields) {
  const inside = where && `${where}: `;
  if (typeof given !== "object" || given === null || Array.isArray(given))
    throw new Error(`${inside}must be a table`);
  const made = {};
  for (const [name, value] of Object.entries(given)) {
    const known = fields.find((one) => one.name === name);
    if (!known) throw new Error(`${inside}there is no ${JSON.stringify(name.slice(0, 40))}`);
    if (value !== null) made[name] = known.read(`${inside}${name}`, value);
  }
  const missing = fields.find((one) => one.required && !Object.hasOwn(made, one.name));
  if (missing) throw new Error(`${inside}${missing.name} is missing`);
  return made;
}

function list(where, given, read) {
  if (!Array.isArray(given)) throw new Error(`${where}: must be a list`);
  return given.map((one, i) => read(`${where} ${i + 1}`, one));
}

/** The fields of an effect, or of a part of one, which is a table itself. */
function parametersOf(described, kinds) {
  return described.parameters.map(({ name, type, required }) => {
    const part = kinds.find((one) => one.name === type);
    const read = part
      ? (where, value) => table(where, value, parametersOf(part, kinds))
      : TYPES[type];
    return field(name, read, required);
  });
}

function effect(where, given, kinds) {
  const described = kinds.find((one) => one.kind !== "" && one.kind === given?.kind);
  if (!described) throw new Error(`${where}: kind: is none that this page knows`);
  const kind = field("kind", oneOf([described.kind]));
  return table(where, given, [kind, ...parametersOf(described, kinds)]);
}

/**
 * A copy of a case, or an error that says what is wrong with it. `kinds` are the descriptors of
 * effects and their parts, `options` those of a run: name, and type or words.
 */
export function knownCase(given, { kinds, options }) {
  const ofLink = ["mass", "length", "center", "inertia"].map((x) => field(x, TYPES.float));
  const count = Array.isArray(given?.link) ? given.link.length : 0;
  if (count === 0) throw new Error("link: must be a list of one or more");
  const isOfState = (value) =>
    isRow(value) && value.length === count && value.every(Number.isFinite);
  const row = mustBe(`${count} finite numbers`, isOfState);
  const rows = ["q", "qd"].map((name) => field(name, row));
  const ofRun = options.map(({ name, words, type }) =>
    field(name, words ? oneOf(words) : TYPES[type], false),
  );
  const times = [field("t_start", finite, false), field("t_end", finite)];
  return table("", given, [
    field("name", mustBe("text", isText), false),
    field("gravity", TYPES.float),
    field("link", (where, x) => list(where, x, (at, one) => table(at, one, ofLink))),
    field("effect", (where, x) => list(where, x, (at, one) => effect(at, one, kinds))),
    field("start", (where, x) => table(where, x, rows)),
    field("run", (where, x) => table(where, x, [...times, ...ofRun])),
  ]);
}
