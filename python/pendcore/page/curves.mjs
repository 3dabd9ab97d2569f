/** The curves beside the picture: angles, energies, work, and any variable over any other. */

import { convention, wrapped } from "./angles.mjs";
import { linkColor, partColor } from "./canvas.mjs";
import { Chart } from "./chart.mjs";
import { firstWrong } from "./runs.mjs";
import { clamp } from "./simulate.mjs";

const POINTS = { least: 1500, most: 6000, angle: 0.1 }; // between two, a link turns by this, rad

/** A whole number as an index. */
const subscript = (number) => String(number).replace(/\d/g, (digit) => "₀₁₂₃₄₅₆₇₈₉"[Number(digit)]);

/**
 * What can be drawn of each link, by its number; without one it names that of all links. `of` takes
 * it from a moment of a run.
 */
const OF_LINKS = [
  {
    name: (number) => `${convention().letter}${subscript(number)}`,
    unit: "rad",
    isAngle: true,
    of: ({ q }, i) => convention().angle(q[i]),
  },
  {
    name: (number) => `${convention().dotted}${subscript(number)}`,
    unit: "rad/s",
    of: ({ qd }, i) => convention().rate(qd[i]),
  },
  {
    name: (number) => `force at joint ${number}`.trim(),
    unit: "N",
    of: ({ forces }, i) => Math.hypot(...forces[i]),
  },
];

/** What can be drawn of the whole. */
const OF_ALL = [
  { name: "tip x", unit: "m", of: ({ places }) => places.at(-1)[0] },
  { name: "tip y, down", unit: "m", isDown: true, of: ({ places }) => places.at(-1)[1] },
  { name: "kinetic energy", unit: "J", of: ({ energies }) => energies[0] },
  { name: "potential energy", unit: "J", of: ({ energies }) => energies[1] },
  { name: "t", unit: "s", isTime: true, of: ({ t }) => t },
];

/** The quantities for a menu: of all links together, then of each link, then of the whole. */
function choices(n) {
  const links = Array.from({ length: n }, (_x, i) => ({ number: i + 1, link: i }));
  const ofLinks = [{ number: "", isTogether: true }, ...links].flatMap(({ number, ...more }) =>
    OF_LINKS.map((one) => ({ ...one, ...more, name: one.name(number) })),
  );
  return [...ofLinks, ...OF_ALL].map((one) => ({ ...one, label: `${one.name} (${one.unit})` }));
}

export class Curves {
  /** What the menus offer. */
  offered = [];

  constructor(byId) {
    this.angles = new Chart(byId("angles"), ["t (s)", "q (deg)"]);
    this.chosen = new Chart(byId("phase"), ["", ""]);
    this.energy = new Chart(byId("energy"), ["t (s)", "energy above hanging at rest (J)"]);
    this.work = new Chart(byId("work"), ["t (s)", "work, loss (J)"]);
    this.menus = [byId("across"), byId("up")];
  }

  set(run) {
    this.run = run;
    this.#sample();
    const { times, moments } = this;
    const energies = moments.map((one) => one.energies);
    const curve = (name, color, rows, of) => ({ name, color, x: times, y: rows.map(of) });
    this.energy.set([
      curve("kinetic", partColor(0), energies, ([T]) => T),
      curve("potential", partColor(1), energies, ([, V]) => V - run.hanging),
      curve("total", "ink", energies, ([T, V]) => T + V - run.hanging),
    ]);
    const booked = run.accounts.map((account, k) => {
      const name = account.replace(/^-(.*)/, "$1 (lost)");
      return curve(name, partColor(k), moments, (one) => one.booked[k]);
    });
    this.work.figure.hidden = booked.length === 0;
    this.work.set(booked);
  }

  /** Draws the angles of this run, and dashed those of another beside it, if there is one. */
  compare(other, name) {
    this.together = other ? [this.run, other] : [this.run];
    const told = convention();
    const curves = (moments, isDashed, suffix) =>
      Array.from({ length: this.run.n }, (_x, i) => ({
        name: `${told.letter}${subscript(i + 1)}${suffix}`,
        color: linkColor(i),
        x: this.times,
        y: moments.map(({ q }) => (told.angle(q[i]) * 180) / Math.PI),
        isDashed,
      }));
    const own = curves(this.moments, false, other ? ", this run" : "");
    const beside = other ? curves(other.moments(this.times), true, `, ${name}`) : [];
    this.angles.names[1] = `${told.letter} (deg)`;
    this.angles.set([...own, ...beside]);
    this.#fillMenus();
    this.choose();
  }

