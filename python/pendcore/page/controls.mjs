/** Sliders and fields for everything that a case has, made from the core's descriptors. */

function element(tag, properties = {}, children = []) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name in made) made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

let counter = 0;

/** A power of ten that divides an interval into 200 to 2000 parts. */
function roundStep(size) {
  return Number(`1e${Math.floor(Math.log10(size / 200))}`);
}

/** The multiple of a step beside a value, so that the round values of a slider can be reached. */
function rounded(value, step, round) {
  return Number((round(Number((value / step).toPrecision(12))) * step).toPrecision(12));
}

/** A number with a slider; `change` gets the new value. */
export function numberField({
  name,
  unit,
  value,
  low,
  high,
  whole = false,
  positive = false,
  change,
}) {
  const step = whole ? 1 : roundStep(high - low);
  const field = element("input", {
    type: "number",
    step: whole ? "1" : "any",
    value: String(Number(value.toPrecision(7))),
  });
  const slider = element("input", {
    type: "range",
    min: String(positive ? step : rounded(low, step, Math.floor)),
    max: String(rounded(high, step, Math.ceil)),
    step: String(step),
    value: String(value),
    "aria-label": `${name}, ${unit || "no unit"}`,
  });
  const take = (text, other) => {
    const number = Number(text);
    // On the way to 0.5 a field holds 0, which is no mass and no length.
    const isNumber = text !== "" && Number.isFinite(number) && (number > 0 || !positive);
    field.setAttribute("aria-invalid", String(!isNumber));
    if (!isNumber) return;
    other.value = text;
    change(number);
  };
  field.addEventListener("input", () => take(field.value, slider));
  slider.addEventListener("input", () => take(slider.value, field));
  return labelled(unit ? `${name} (${unit.replace("^2", "²")})` : name, field, slider);
}

/** A name before its field, and what else belongs to it. */
function labelled(name, field, ...more) {
  field.id = `field-${++counter}`;
  const label = element("label", { htmlFor: field.id, textContent: name });
  return element("div", { className: "parameter" }, [label, field, ...more]);
}

/** A menu of values, each with the text that it shows. */
function menuOf(options, properties = {}) {
  const shown = options.map(([value, textContent]) => element("option", { value, textContent }));
  return element("select", properties, shown);
}

function choice(name, words, value, change) {
  const select = menuOf(words.map((one) => [one, one]));
  select.value = value;
  select.addEventListener("change", () => change(select.value));
  return labelled(name, select);
}

/**
 * An interval for a slider about a value, within what the descriptor allows: "0 to 1", "> 0".
 *
 * @returns {[number, number]}
 */
function interval(value, range) {
  const size = value === 0 ? 1 : 3 * Math.abs(value);
  const both = /^([0-9.]+) to ([0-9.]+)$/.exec(range);
  if (both) return [Number(both[1]), Number(both[2])];
  const least = />=? ([0-9.]+)/.exec(range);
  return least ? [Number(least[1]), Number(least[1]) + size] : [-size, size];
}

const LETTERS = { tau: "τ", phid: "φ̇", phi: "φ", omega: "ω", rho: "ρ", phase: "ψ" };
const UPRIGHT = new Set("sin exp sgn at an or is of to the air constant".split(" "));

