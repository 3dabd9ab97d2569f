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
  constructor(given, begin, end, { message, success }) {
    this.begin = begin;
    this.end = end;
    this.message = message;
    this.success = success;
    this.lengths = given.link.map((one) => one.length);
    this.n = this.lengths.length;
    this.direction = end >= begin ? 1 : -1;
  }
}

/** A run that the core has made, as the page plays it. */
export class LiveRun extends Played {
  constructor(core, given) {
    // The ledger changes no bit of the motion.
    const { scene, run } = simulateDense(core, given, { ledger: true });
    super(given, given.run.t_start ?? 0, run.t_reached, run);
    this.scene = scene;
    this.run = run;
    this.accounts = run.accounts;
    this.count = Infinity; // it has a state at any time
    this.steps = run.t;
  }
  free() {
    this.run.free();
    this.scene.free();
  }
  /** Angles and rates at a time. */
  state(t) {
    return this.run.at([this.within(t)]).subarray(0, 2 * this.n);
  }
  within(t) {
    return clamp(t, Math.min(this.begin, this.end), Math.max(this.begin, this.end));
  }
  /** The states at times, a row each. */
  states(times) {
    const rows = this.run.at(times.map((t) => this.within(t)));
    const size = this.run.dimension;
    return times.map((_t, k) => rows.subarray(k * size, k * size + 2 * this.n));
  }
  /** The entries of the ledger at times, J: a row for each of `accounts`. */
  ledger(times) {
    const rows = this.run.at(times.map((t) => this.within(t)));
    const size = this.run.dimension;
    return this.accounts.map((_name, i) => times.map((_t, k) => rows[k * size + 2 * this.n + i]));
  }
  places(t, state) {
    return this.scene.positions(t, state.subarray(0, this.n));
  }
  reactions(t, state) {
    return this.scene.reactions(t, state.subarray(0, this.n), state.subarray(this.n));
  }
  energies(t, state) {
    return this.scene.energies(t, state.subarray(0, this.n), state.subarray(this.n));
  }
}

/** What Python has computed, at some times: for a page without the core, and for own functions. */
export class Recording extends Played {
  constructor(recorded, given) {
    super(given, recorded.t[0], recorded.t.at(-1), recorded);
    this.recorded = recorded;
    this.accounts = [];
    this.count = recorded.t.length;
    this.steps = recorded.t;
  }
  free() {}
  #nearest(t) {
    const last = this.count - 1;
    const share = (t - this.begin) / (this.end - this.begin || 1);
    return clamp(Math.round(share * last), 0, last);
  }
  within(t) {
    return this.recorded.t[this.#nearest(t)];
  }
  state(t) {
    return Float64Array.from(this.recorded.states[this.#nearest(t)]);
  }
  states(times) {
    return times.map((t) => this.state(t));
  }
  places(t) {
    return Float64Array.from(this.recorded.places[this.#nearest(t)]);
  }
  reactions(t) {
    return Float64Array.from(this.recorded.reactions[this.#nearest(t)]);
  }
  ledger() {
    return [];
  }
  energies(t) {
    return this.recorded.energies[this.#nearest(t)];
  }
}