  /** Takes some times in each of the run's own steps, the more the faster it is. */
  #sample() {
    const { run } = this;
    const steps = [...run.steps];
    const rates = run.moments(steps).flatMap(({ qd }) => [...qd]);
    /** The largest rate of a link, rad/s. */
    this.fastest = rates.reduce((largest, rate) => Math.max(largest, Math.abs(rate) || 0), 0);
    const span = Math.abs(run.end - run.begin);
    const count = clamp((this.fastest * span) / POINTS.angle, POINTS.least, POINTS.most);
    this.times = steps.slice(1).flatMap((end, k) => {
      const begin = steps[k];
      const parts = run.isLive ? Math.ceil((count * Math.abs(end - begin)) / span) : 1;
      return Array.from({ length: parts }, (_x, i) => begin + ((end - begin) * i) / parts);
    });
    this.times.push(run.end);
    this.moments = run.moments(this.times);
  }

  /** The menus keep what was chosen in them, unless a link of it is gone. */
  #fillMenus() {
    /** @type {[any[], any[]]} */
    const [before, offered] = [this.offered, choices(this.run.n)];
    if (offered.length === before.length && offered[0].label === before[0].label) return;
    this.offered = offered;
    for (const [k, menu] of this.menus.entries()) {
      const { of, link } = before[menu.selectedIndex] ?? {};
      const found = offered.findIndex((one) => one.of === of && one.link === link);
      menu.replaceChildren(...offered.map(({ label }) => new Option(label)));
      menu.selectedIndex = found < 0 ? k : found;
    }
  }

  /** Draws what the menus say: a curve for each link where a quantity of all links is chosen. */
  choose() {
    const { run, moments } = this;
    const [x, y] = this.menus.map((menu) => this.offered[menu.selectedIndex]);
    this.isOverTime = x.isTime === true;
    const isWrapped = (one) => one.isAngle && !this.isOverTime;
    this.chosen.names = [x, y].map(({ label, ...one }) =>
      isWrapped(one) ? label.replace(" (", ", within a turn (") : label,
    );
    this.chosen.isDown = y.isDown === true;
    const value = (one, moment, i) => {
      const found = one.of(moment, one.link ?? i);
      return isWrapped(one) ? wrapped(found) : found;
    };
    const isTogether = x.isTogether || y.isTogether;
    this.pairs = Array.from({ length: isTogether ? run.n : 1 }, (_x, i) => ({
      name: isTogether ? `link ${i + 1}` : "",
      color: linkColor(isTogether ? i : (x.link ?? y.link ?? 0)),
      at: (moment) => [x, y].map((one) => value(one, moment, i)),
    }));
    // What is wrong is no portrait of the motion: the curves end where the run is right no more.
    const last = moments.findLastIndex(({ t }) => this.isOverTime || run.isRight(t)) + 1;
    this.chosen.set(
      this.pairs.map(({ name, color, at }) => {
        const points = moments.slice(0, last).map((moment) => [...at(moment), moment.t]);
        return { name, color, ...torn(points, [x, y].map(isWrapped)) };
      }),
    );
  }

  /** Marks the present, and shades what lies past the time until which what it shows is right. */
  draw(moment) {
    const { run } = this;
    const { t } = moment;
    const marked = (runs) => {
      const first = firstWrong(runs);
      return { now: t, shade: first ? [first.until, first.end] : null };
    };
    const overTime = marked([run]);
    this.angles.draw(marked(this.together));
    for (const chart of [this.energy, this.work]) chart.draw(overTime);
    const points = this.pairs.map(({ color, at }) => {
      const [x, y] = at(moment);
      return { x, y, color };
    });
    this.chosen.draw(this.isOverTime ? overTime : { points: run.isRight(t) ? points : [] });
  }
}

/** Points as x, y and their times, with a gap where an angle within a turn jumps. */
function torn(points, areWrapped) {
  const isJump = (k) =>
    areWrapped.some((is, axis) => is && Math.abs(points[k][axis] - points[k - 1][axis]) > Math.PI);
  const shown = points.flatMap((point, k) =>
    k > 0 && isJump(k) ? [[NaN, NaN, NaN], point] : [point],
  );
  const [x, y, t] = [0, 1, 2].map((axis) => shown.map((point) => point[axis]));
  return { x, y, t };
}

/** What accuracy costs: the runs of each method, error against time. */
export function drawCost(chart, points) {
  const methods = [...new Set(points.map((one) => one.method))];
  chart.figure.hidden = false;
  chart.set(
    methods.map((name, k) => {
      const own = points.filter((one) => one.method === name && one.error > 0);
      const [x, y] = [own.map((one) => one.ms), own.map((one) => one.error)];
      return { name, color: k === 0 ? "ink" : linkColor(k - 1), hasDots: true, x, y };
    }),
  );
  chart.draw();
}
