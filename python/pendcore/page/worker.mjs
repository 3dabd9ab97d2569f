/**
 * What takes longer than a frame: the second run that says until when a run is right, a thousand
 * neighbours, and what accuracy costs. This text goes into a worker, after that of the core.
 */

import { load } from "../../../cpp/wasm/pendcore.mjs";

/** @type {any} */
const scope = self;
let core = null;
let ready = Promise.resolve();

/** The largest difference of an angle, rad, at times of two runs. */
function apart(one, other, times, n) {
  const [a, b] = [one.at(times), other.at(times)];
  return times.map((_t, k) => {
    let largest = 0;
    for (let i = 0; i < n; ++i) {
      largest = Math.max(largest, Math.abs(a[k * one.dimension + i] - b[k * other.dimension + i]));
    }
    return largest;
  });
}

function made(given, others) {
  const scene = core.scene({ links: given.link, gravity: given.gravity, effects: given.effect });
  const { t_start, t_end, t_eval: _times, store: _store, ...options } = given.run;
  return scene.simulate({
    q0: given.start.q,
    qd0: given.start.qd,
    t0: t_start ?? 0,
    t_end,
    ...options,
    store: "dense",
    ...others,
  });
}

function grid(begin, end, count) {
  return Array.from({ length: count }, (_x, k) => begin + ((end - begin) * k) / (count - 1));
}

/** Until when a run is right to `limit` rad, by a run of another method at a hundredth of rtol. */
function horizon(given, limit) {
  const first = made(given);
  const method = first.method === "dop853" ? "taylor" : "dop853";
  const rtol = Math.max((given.run.rtol ?? 1e-6) / 100, 3e-14);
  const moved = given.start.q.map((angle) => angle * (1 + 2 ** -51));
  const { step: _step, first_step: _first, ...run } = given.run;
  const second = made(
    { ...given, run, start: { ...given.start, q: moved } },
    { method: first.method === "radau5" ? "radau5" : method, rtol, atol: rtol / 1000 },
  );
  const begin = given.run.t_start ?? 0;
  const end = Math.min(first.t_reached, second.t_reached);
  const times = grid(begin, end, 4000);
  const errors = apart(first, second, times, given.link.length);
  const past = errors.findIndex((error) => !(error <= limit));
  return past < 0 ? end : times[Math.max(past - 1, 0)];
}

/** The angles of many runs that start beside this one, at equal steps of time. */
function neighbours(given, count, spread, rate) {
  const n = given.link.length;
  const begin = given.run.t_start ?? 0;
  const times = grid(
    begin,
    given.run.t_end,
    Math.round(Math.abs(given.run.t_end - begin) * rate) + 1,
  );
  const angles = new Float32Array(count * times.length * n);
  for (let k = 0; k < count; ++k) {
    const q = [...given.start.q];
    q[n - 1] += spread * (k + 1);
    const run = made({ ...given, start: { ...given.start, q } });
    const [low, high] = [Math.min(begin, run.t_reached), Math.max(begin, run.t_reached)];
    const rows = run.at(times.map((t) => Math.min(Math.max(t, low), high)));
    for (let j = 0; j < times.length; ++j) {
      for (let i = 0; i < n; ++i) {
        angles[(j * count + k) * n + i] = rows[j * run.dimension + i];
      }
    }
  }
  return { angles, count, n, rate, begin };
}

/** The least time of a run, ms, and its largest position error as a share of the total length. */
function measured(given, method, tolerance, times, truth) {
  const total = given.link.reduce((sum, one) => sum + one.length, 0);
  const others = { method, rtol: tolerance, atol: tolerance, step: null, first_step: null };
  let run = made(given, others);
  if (!run.success) return null;
  // A browser's clock has steps of a tenth of a millisecond, so that many runs are timed at once.
  let least = Infinity;
  for (let batch = 0; batch < 3; ++batch) {
    const begin = performance.now();
    let runs = 0;
    for (; performance.now() < begin + 20; ++runs) run = made(given, others);
    least = Math.min(least, (performance.now() - begin) / runs);
  }
  const n = given.link.length;
  const rows = run.at(times);
  let error = 0;
  for (let k = 0; k < times.length; ++k) {
    let [x, y] = [0, 0];
    for (let i = 0; i < n; ++i) {
      const [here, there] = [rows[k * run.dimension + i], truth.rows[k * truth.dimension + i]];
      x += given.link[i].length * (Math.cos(here) - Math.cos(there));
      y += given.link[i].length * (Math.sin(here) - Math.sin(there));
      error = Math.max(error, Math.hypot(x, y) / total);
    }
  }
  return { method, tolerance, ms: least, error };
}

function cost(given, methods) {
  const begin = given.run.t_start ?? 0;
  const stiff = made(given).method === "radau5";
  const best = made(given, {
    method: stiff ? "radau5" : "dop853",
    rtol: 3e-14,
    atol: 1e-16,
    step: null,
  });
  const times = grid(begin, best.t_reached, 101);
  const truth = { rows: best.at(times), dimension: best.dimension };
  const found = [];
  for (const method of methods) {
    for (let digits = 3; digits <= 12; ++digits) {
      try {
        const one = measured(given, method, 10 ** -digits, times, truth);
        if (one !== null) found.push(one);
      } catch {
        break; // the method does not take this scene
      }
      scope.postMessage({ partial: found });
    }
  }
  return found;
}

const tasks = {
  horizon: ({ given, limit }) => horizon(given, limit),
  neighbours: ({ given, count, spread, rate }) => neighbours(given, count, spread, rate),
  cost: ({ given, methods }) => cost(given, methods),
};

scope.onmessage = async ({ data }) => {
  try {
    if (data.bytes !== undefined) {
      ready = load(data.bytes).then((loaded) => {
        core = loaded;
      });
      return;
    }
    await ready;
    const answer = tasks[data.task](data);
    const moved = answer?.angles ? [answer.angles.buffer] : [];
    scope.postMessage({ id: data.id, answer }, moved);
  } catch (error) {
    scope.postMessage({ id: data.id, failure: String(error.message ?? error) });
  }
};
