/** Sliders and fields for everything that a case has, made from the core's descriptors. */

import { convention } from "./angles.mjs";

function element(tag, properties = {}, children = []) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

const DIGITS = 6; // that a field shows; the value keeps all of its own until it is changed
const DEGREE = Math.PI / 180;

/** A power of ten that divides an interval into 200 to 2000 parts. */
function roundStep(size) {
  return Number(`1e${Math.floor(Math.log10(size / 200))}`);
}

/** The multiple of a step beside a value, so that the round values of a slider can be reached. */
function rounded(value, step, round) {
  return Number((round(Number((value / step).toPrecision(12))) * step).toPrecision(12));
}

let counter = 0;

/** A name before its field, and what else belongs to it; formulas in a name are HTML. */
function labelled(name, field, ...more) {
  field.id = `field-${++counter}`;
  const label = element("label", { htmlFor: field.id, innerHTML: name });
  return element("div", { className: "parameter" }, [label, field, ...more]);
}

/** An interval for a slider about a value, within what the descriptor allows: "0 to 1", "> 0". */
function interval(value, range) {
  const size = value === 0 ? 1 : 3 * Math.abs(value);
  const both = /^([0-9.]+) to ([0-9.]+)$/.exec(range);
  if (both) return [Number(both[1]), Number(both[2])];
  const least = />=? ([0-9.]+)/.exec(range);
  return least ? [Number(least[1]), Number(least[1]) + size] : [-size, size];
}

function group(title, fields) {
  return element("fieldset", {}, [element("legend", { textContent: title }), ...fields]);
}

function button(textContent, onclick) {
  return element("button", { type: "button", textContent, onclick });
}

export class Controls {
  /** `changed` is called when the case has changed; the fields stay, unless it has other parts. */
  constructor(byId, { kinds, defaults, methods }, changed) {
    this.boxes = [byId("setup"), byId("method")];
    this.kinds = kinds;
    this.defaults = defaults;
    this.methods = methods;
    this.changed = changed;
  }

  show(given) {
    this.given = given;
    const [setup, method] = this.boxes;
    setup.replaceChildren(
      this.#world(given),
      ...given.link.map((link, i) => this.#link(link, i)),
      ...given.effect.map((effect, i) => this.#effect(effect, i)),
      this.#more(),
    );
    method.replaceChildren(this.#method(given.run), this.#tolerance(given.run));
  }

  /** A number with a slider over an interval; `set` gets the new value. */
  #field(name, unit, value, ends, set, { symbol = "", whole = false, positive = false } = {}) {
    const [low, high] = ends;
    const step = whole ? 1 : roundStep(high - low);
    const field = element("input", { type: "number", step: whole ? "1" : "any" });
    field.value = String(Number(value.toPrecision(DIGITS)));
    const slider = element("input", {
      type: "range",
      min: String(positive ? step : rounded(low, step, Math.floor)),
      max: String(rounded(high, step, Math.ceil)),
      step: String(step),
      value: String(value),
      ariaLabel: `${name}, ${unit || "no unit"}`,
    });
    const take = (text, other) => {
      const number = Number(text);
      // On the way to 0.5 a field holds 0, which is no mass and no length.
      const isNumber = text !== "" && Number.isFinite(number) && (number > 0 || !positive);
      field.setAttribute("aria-invalid", String(!isNumber));
      if (!isNumber) return;
      other.value = text;
      set(number);
      this.changed();
    };
    field.addEventListener("input", () => take(field.value, slider));
    slider.addEventListener("input", () => take(slider.value, field));
    const inUnit = unit && `(${unit.replace("^2", "²")})`;
    return labelled([name, symbol, inUnit].filter(Boolean).join(" "), field, slider);
  }

  #world(given) {
    const { run } = given;
    const ends = [1, 120].map((length) => (run.t_start ?? 0) + length);
    return group("World", [
      this.#field("gravity", "m/s^2", given.gravity, [0, 25], (x) => (given.gravity = x)),
      this.#field("end of the run", "s", run.t_end, ends, (x) => (run.t_end = x)),
    ]);
  }

  #link(link, i) {
    const { q, qd } = this.given.start;
    // A link keeps its shape: its centre moves with its length, its inertia with both.
    const center = link.center / link.length;
    const shape = link.mass > 0 ? link.inertia / (link.mass * link.length ** 2) : 0;
    const scale = (changed) => {
      const { mass, length } = Object.assign(link, changed);
      Object.assign(link, { center: center * length, inertia: shape * mass * length ** 2 });
    };
    const size = (name, unit) => {
      const interval = [0, 3 * link[name] || 3];
      const set = (x) => scale({ [name]: x });
      return this.#field(name, unit, link[name], interval, set, { positive: true });
    };
    const { letter, dotted, angle, rate } = convention();
    const [ofAngle, ofRate] = [letter, dotted].map((one) => ({ symbol: `<i>${one}</i>` }));
    const [degrees, turning] = [angle(q[i]) / DEGREE, rate(qd[i])];
    const setAngle = (x) => (q[i] = angle(x * DEGREE));
    const setRate = (x) => (qd[i] = rate(x));
    return group(`Link ${i + 1}`, [
      size("mass", "kg"),
      size("length", "m"),
      this.#field("angle at the start", "deg", degrees, [-180, 180], setAngle, ofAngle),
      this.#field("rate at the start", "rad/s", turning, [-20, 20], setRate, ofRate),
    ]);
  }