/** A law as the core tells it, in HTML: letters in italics, indices, powers, signs. */
export function formula(law) {
  return law
    .replaceAll("<=", "≤")
    .replaceAll("+-", "±")
    .replaceAll("&", "&amp;")
    .replace(/abs\(([^()]+)\)/g, "|$1|")
    .replace(/(^|[ (=])-(?=[ (|\w])/g, "$1−")
    .replace(/[A-Za-z]+(?=[\d_^ ,;)(/+|*-]|$)/g, (word) =>
      LETTERS[word] || (word.length < 3 && !UPRIGHT.has(word))
        ? `<i>${LETTERS[word] ?? word}</i>`
        : word,
    )
    .replace(/(<\/i>)(\d)/g, "$1<sub>$2</sub>")
    .replace(/_(?:<i>)?(\w+)(?:<\/i>)?/g, "<sub>$1</sub>")
    .replace(/\^(?:<i>)?(\w+)(?:<\/i>)?/g, "<sup>$1</sup>");
}

export class Controls {
  /** `changed` is called when the case has changed; the fields stay, unless it has other parts. */
  constructor(box, { kinds, defaults, changed }) {
    this.box = box;
    this.kinds = kinds;
    this.defaults = defaults;
    this.changed = changed;
    this.given = null;
  }

  show(given) {
    this.given = given;
    this.box.replaceChildren(
      this.#world(),
      ...given.link.map((link, i) => this.#link(link, i)),
      ...given.effect.map((effect, i) => this.#effect(effect, i)),
      this.#more(),
    );
  }

  #group(title, fields) {
    return element("fieldset", {}, [element("legend", { textContent: title }), ...fields]);
  }

  #field(name, unit, value, [low, high], set, more = {}) {
    const change = (number) => {
      set(number);
      this.changed();
    };
    return numberField({ name, unit, value, low, high, change, ...more });
  }

  #world() {
    const { given } = this;
    const begin = given.run.t_start ?? 0;
    return this.#group("World", [
      this.#field("gravity", "m/s^2", given.gravity, [0, 25], (x) => (given.gravity = x)),
      this.#field(
        "end of the run",
        "s",
        given.run.t_end,
        [begin + 1, begin + 120],
        (x) => (given.run.t_end = x),
      ),
    ]);
  }

  #link(link, i) {
    const { start } = this.given;
    const degrees = 180 / Math.PI;
    // A link keeps its shape: its centre moves with its length, its inertia with both.
    const center = link.center / link.length;
    const shape = link.mass > 0 ? link.inertia / (link.mass * link.length ** 2) : 0;
    const scale = (mass, length) => {
      const inertia = shape * mass * length ** 2;
      Object.assign(link, { mass, length, center: center * length, inertia });
    };
    const positive = { positive: true };
    return this.#group(`Link ${i + 1}`, [
      this.#field(
        "mass",
        "kg",
        link.mass,
        [0, 3 * link.mass || 3],
        (x) => scale(x, link.length),
        positive,
      ),
      this.#field(
        "length",
        "m",
        link.length,
        [0, 3 * link.length || 3],
        (x) => scale(link.mass, x),
        positive,
      ),
      this.#field(
        "angle at the start",
        "deg",
        start.q[i] * degrees,
        [-180, 180],
        (x) => (start.q[i] = x / degrees),
      ),
      this.#field("rate at the start", "rad/s", start.qd[i], [-20, 20], (x) => (start.qd[i] = x)),
    ]);
  }

  #effect(effect, i) {
    const known = this.kinds.find((one) => one.kind === effect.kind);
    const remove = element("button", { type: "button", textContent: "Remove" });
    remove.addEventListener("click", () => {
      this.given.effect.splice(i, 1);
      this.show(this.given);
      this.changed();
    });
    const fields = this.#parameters(effect, known.parameters);
    return this.#group(`${i + 1}: ${known.name}`, [
      element("p", { className: "small", textContent: known.sentence }),
      element("p", { className: "law", innerHTML: formula(known.law) }),
      ...fields,
      remove,
    ]);
  }

  #parameters(values, parameters) {
    const fields = [];
    for (const one of parameters) {
      const value = values[one.name];
      if (value === undefined || value === null) continue;
      if (typeof value === "number" && Number.isFinite(value)) {
        const whole = one.type === "int";
        /** @type {[number, number]} */
        const range = whole ? [1, this.given.link.length] : interval(value, one.range);
        fields.push(
          this.#field(one.name, one.unit, value, range, (x) => (values[one.name] = x), {
            whole,
            positive: />(?!=)/.test(one.range),
          }),
        );
      } else if (Array.isArray(value) && value.length === 2 && one.type === "pair") {
        one.components.forEach((component, k) => {
          if (!Number.isFinite(value[k])) return;
          const set = (x) => (value[k] = x);
          fields.push(
            this.#field(
              `${one.name}, ${component}`,
              one.unit,
              value[k],
              interval(value[k], one.range),
              set,
            ),
          );
        });
      } else if (typeof value === "object" && !Array.isArray(value)) {
        const part = this.kinds.find((other) => other.name === one.type);
        if (part) fields.push(...this.#parameters(value, part.parameters));
      }
    }
    return fields;
  }

  #more() {
    const named = (kind) => [kind, this.kinds.find((one) => one.kind === kind).name];
    const select = menuOf(Object.keys(this.defaults).map(named), {
      "aria-label": "Kind of effect",
    });
    const add = element("button", { type: "button", textContent: "Add" });
    add.addEventListener("click", () => {
      const copy = structuredClone(this.defaults[select.value]);
      if (copy.joint > this.given.link.length) copy.joint = 1;
      if (copy.link > this.given.link.length) copy.link = 1;
      this.given.effect.push({ kind: select.value, ...copy });
      this.show(this.given);
      this.changed();
    });
    return this.#group("More effects", [select, " ", add]);
  }
}

/** Fields for method and tolerance. */
export function methodFields(box, given, methods, changed) {
  const rtol = [given.run.rtol ?? 1e-6].flat();
  const digits = Math.round(-Math.log10(Math.min(...rtol)));
  const tolerance = numberField({
    name: "digits: rtol = 10^-digits",
    unit: "",
    value: digits,
    low: 2,
    high: 14,
    whole: true,
    change: (x) => {
      given.run.rtol = 10 ** -x;
      changed();
    },
  });
  const all = methods.includes(given.run.method) ? methods : [given.run.method, ...methods];
  const method = choice("method", all, given.run.method, (name) => {
    given.run.method = name;
    delete given.run.step; // of a method with fixed steps
    changed();
  });
  box.replaceChildren(method, tolerance);
}
