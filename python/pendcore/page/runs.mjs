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

/** What the page plays: a run from `begin` to `end`, which may be before it. */
class Played {
  /** Until when it is right, s; null as long as that is not known. */
  until = null;

  constructor(given, { t, accounts, message, success }) {
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
  /** Angles and rates at a time, from the states that each kind of run has at many. */
  state(t) {
    const [row] = /** @type {any} */ (this).states([t]);
    return row.subarray(0, 2 * this.n);
  }
}

/** The sizes of the forces at the joints of a run, N. */
export function forceSizes(run, t, state) {
  const found = run.reactions(t, state);
  return run.lengths.map((_length, i) => Math.hypot(found[2 * i], found[2 * i + 1]));
}

/** A run that the core has made: it has a state at any time. */
export class LiveRun extends Played {
  isLive = true;

  constructor(core, given) {
    // The ledger changes no bit of the motion.
    const { scene, run } = simulateDense(core, given, { ledger: true });
    super(given, run);
    this.scene = scene;
    this.run = run;
    const down = new Float64Array(2 * this.n).fill(Math.PI / 2, 0, this.n);
    /** The energy of the chain hanging at rest at the start, J. */
    this.hanging = this.energies(this.begin, down)[1];
  }
  free() {
    this.run.free();
    this.scene.free();
  }
  within(t) {
    return clamp(t, Math.min(this.begin, this.end), Math.max(this.begin, this.end));
  }
  /** Angles, rates and the entries of the ledger at times, a row each. */
  states(times) {
    const rows = this.run.at(times.map((t) => this.within(t)));
    const size = this.run.dimension;
    return times.map((_t, k) => rows.subarray(k * size, (k + 1) * size));
  }
  places(t, state) {
    return this.scene.positions(t, state.subarray(0, this.n));
  }
  reactions(t, state) {
    return this.scene.reactions(t, ...this.#halves(state));
  }
  energies(t, state) {
    return this.scene.energies(t, ...this.#halves(state));
  }
  #halves(state) {
    return [state.subarray(0, this.n), state.subarray(this.n, 2 * this.n)];
  }
}

/** What Python has computed, at some times: for a page without the core, and for own functions. */
export class Recording extends Played {
  isLive = false;

  constructor(recorded, given) {
    super(given, recorded);
    this.recorded = recorded;
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
  states(times) {
    return times.map((t) => Float64Array.from(this.recorded.states[this.#nearest(t)]));
  }
  places(t) {
    return Float64Array.from(this.recorded.places[this.#nearest(t)]);
  }
  reactions(t) {
    return this.recorded.reactions[this.#nearest(t)];
  }
  energies(t) {
    return this.recorded.energies[this.#nearest(t)];
  }
}
