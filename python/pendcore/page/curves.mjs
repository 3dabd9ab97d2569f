/** The curves beside the picture: angles, energies, and any variable over any other. */

import { Chart } from "./chart.mjs";

const LINKS = [1, 2, 3, 4, 5, 6].map((i) => `link-${i}`);
const ENERGIES = ["part-1", "part-2", "ink"];
const ACCOUNTS = ["part-3", "part-4", "part-5", "quiet"];
const METHODS = ["ink", ...LINKS];
const POINTS = { least: 1500, most: 6000, angle: 0.1 }; // between two, a link turns by this, rad

const TURN = 2 * Math.PI;
/** The same angle from -pi to pi, rad. */
const wrapped = (angle) => angle - TURN * Math.round(angle / TURN);

/** What can be drawn. Those of a link have an index; `of` gets a run, a time, a state and it. */
const QUANTITIES = [
  { name: "q", unit: "rad", perLink: true, isAngle: true, of: (_run, _t, state, i) => state[i] },
  { name: "qd", unit: "rad/s", perLink: true, of: (run, _t, state, i) => state[run.n + i] },
  {
    name: "force at joint",
    unit: "N",
    perLink: true,
    of: (run, t, state, i) => Math.hypot(...run.reactions(t, state).subarray(2 * i, 2 * i + 2)),
  },
  { name: "tip x", unit: "m", of: (run, t, state) => run.places(t, state).at(-2) },
  {
    name: "tip y, down",
    unit: "m",
    isDown: true,
    of: (run, t, state) => run.places(t, state).at(-1),
  },
  { name: "kinetic energy", unit: "J", of: (run, t, state) => run.energies(t, state)[0] },
  { name: "potential energy", unit: "J", of: (run, t, state) => run.energies(t, state)[1] },
  { name: "t", unit: "s", isTime: true, of: (_run, t) => t },
];

/** The quantities for a menu: of all links together, then of each link, then of the whole. */
function choices(n) {
  const label = (one, name) => ({ ...one, label: `${name} (${one.unit})` });
  const ofLinks = QUANTITIES.filter((one) => one.perLink);
  const together = ofLinks.map((one) => ({ ...label(one, one.name), isTogether: true }));
  const single = Array.from({ length: n }, (_x, i) =>
    ofLinks.map((one) => ({ ...label(one, `${one.name} ${i + 1}`), link: i })),
  ).flat();
  const whole = QUANTITIES.filter((one) => !one.perLink).map((one) => label(one, one.name));
  return [...together, ...single, ...whole];
}

export class Curves {
  /** The times at which the run is drawn, and its states then. */
  times = [];
  states = [];
  n = 0;
  /** A second run, whose angles are dashed, or null. */
  other = null;
  /** Until when the run is right, s; null if that is not known. */
  until = null;

  constructor(byId) {
    this.angles = new Chart(byId("angles"), ["t (s)", "q (deg)"]);
    this.chosen = new Chart(byId("phase"), ["", ""]);
    this.energy = new Chart(byId("energy"), ["t (s)", "energy (J)"]);
    this.menus = [byId("across"), byId("up")];
  }

  set(run) {
    this.run = run;
    this.#sample(POINTS.least);
    const needed = Math.ceil((this.fastest * Math.abs(run.end - run.begin)) / POINTS.angle);
    if (needed > POINTS.least) this.#sample(Math.min(needed, POINTS.most));
    this.#fillMenus();
    const { times, states } = this;
    this.#drawAngles();
    const energies = times.map((t, k) => run.energies(t, states[k]));
    const own = ["kinetic", "potential", "total"].map((name, k) => ({
      name,
      color: ENERGIES[k],
      x: times,
      y: energies.map(([T, V]) => [T, V, T + V][k]),
    }));
    const booked = run.ledger(times).map((y, k) => ({
      name: run.accounts[k].replace(/^-(.*)/, "$1 (lost)"),
      color: ACCOUNTS[k % ACCOUNTS.length],
      x: times,
      y,
    }));
    this.energy.set([...own, ...booked]);
    this.choose();
  }

  /** Takes a second run beside the first, or none. */
  compare(other) {
    this.other = other;
    this.#drawAngles();
  }

