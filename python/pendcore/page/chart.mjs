/** A small chart: curves in axes with units, a shade, a line that moves along, and their names. */

import { color, drawDisc, drawLine, FONT, fitted } from "./canvas.mjs";

const LEFT = 56;
const RIGHT = 12;
const TOP = 8;
const BOTTOM = 40;
const MOST_TICKS = 10;
const DASH = [5, 4];

/** Round numbers that cover an interval: some five of them. */
function ticks(low, high) {
  const span = high - low || 1;
  const step = 10 ** Math.floor(Math.log10(span / 4));
  const wide = [1, 2, 5, 10].map((k) => k * step).find((one) => span / one <= 6) ?? step;
  const first = Math.ceil(low / wide);
  const count = Math.min(Math.floor(high / wide + 1e-9) - first + 1, MOST_TICKS);
  return Array.from({ length: Math.max(count, 0) }, (_x, k) => (first + k) * wide);
}

function label(value) {
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e5 || size < 1e-3)) return value.toExponential(0);
  return String(Number(value.toPrecision(6)));
}

/** What is nearly constant gets an interval of this half width, in which its rounding is not seen. */
function least(value) {
  return 1e-9 * Math.max(Math.abs(value), 1);
}

export class Chart {
  /** `names` are [horizontal, vertical], with units; log tells whether both are logarithmic. */
  constructor(figure, names, { log = false } = {}) {
    this.figure = figure;
    this.legend = figure.appendChild(document.createElement("figcaption"));
    this.canvas = figure.appendChild(document.createElement("canvas"));
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", figure.getAttribute("aria-label"));
    this.names = names;
    this.scaled = log ? Math.log10 : (value) => value;
    this.back = log ? (value) => 10 ** value : (value) => value;
    this.ticks = log ? (...ends) => ticks(...ends).filter(Number.isInteger) : ticks;
    this.isDown = false; // y points up, as it does not in the plane of the pendulum
    this.curves = [];
    this.box = [0, 1, 0, 1];
    /** All that does not move with time, drawn once, and what it was drawn for. */
    this.still = document.createElement("canvas");
    this.drawnFor = "";
    this.version = 0;
    /** The size of the plane between the axes, CSS pixels. */
    this.width = 0;
    this.height = 0;
  }

  /** Curves are { name, color, x, y, hasDots, isDashed }; what is not a number is a gap. */
  set(curves) {
    this.curves = curves;
    this.version += 1;
    const [left, right] = this.#extent("x");
    const [low, high] = this.#extent("y");
    const beside = right - left < least(right) ? least(right) : 0;
    const margin = Math.max(0.06 * (high - low), least(high));
    this.box = [left - beside, right + beside, low - margin, high + margin];
    const named = curves.filter(({ name }) => name);
    this.legend.replaceChildren(this.names[1], ...named.map(nameOf));
  }

  /** The least and the largest number of all curves along an axis, on its scale. */
  #extent(axis) {
    let [low, high] = [Infinity, -Infinity];
    for (const curve of this.curves) {
      for (const value of curve[axis]) {
        const place = this.scaled(value);
        if (!Number.isFinite(place)) continue;
        low = Math.min(low, place);
        high = Math.max(high, place);
      }
    }
    return low > high ? [0, 1] : [low, high];
  }

  /** Where a point stands on the canvas, CSS pixels. */
  #at(x, y) {
    const [left, right, low, high] = this.box;
    const across = (this.scaled(x) - left) / (right - left);
    const up = (this.scaled(y) - low) / (high - low);
    return [LEFT + across * this.width, TOP + (this.isDown ? up : 1 - up) * this.height];
  }

  /** `shade` is an interval that is shaded, `now` where the line is; `points` are marked. */
  draw({ shade = null, now = null, points = [] } = {}) {
    const { pen, width, height } = fitted(this.canvas);
    if (width === 0) return; // in a tab that is closed
    this.width = width - LEFT - RIGHT;
    this.height = height - TOP - BOTTOM;
    const { canvas, still, version } = this;
    const needed = String([canvas.width, canvas.height, shade, color("ink"), version]);
    if (needed !== this.drawnFor) {
      [still.width, still.height] = [canvas.width, canvas.height];
      const quiet = still.getContext("2d");
      quiet.setTransform(pen.getTransform());
      this.#drawStill(quiet, shade);
      this.drawnFor = needed;
    }
    pen.drawImage(still, 0, 0, width, height);
    if (now !== null) {
      const [x] = this.#at(now, 1);
      pen.strokeStyle = color("ink");
      drawLine(pen, [x, TOP], [x, TOP + this.height]);
    }
    for (const { x, y, color: fill } of points) {
      pen.fillStyle = color(fill);
      drawDisc(pen, this.#at(x, y), 4);
    }
  }

  #drawStill(pen, shade) {
    if (shade) {
      pen.fillStyle = color("line");
      const [begin, end] = shade.map((x) => this.#at(x, 1)[0]);
      pen.fillRect(begin, TOP, end - begin, this.height);
    }
    this.#axes(pen);
    pen.lineWidth = 1.5;
    for (const { x, y, color: stroke, hasDots, isDashed } of this.curves) {
      pen.strokeStyle = pen.fillStyle = color(stroke);
      pen.setLineDash(isDashed ? DASH : []);
      const places = Array.from(x, (one, k) => this.#at(one, y[k]));
      drawLine(pen, ...places);
      if (hasDots) for (const [px, py] of places) pen.fillRect(px - 2, py - 2, 4, 4);
    }
  }

  #axes(pen) {
    const [left, right, low, high] = this.box;
    pen.font = FONT;
    pen.strokeStyle = color("line");
    pen.fillStyle = color("quiet");
    pen.textAlign = "center";
    for (const tick of this.ticks(left, right)) {
      const [x] = this.#at(this.back(tick), 1);
      pen.strokeRect(x, TOP, 0, this.height);
      pen.fillText(label(this.back(tick)), x, TOP + this.height + 16);
    }
    pen.textAlign = "right";
    for (const tick of this.ticks(low, high)) {
      const [, y] = this.#at(1, this.back(tick));
      pen.strokeRect(LEFT, y, this.width, 0);
      pen.fillText(label(this.back(tick)), LEFT - 5, y + 4);
    }
    pen.fillText(this.names[0], LEFT + this.width, TOP + this.height + BOTTOM - 6);
  }
}

/** The name of a curve, beside a piece of it. */
function nameOf({ name, color, isDashed }) {
  const made = document.createElement("span");
  made.textContent = name;
  made.className = isDashed ? "dashed" : "";
  made.style.setProperty("--color", `var(--${color})`);
  return made;
}
