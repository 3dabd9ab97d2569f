/**
 * The core of pendcore in JavaScript: the same scenes, options and bits as in Python.
 *
 *     const core = await load(bytes);  // of pendcore.wasm
 *     const scene = core.scene({
 *       links: [core.uniformRod(1, 1), core.uniformRod(1, 1)],
 *       effects: [{ kind: "viscous_joint", joint: 2, damping: 0.02 }],
 *     });
 *     const run = scene.simulate({ q0: [0.7, 1.0], t_end: 60, rtol: 1e-9 });
 *     run.t; run.states; run.at([1.5, 2.5]); run.message;
 *
 * Links have mass (kg), length (m), center (m) and inertia (kg m^2); effects, their parameters and
 * the options of a run have the names and units of Python's documentation. Bad values throw a
 * PendcoreError with the core's message. Functions of one's own and events are not offered here.
 */

import { fastest, imports, PendcoreError } from "./engine.mjs";

export { PendcoreError };

const BYTES_PER_NUMBER = 8;

/** Compiles the module for this engine. */
export async function load(bytes) {
  const host = {};
  const module = await WebAssembly.compile(await fastest(new Uint8Array(bytes)));
  const instance = await WebAssembly.instantiate(module, imports(host));
  /** @type {any} */
  const exports = instance.exports;
  host.memory = exports.memory;
  exports._initialize();
  return new Core(exports);
}

class Core {
  /** Runs and scenes that nobody uses any more are freed. */
  #freed = new FinalizationRegistry(([free, address]) => this.call(free, address));

  constructor(exports) {
    this.exports = exports;
  }

  /** A uniform rod, as a link. */
  uniformRod(mass, length) {
    return { mass, length, center: length / 2, inertia: (mass * length * length) / 12 };
  }

  /** A scene that the core has checked. */
  scene({ links, gravity = 9.807, effects = [] }) {
    this.call("begin_scene", gravity);
    for (const { mass, length, center, inertia } of links) {
      this.call("add_link", mass, length, center, inertia);
    }
    for (const { kind, ...parameters } of effects) {
      this.putText(kind);
      this.call("add_effect");
      this.#set("set_parameter", parameters);
    }
    return new Scene(this, this.call("end_scene"), links.length);
  }

  /** Sets parameters or options by name; a part's have its name and a dot before them. */
  #set(how, values, part = "") {
    for (const [name, value] of Object.entries(values)) {
      if (value === undefined || value === null) continue;
      if (isPart(value)) {
        this.#set(how, value, `${part}${name}.`);
        continue;
      }
      const isWord = typeof value === "string";
      this.putText(part + name + (isWord ? `\0${value}` : ""));
      if (!isWord) this.putNumbers(isList(value) ? value : [value]);
      this.call(how);
    }
  }

  setOptions(options) {
    this.call("begin_options");
    this.#set("set_option", options);
  }

  /**
   * Calls a function of the core. One that throws leaves its frames on the core's stack, which is
   * put back; what it had allocated is lost.
   */
  call(name, ...values) {
    const stack = this.exports.__stack_pointer;
    const before = stack.value;
    try {
      return this.exports[name](...values);
    } catch (error) {
      stack.value = before;
      if (error instanceof WebAssembly.RuntimeError) {
        throw new PendcoreError(
          `${name}: the core has no more memory, or failed (${error.message})`,
        );
      }
      throw error;
    }
  }

  putText(text) {
    const bytes = new TextEncoder().encode(text);
    const at = this.call("text_buffer", bytes.length);
    new Uint8Array(this.exports.memory.buffer, at, bytes.length).set(bytes);
  }

  putNumbers(numbers) {
    const at = this.call("number_buffer", numbers.length);
    new Float64Array(this.exports.memory.buffer, at, numbers.length).set(numbers);
  }

  /** A copy of numbers of the core. */
  numbers(at, count) {
    return new Float64Array(this.exports.memory.buffer.slice(at, at + BYTES_PER_NUMBER * count));
  }

  text(at) {
    const bytes = new Uint8Array(this.exports.memory.buffer);
    return new TextDecoder().decode(bytes.subarray(at, bytes.indexOf(0, at)));
  }

  keep(object, free, address) {
    this.#freed.register(object, [free, address], object);
  }

  /** Frees what an object keeps at once: a loop leaves no time to find out what nobody uses. */
  free(object, free, address) {
    this.#freed.unregister(object);
    this.call(free, address);
  }
}