  #drawAngles() {
    const { times, states, run, other } = this;
    const ofOther = other ? other.states(times) : [];
    const curves = (rows, name, dash) =>
      Array.from({ length: rows.length ? run.n : 0 }, (_x, i) => ({
        name: `${name}q${subscript(i + 1)}`,
        color: LINKS[i % LINKS.length],
        x: times,
        y: rows.map((state) => (state[i] * 180) / Math.PI),
        dash,
      }));
    this.angles.set([...curves(states, "", []), ...curves(ofOther, "other ", [5, 4])]);
  }

  /** Takes some times in each of the run's own steps, so that there are at least `count` in all. */
  #sample(count) {
    const { run } = this;
    const steps = [...run.steps];
    const parts = run.count === Infinity ? Math.ceil(count / Math.max(steps.length - 1, 1)) : 1;
    this.times = steps.slice(1).flatMap((end, k) => {
      const begin = steps[k];
      return Array.from({ length: parts }, (_x, i) => begin + ((end - begin) * i) / parts);
    });
    this.times.push(run.end);
    this.states = run.states(this.times);
  }

  /** The largest rate of a link, rad/s. */
  get fastest() {
    const rates = this.states.flatMap((state) => [...state.subarray(this.n)].map(Math.abs));
    return rates.reduce((largest, rate) => (rate > largest ? rate : largest), 0);
  }

  /** The menus keep what was chosen in them, unless a link of it is gone. */
  #fillMenus() {
    if (this.n === this.run.n) return;
    this.n = this.run.n;
    this.offered = choices(this.n);
    for (const [k, menu] of this.menus.entries()) {
      const before = menu.value || this.offered[k].label;
      menu.replaceChildren(...this.offered.map(({ label }) => new Option(label, label)));
      const isOffered = this.offered.some(({ label }) => label === before);
      menu.value = isOffered ? before : this.offered[k].label;
    }
  }

  /** Draws what the menus say: a curve for each link where a quantity of all links is chosen. */
  choose() {
    const { run, times, states } = this;
    const [x, y] = this.menus.map((menu) => this.offered.find(({ label }) => label === menu.value));
    this.chosen.names = [x, y].map((one) =>
      one.isAngle && !x.isTime ? one.label.replace(" (", ", within a turn (") : one.label,
    );
    this.chosen.isDown = y.isDown === true;
    this.isOverTime = x.isTime === true;
    const isTogether = x.isTogether || y.isTogether;
    this.isWrapped = !this.isOverTime;
    this.pairs = Array.from({ length: isTogether ? run.n : 1 }, (_x, i) => ({
      name: isTogether ? `link ${i + 1}` : "",
      color: isTogether ? LINKS[i % LINKS.length] : LINKS[(x.link ?? y.link ?? 0) % LINKS.length],
      at: (t, state) => [x, y].map((one) => this.#value(one, run, t, state, i)),
    }));
    // What is wrong is no portrait of the motion: the curves end where the run is right no more.
    const isRight = (t) =>
      this.isOverTime || this.until === null || run.direction * (t - this.until) <= 0;
    const last = times.findLastIndex(isRight) + 1;
    this.chosen.set(
      this.pairs.map(({ name, color, at }) => {
        const points = times.slice(0, last).map((t, k) => at(t, states[k]));
        return { name, color, ...torn(points, [x, y]) };
      }),
    );
  }

  /** A quantity; an angle that is not drawn over time is within a turn. */
  #value(one, run, t, state, i) {
    const value = one.of(run, t, state, one.link ?? i);
    return one.isAngle && this.isWrapped ? wrapped(value) : value;
  }

  /** Marks the present, and shades what lies past the time until which the run is right. */
  draw(t, state, past) {
    this.angles.draw({ past, now: t });
    this.energy.draw({ past, now: t });
    const points = this.pairs.map(({ color, at }) => {
      const [x, y] = at(t, state);
      return { x, y, color };
    });
    const isRight = past === null || this.run.direction * (t - past) <= 0;
    this.chosen.draw(this.isOverTime ? { past, now: t } : { points: isRight ? points : [] });
  }
}

/** A whole number as an index. */
function subscript(number) {
  return String(number).replace(/\d/g, (digit) => "₀₁₂₃₄₅₆₇₈₉"[Number(digit)]);
}

/** Points as x and y, with a gap where an angle jumps by a turn. */
function torn(points, quantities) {
  const isJump = (k) =>
    quantities.some(
      (one, axis) => one.isAngle && Math.abs(points[k][axis] - points[k - 1][axis]) > Math.PI,
    );
  const shown = points.flatMap((point, k) => (k > 0 && isJump(k) ? [[NaN, NaN], point] : [point]));
  return { x: shown.map((one) => one[0]), y: shown.map((one) => one[1]) };
}

/** What accuracy costs: the runs of each method, error against time. */
export function drawCost(chart, points) {
  const methods = [...new Set(points.map((one) => one.method))];
  chart.set(
    methods.map((name, k) => {
      const own = points.filter((one) => one.method === name && one.error > 0);
      const [x, y] = [own.map((one) => one.ms), own.map((one) => one.error)];
      return { name, color: METHODS[k % METHODS.length], dots: true, x, y };
    }),
  );
  chart.draw();
}
