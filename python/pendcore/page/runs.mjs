/** Runs of a case: by the core, or played back from what Python has computed. */

import { simulateDense } from "./simulate.mjs";

/** Unpacks the module that is in the page; null if there is none. */
export async function coreBytes() {
  const text = document.getElementById("core-wasm").textContent.trim();
  if (text === "") return null;
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

/** A run that the core has made, as the page plays it. */
export class LiveRun {
  constructor(core, given) {
    // The ledger changes no bit of the motion.
    const made = simulateDense(core, given, { ledger: true });
    this.scene = made.scene;
    this.run = made.run;
    this.n = given.link.length;
    this.begin = given.run.t_start ?? 0;
    this.end = this.run.t_reached;
    this.message = this.run.message;
    this.success = this.run.success;
    this.lengths = given.link.map((one) => one.length);
    this.accounts = this.run.accounts;
    this.count = Infinity; // it has a state at any time
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
    const [low, high] = this.begin < this.end ? [this.begin, this.end] : [this.end, this.begin];
    return Math.min(Math.max(t, low), high);
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
export class Recording {
  constructor(recorded, given) {
    this.recorded = recorded;
    this.n = given.link.length;
    this.begin = recorded.t[0];
    this.end = recorded.t[recorded.t.length - 1];
    this.message = recorded.message;
    this.success = recorded.success;
    this.lengths = given.link.map((one) => one.length);
    this.accounts = [];
    this.count = recorded.t.length;
  }
  free() {}
  #nearest(t) {
    const { t: times } = this.recorded;
    const last = times.length - 1;
    const share = (t - this.begin) / (this.end - this.begin || 1);
    return Math.min(Math.max(Math.round(share * last), 0), last);
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
