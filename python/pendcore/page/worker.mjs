/**
 * What takes longer than a frame: the second run that says until when a run is right, a thousand
 * neighbours, and what accuracy costs. This text goes into a worker, after that of the core.
 */

import { load } from "../../../cpp/wasm/pendcore.mjs";
import { grid, simulateDense } from "./simulate.mjs";

/** @type {any} */
const scope = self;
let loading = null;
let core = null;

/** Runs a case, gives the run to `use`, and frees it: a loop leaves no time to clean up after it. */
function withRun(given, others, use) {
  const run = simulateDense(core, given, others);
  try {
    return use(run);
  } finally {
    run.free();
    run.scene.free();
  }
}

const OTHER_METHODS = { radau5: "radau5", dop853: "taylor" };

/** Until when a run is right to `limit` rad, by a run of another method at a hundredth of rtol. */
function horizon({ given, limit }) {
  const begin = given.run.t_start ?? 0;
  const { step: _step, first_step: _first, ...run } = given.run;
  const moved = given.start.q.map((angle) => angle * (1 + 2 ** -51));
  const other = { ...given, run, start: { ...given.start, q: moved } };
  const rtol = [given.run.rtol ?? 1e-6].flat().map((one) => Math.max(one / 100, 3e-14));
  const second = (method) => ({ method, rtol, atol: rtol.map((one) => one / 1000) });
  return withRun(given, {}, (one) => {
    const compare = (another) => {
      const ends = [one.t_reached, another.t_reached];
      const [end] = ends.sort((a, b) => Math.abs(a - begin) - Math.abs(b - begin));
      const times = grid(begin, end, 4000);
      const [a, b] = [one.at(times), another.at(times)];
      const isWrong = (k) => (_link, i) =>
        !(Math.abs(a[k * one.dimension + i] - b[k * another.dimension + i]) <= limit);
      const past = times.findIndex((_t, k) => given.link.some(isWrong(k)));
      return past < 0 ? end : times[Math.max(past - 1, 0)];
    };
    try {
      return withRun(other, second(OTHER_METHODS[one.method] ?? "dop853"), compare);
    } catch {
      return withRun(other, second("dopri5"), compare); // without series
    }
  });
}

/** The angles of many runs that start beside this one, at equal steps of time. */
function neighbours({ given, count, spread, rate }) {
  const n = given.link.length;
  const begin = given.run.t_start ?? 0;
  const steps = Math.round(Math.abs(given.run.t_end - begin) * rate) + 1;
  const times = grid(begin, given.run.t_end, steps);
  const angles = new Float32Array(count * steps * n);
  for (let k = 0; k < count; ++k) {
    const q = [...given.start.q];
    q[n - 1] += spread * (k + 1);
    const start = { ...given.start, q };
    withRun({ ...given, start }, { store: "times", t_eval: times }, (run) => {
      const rows = run.states;
      const kept = rows.length / run.dimension;
      for (let j = 0; j < steps; ++j) {
        const row = Math.min(j, kept - 1) * run.dimension; // a run that ended stays where it is
        angles.set(rows.subarray(row, row + n), (j * count + k) * n);
      }
    });
  }
  return { angles, count, n, rate, begin };
}

/** The least time of a run, ms, and its largest position error as a share of the total length. */
function measured(given, method, tolerance, truth) {
  const total = given.link.reduce((sum, one) => sum + one.length, 0);
  const others = { method, rtol: tolerance, atol: tolerance, step: null, first_step: null };
  const once = (use) => withRun(given, others, use);
  const rows = once((run) => (run.success ? run.at(truth.times) : null));
  if (rows === null) return null;
  // A browser's clock has steps of a tenth of a millisecond, so that many runs are timed at once.
  let least = Infinity;
  for (let batch = 0; batch < 3; ++batch) {
    const begin = performance.now();
    let runs = 0;
    for (; performance.now() < begin + 20; ++runs) once(() => null);
    least = Math.min(least, (performance.now() - begin) / runs);
  }
  const n = given.link.length;
  let error = 0;
  for (let k = 0; k < truth.times.length; ++k) {
    let [x, y] = [0, 0];
    for (let i = 0; i < n; ++i) {
      const [here, there] = [rows, truth.rows].map((one) => one[k * truth.size + i]);
      x += given.link[i].length * (Math.cos(here) - Math.cos(there));
      y += given.link[i].length * (Math.sin(here) - Math.sin(there));
      error = Math.max(error, Math.hypot(x, y) / total);
    }
  }
  return { method, tolerance, ms: least, error };
}

function cost({ given, methods }, tell) {
  const begin = given.run.t_start ?? 0;
  const isStiff = withRun(given, {}, (run) => run.method === "radau5");
  const tightest = { method: isStiff ? "radau5" : "dop853", rtol: 3e-14, atol: 1e-16, step: null };
  const truth = withRun(given, tightest, (run) => {
    const times = grid(begin, run.t_reached, 101);
    return { times, rows: run.at(times), size: run.dimension };
  });
  const found = [];
  for (const method of methods) {
    for (let digits = 3; digits <= 12; ++digits) {
      try {
        const one = measured(given, method, 10 ** -digits, truth);
        if (one !== null) found.push(one);
      } catch {
        break; // the method does not take this scene
      }
      tell(found);
    }
  }
  return found;
}

const tasks = { horizon, neighbours, cost };

scope.onmessage = async ({ data }) => {
  try {
    if (data.bytes !== undefined) {
      loading = load(data.bytes);
      return;
    }
    core = await loading;
    const answer = tasks[data.task](data, (partial) => scope.postMessage({ partial }));
    const moved = answer?.angles ? [answer.angles.buffer] : [];
    scope.postMessage({ answer }, moved);
  } catch (error) {
    scope.postMessage({ failure: String(error.message ?? error) });
  }
};
