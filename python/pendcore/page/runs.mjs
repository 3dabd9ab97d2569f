/** Runs of a case: by the core, or played back from what Python has computed. */

import { clamp, simulateDense } from "./simulate.mjs";

/** Unpacks the module that is in the page; null if there is none. */
export async function coreBytes() {
  const text = document.getElementById("core-wasm").textContent.trim();
  if (text === "") return null;
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

/** Numbers x, y, x, y, ... as places or forces [x, y]. */
function pairs(numbers) {
  const both = (_x, k) => [numbers[2 * k], numbers[2 * k + 1]];
  return Array.from({ length: numbers.length / 2 }, both);
}

/** What a run of the core is at a time: made in thousands, so that most is computed when asked for. */
class Moment {
  constructor(scene, t, row) {
    this.scene = scene;
    this.t = t;
    this.q = row.subarray(0, scene.n); // rad
    this.qd = row.subarray(scene.n, 2 * scene.n); // rad/s
    this.row = row;
  }
  /** What the ledger has booked, J. */
  get booked() {
    return this.row.subarray(2 * this.scene.n);
  }
  /** The pivot, the joints and the tip, m. */
  get places() {
    return pairs(this.scene.positions(this.t, this.q));
  }
  /** The force on each link at its joint, N. */
  get forces() {
    return pairs(this.scene.reactions(this.t, this.q, this.qd));
  }
  /** Kinetic and potential energy, J. */
  get energies() {
    return this.scene.energies(this.t, this.q, this.qd);
  }
}

/** What the page plays: a run from `begin` to `end`, which may be before it. */
class Played {
  /** Until when it is right, s; null as long as that is not known. */
  until = null;

  constructor(given, { t, accounts, message, success }) {
    /** The case that was run: that of the page goes on changing. */
    this.given = structuredClone(given);
    this.steps = t;
    this.begin = t[0];
    this.end = t.at(-1);
    this.accounts = accounts;
    this.message = message;
    this.success = success;
    this.lengths = given.link.map((one) => one.length);
    this.n = this.lengths.length;
    this.direction = this.end >= this.begin ? 1 : -1;
  }
  isRight(t) {
    const rounding = 1e-9 * Math.abs(this.end - this.begin);
    return this.until === null || this.direction * (t - this.until) <= rounding;
  }
  /** What the run is at a time, or at the one of its own that is nearest. */
  at(t) {
    return /** @type {any} */ (this).moments([t])[0];
  }
}

/** Which of some runs is wrong first, if one is. */
export function firstWrong(runs) {
  const wrong = runs.filter((one) => !one.isRight(one.end));
  return wrong.reduce((a, b) => (a?.isRight(b.until) === false ? a : b), undefined);
}

/** Until when all of some runs are right to `limit` rad, in words, and the colour of their dot. */
export function trust(runs, t, limit) {
  const both = runs.length > 1 ? "both " : "";
  const first = firstWrong(runs);
  if (!first) return [`${both}right to ${limit} rad to the end`, "green"];
  const until = `${first.until.toPrecision(4)} s`;
  if (first.isRight(t)) return [`${both}right to ${limit} rad until ${until}`, "ochre"];
  return [`not ${both}right any more, since ${until}`, "red"];
}

/** A run that the core has made: it has a state at any time. */
export class LiveRun extends Played {
  isLive = true;

  constructor(core, given) {
    // The ledger changes no bit of the motion.
    const run = simulateDense(core, given, { ledger: true });
    super(given, run);
    this.run = run;
    const down = new Float64Array(2 * this.n).fill(Math.PI / 2, 0, this.n);
    /** The energy of the chain hanging at rest at the start, J. */
    this.hanging = new Moment(run.scene, this.begin, down).energies[1];
  }
  free() {
    this.run.free();
    this.run.scene.free();
  }
  within(t) {
    return clamp(t, Math.min(this.begin, this.end), Math.max(this.begin, this.end));
  }
  moments(times) {
    const inside = times.map((t) => this.within(t));
    const rows = this.run.at(inside);
    const size = this.run.dimension;
    const row = (k) => rows.subarray(k * size, (k + 1) * size);
    return inside.map((t, k) => new Moment(this.run.scene, t, row(k)));
  }
}

/** What Python has computed, at some times: for a page without the core, and for own functions. */
export class Recording extends Played {
  isLive = false;

  constructor(recorded, given) {
    super(given, { ...recorded, t: recorded.moments.t });
    this.columns = Object.entries(recorded.moments);
    this.hanging = recorded.hanging;
  }
  free() {}
  #nearest(t) {
    const last = this.steps.length - 1;
    const share = (t - this.begin) / (this.end - this.begin || 1);
    return clamp(Math.round(share * last), 0, last);
  }
  within(t) {
    return this.steps[this.#nearest(t)];
  }
  moments(times) {
    return times.map((t) => {
      const k = this.#nearest(t);
      return Object.fromEntries(this.columns.map(([name, column]) => [name, column[k]]));
    });
  }
}
