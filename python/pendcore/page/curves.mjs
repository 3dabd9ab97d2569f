/** The curves beside the picture: angles, energies, and any variable over any other. */

import { Chart } from "./chart.mjs";
import { grid } from "./simulate.mjs";

const COLORS = ["first", "second", "third", "fourth"];
const ACCOUNTS = ["fourth", "faint", "ink"];
const POINTS = { least: 1500, most: 6000, angle: 0.1 }; // between two, a link turns by this, rad

/** What can be drawn. Those of a link have an index; `of` gets a run, a time, a state and it. */
const QUANTITIES = [
  { name: "q", unit: "rad", perLink: true, of: (_run, _t, state, i) => state[i] },
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
    this.angles.set(
      Array.from({ length: run.n }, (_x, i) => ({
        name: `q${i + 1}`,
        color: COLORS[i % COLORS.length],
        x: times,
        y: states.map((state) => (state[i] * 180) / Math.PI),
      })),
    );
    const energies = times.map((t, k) => run.energies(t, states[k]));
    const own = ["kinetic", "potential", "total"].map((name, k) => ({
      name,
      color: COLORS[k],
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

  #sample(count) {
    const { run } = this;
    this.times = grid(run.begin, run.end, Math.min(run.count, count));
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
    this.chosen.names = [x.label, y.label];
    this.chosen.isDown = y.isDown === true;
    this.isOverTime = x.isTime === true;
    const isTogether = x.isTogether || y.isTogether;
    this.pairs = Array.from({ length: isTogether ? run.n : 1 }, (_x, i) => ({
      name: isTogether ? `link ${i + 1}` : "",
      color: COLORS[i % COLORS.length],
      at: (t, state) => [x, y].map((one) => one.of(run, t, state, one.link ?? i)),
    }));
    this.chosen.set(
      this.pairs.map(({ name, color, at }) => {
        const points = times.map((t, k) => at(t, states[k]));
        return { name, color, x: points.map((one) => one[0]), y: points.map((one) => one[1]) };
      }),
    );
  }

  /** Marks the present, and shades what lies past the time until which the run is right. */
  draw(t, state, past) {
    this.angles.draw({ past, now: t });
    this.energy.draw({ past, now: t });
    const points = this.pairs.map(({ color, at }) => {
      const [x, y] = at(t, state);
      return { x, y, color };
    });
    this.chosen.draw(this.isOverTime ? { past, now: t } : { points });
  }
}

/** What accuracy costs: the runs of each method, error against time. */
export function drawCost(chart, points) {
  const methods = [...new Set(points.map((one) => one.method))];
  chart.set(
    methods.map((name, k) => {
      const own = points.filter((one) => one.method === name && one.error > 0);
      const [x, y] = [own.map((one) => one.ms), own.map((one) => one.error)];
      return { name, color: COLORS[k % COLORS.length], dots: true, x, y };
    }),
  );
  chart.draw();
}