  #effect(effect, i) {
    const known = this.kinds.find((one) => one.kind === effect.kind);
    const remove = () => {
      this.given.effect.splice(i, 1);
      this.show(this.given);
      this.changed();
    };
    return group(`${i + 1}: ${known.name}`, [
      element("p", { className: "small", textContent: known.sentence }),
      element("p", { className: "law", innerHTML: known.law }),
      ...this.#parameters(effect, known.parameters),
      button("Remove", remove),
    ]);
  }

  /** Fields for the numbers among parameters; those of a part drive what has the unit `driven`. */
  #parameters(values, parameters, driven = "") {
    return parameters.flatMap(({ name, symbol, unit, range, type, components }) => {
      const value = values[name];
      const part = this.kinds.find((one) => one.name === type);
      if (part && value) return this.#parameters(value, part.parameters, unit);
      const own = unit.includes(" or ") ? driven : unit;
      const fieldOf = (label, row, key, more) => {
        const ends = more.whole ? [1, this.given.link.length] : interval(row[key], range);
        if (!Number.isFinite(row[key]) || ends[0] === ends[1]) return [];
        return [this.#field(label, own, row[key], ends, (x) => (row[key] = x), more)];
      };
      const words = name.replaceAll("_", " ");
      if (type === "pair" && value)
        return components.flatMap((one, k) => fieldOf(`${words}, ${one}`, value, k, {}));
      return fieldOf(words, values, name, {
        symbol,
        whole: type === "int",
        positive: />(?!=)/.test(range),
      });
    });
  }

  #more() {
    const offered = this.kinds.filter(({ kind }) => kind in this.defaults);
    const options = offered.map(({ kind, name }) => new Option(name, kind));
    const select = element("select", { ariaLabel: "Kind of effect" }, options);
    const add = () => {
      const copy = structuredClone(this.defaults[select.value]);
      for (const key of ["joint", "link"]) if (copy[key] > this.given.link.length) copy[key] = 1;
      this.given.effect.push({ kind: select.value, ...copy });
      this.show(this.given);
      this.changed();
    };
    return group("More effects", [select, " ", button("Add", add)]);
  }

  #method(run) {
    const { methods } = this;
    const offered = methods.includes(run.method) ? methods : [run.method, ...methods];
    const options = offered.map((one) => new Option(one));
    const select = element("select", {}, options);
    select.value = run.method;
    select.addEventListener("change", () => {
      run.method = select.value;
      delete run.step; // of a method with fixed steps
      this.changed();
    });
    return labelled("method", select);
  }

  #tolerance(run) {
    const tightest = Math.min(...[run.rtol ?? 1e-6].flat());
    const digits = Math.round(-Math.log10(tightest));
    const set = (x) => (run.rtol = Number((10 ** -x).toPrecision(12)));
    return this.#field("digits: rtol = 10^-digits", "", digits, [2, 14], set, { whole: true });
  }
}
