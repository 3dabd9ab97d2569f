/** A case through the core, as the page and its worker run it. */

/** Runs a case; who asks frees the run and its scene. */
export function simulateCase(core, given) {
  const { t_start, t_end, ...options } = given.run;
  const { link: links, gravity, effect: effects } = given;
  const scene = core.scene({ links, gravity, effects });
  try {
    const { q: q0, qd: qd0 } = given.start;
    return scene.simulate({ q0, qd0, t0: t_start ?? 0, t_end, ...options });
  } catch (error) {
    scene.free();
    throw error;
  }
}

/** The same without the times that the case keeps: a state at any time, unless others say more. */
export function simulateDense(core, given, others = {}) {
  const { t_eval: _times, ...run } = given.run;
  return simulateCase(core, { ...given, run: { ...run, store: "dense", ...others } });
}

/** The number of an interval that is nearest to this one. */
export function clamp(value, low, high) {
  return Math.min(Math.max(value, low), high);
}

/** Numbers at equal steps from one end to the other. */
export function grid(begin, end, count) {
  return Array.from({ length: count }, (_x, k) => begin + ((end - begin) * k) / (count - 1));
}
