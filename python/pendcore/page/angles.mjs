/** How the page tells angles and rates: as the core has them, or from the vertical. */

const FROM_X = { letter: "q", dotted: "q̇", angle: (q) => q, rate: (qd) => qd };

/** From hanging, counter-clockwise. The same functions lead back. */
const FROM_VERTICAL = {
  letter: "θ",
  dotted: "θ̇",
  angle: (q) => Math.PI / 2 - q,
  rate: (qd) => 0 - qd, // no -0 of a rod at rest
};

/** What the box under the picture says. */
export function convention() {
  return document.querySelector("#vertical:checked") ? FROM_VERTICAL : FROM_X;
}

/** The same angle from -pi to pi, rad. */
export function wrapped(angle) {
  return angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));
}