/** @type {(value: any) => boolean} */
function isList(value) {
  return Array.isArray(value) || ArrayBuffer.isView(value);
}

function isPart(value) {
  return typeof value === "object" && !isList(value);
}

class Scene {
  constructor(core, address, n) {
    this.core = core;
    this.address = address;
    this.n = n;
    core.keep(this, "free_scene", address);
  }

  /** Frees its memory; the scene must not be used after that. */
  free() {
    this.core.free(this, "free_scene", this.address);
  }

  /** A run from q0 (rad) and qd0 (rad/s) over t0 to t_end (s), with the options of a run. */
  simulate({ q0, qd0, t0 = 0, t_end, ...options }) {
    this.core.setOptions(options);
    this.#put(q0, qd0);
    return new Run(this, this.core.call("simulate", this.address, t0, t_end));
  }

  /** The accelerations of a state, rad/s^2. */
  accelerations(t, q, qd) {
    return this.#ofState("accelerations", this.n, t, q, qd);
  }
  /** The forces on each link from the one before, N: x and y of the first, of the second, ... */
  reactions(t, q, qd) {
    return this.#ofState("reactions", 2 * this.n, t, q, qd);
  }
  /** Kinetic and potential energy, J. */
  energies(t, q, qd) {
    return this.#ofState("energies", 2, t, q, qd);
  }
  /** The pivot, the joints and the tip, m: x and y of each; y points down. */
  positions(t, q) {
    return this.#ofState("positions", 2 * this.n + 2, t, q, undefined);
  }

  #ofState(what, count, t, q, qd) {
    this.#put(q, qd);
    return this.core.numbers(this.core.call(what, this.address, t), count);
  }

  /** @type {(q: any, qd?: any) => void} */
  #put(q, qd = new Float64Array(this.n)) {
    if (!isList(q) || !isList(qd)) {
      throw new PendcoreError(`q and qd: must be lists of ${this.n} numbers each`);
    }
    if (q.length !== this.n || qd.length !== this.n) {
      throw new PendcoreError(
        `a state of ${this.n} links: must have ${this.n} angles and rates, not ${q.length} and ${qd.length}`,
      );
    }
    this.core.putNumbers([...q, ...qd]);
  }
}

/** What is known of a run. Each access to its numbers copies them out of the core's memory. */
class Run {
  constructor(scene, address) {
    this.scene = scene;
    this.address = address;
    const { core } = scene;
    core.keep(this, "free_run", address);
    const [status, method, ...message] = core.text(core.call("words", address)).split("\n");
    this.status = status;
    this.method = method;
    this.message = message.join("\n");
    this.success = Boolean(core.call("success", address));
    this.dimension = core.call("dimension", address);
    this.t_reached = core.call("reached", address);
    const accounts = core.text(core.call("accounts", address));
    /** The ledger's entries in a state, after angles and rates: those of losses begin with "-". */
    this.accounts = accounts === "" ? [] : accounts.split("\n");
  }

  /** Frees its memory; the run must not be used after that. */
  free() {
    this.scene.core.free(this, "free_run", this.address);
  }

  /** The times that were kept, s. */
  get t() {
    return this.#numbers("times", this.#count());
  }
  /** The states at these times, row by row: angles, rates, and the ledger's entries. */
  get states() {
    return this.#numbers("states", this.#count() * this.dimension);
  }
  get statistics() {
    const [nfev, njev, nlu, accepted, rejected] = this.#numbers("statistics", 5);
    return { nfev, njev, nlu, accepted, rejected };
  }
  /** A hash of every bit of times, states and dense output, as in tests/cpp/trajectory_hash.txt. */
  get hash() {
    const bits = BigInt.asUintN(64, this.scene.core.call("hash", this.address));
    return bits.toString(16).padStart(16, "0");
  }

  /** States at times of the run, row by row, from the dense output. */
  at(times) {
    if (!isList(times)) times = [times];
    this.scene.core.putNumbers(times);
    return this.#numbers("at", times.length * this.dimension);
  }

  /** The same run continued to t_end, with the bits that it has if it never stops. */
  resume(t_end) {
    return new Run(this.scene, this.scene.core.call("resume", this.address, t_end));
  }

  #count() {
    return this.scene.core.call("count", this.address);
  }
  #numbers(what, count) {
    const { core } = this.scene;
    return core.numbers(core.call(what, this.address), count);
  }
}
