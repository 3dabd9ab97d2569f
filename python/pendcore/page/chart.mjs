/** A small chart on a canvas: curves in axes with units, a shade, and a line that moves along. */

import { color, drawDisc, drawLine, fitted } from "./canvas.mjs";

const LEFT = 52;
const RIGHT = 10;
const LINE = 14; // the height of a row of names
const BOTTOM = 36;
const MOST_TICKS = 10;
const MOST_ROWS = 3; // of names; the others are left out

/** Round numbers that cover an interval: some five of them. */
export function ticks(low, high) {
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

export class Chart {
  /** `names` are [horizontal, vertical], with units; log tells which axes are logarithmic. */
  constructor(canvas, names, { log = false } = {}) {
    this.canvas = canvas;
    this.names = names;
    this.log = log;
    this.isDown = false; // y points up, as it does not in the plane of the pendulum
    this.curves = [];
    this.box = [0, 1, 0, 1];
  }

  #scaled(value) {
    return this.log ? Math.log10(value) : value;
  }

  /** Curves are { name, color, x, y, dots }. */
  set(curves) {
    this.curves = curves;
    let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
    for (const { x, y } of curves) {
      for (let k = 0; k < x.length; ++k) {
        const [px, py] = [this.#scaled(x[k]), this.#scaled(y[k])];
        if (!Number.isFinite(px) || !Number.isFinite(py)) continue;
        left = Math.min(left, px);
        right = Math.max(right, px);
        low = Math.min(low, py);
        high = Math.max(high, py);
      }
    }
    if (left > right) [left, right, low, high] = [0, 1, 0, 1];
    // What is nearly constant gets an interval in which its rounding does not show.
    const least = (value) => 1e-9 * Math.max(Math.abs(value), 1);
    const beside = right - left < least(right) ? least(right) : 0;
    const margin = Math.max(0.06 * (high - low), least(high));
    this.box = [left - beside, right + beside, low - margin, high + margin];
  }

  /** `past` is where the shade begins, `now` where the line is; `points` are marked. */
  draw({ past = null, now = null, points = [] } = {}) {
    const { pen, width, height } = fitted(this.canvas);
    const [left, right, low, high] = this.box;
    pen.font = "11px system-ui, sans-serif";
    const legend = this.#legend(pen, width);
    const top = 8 + LINE * Math.min(legend.length, MOST_ROWS);
    const at = (x, y) => {
      const share = (this.#scaled(y) - low) / (high - low);
      return [
        LEFT + ((this.#scaled(x) - left) / (right - left)) * (width - LEFT - RIGHT),
        top + (this.isDown ? share : 1 - share) * (height - top - BOTTOM),
      ];
    };
    if (past !== null && past < right) {
      pen.fillStyle = color("line");
      const [x] = at(past, 0);
      pen.fillRect(x, top, width - RIGHT - x, height - top - BOTTOM);
    }
    this.#axes(pen, width, height, top, at);
    for (const { x, y, color: stroke, dots } of this.curves) {
      pen.strokeStyle = pen.fillStyle = color(stroke);
      pen.lineWidth = 1.3;
      const places = Array.from(x, (one, k) => at(one, y[k]));
      drawLine(pen, ...places);
      if (dots) for (const [px, py] of places) pen.fillRect(px - 2, py - 2, 4, 4);
    }
    if (now !== null) {
      const [x] = at(now, 1);
      pen.strokeStyle = color("ink");
      drawLine(pen, [x, top], [x, height - BOTTOM]);
    }
    for (const { x, y, color: fill } of points) {
      pen.fillStyle = color(fill);
      drawDisc(pen, at(x, y), 4);
    }
    this.#drawLegend(pen, width, legend);
  }

  #axes(pen, width, height, top, at) {
    const [left, right, low, high] = this.box;
    const back = (value) => (this.log ? 10 ** value : value);
    const round = (from, to) =>
      this.log ? ticks(from, to).filter((one) => Number.isInteger(one)) : ticks(from, to);
    pen.strokeStyle = color("line");
    pen.fillStyle = color("faint");
    pen.lineWidth = 1;
    for (const tick of round(left, right)) {
      const [x] = at(back(tick), back(low));
      pen.strokeRect(x, top, 0, height - top - BOTTOM);
      pen.textAlign = "center";
      pen.fillText(label(back(tick)), x, height - BOTTOM + 14);
    }
    for (const tick of round(low, high)) {
      const [, y] = at(back(left), back(tick));
      pen.strokeRect(LEFT, y, width - LEFT - RIGHT, 0);
      pen.textAlign = "right";
      pen.fillText(label(back(tick)), LEFT - 5, y + 4);
    }
    pen.textAlign = "left";
    pen.fillText(this.names[1], 4, 13);
    pen.textAlign = "right";
    pen.fillText(this.names[0], width - RIGHT, height - 5);
  }

  /** The names of the curves, in as many rows as they need beside the name of the axis. */
  #legend(pen, width) {
    const free = width - LEFT - RIGHT - pen.measureText(this.names[1]).width;
    const rows = [[]];
    let left = free;
    for (const { name, color: fill } of this.curves) {
      if (!name) continue;
      const needs = pen.measureText(name).width + 10;
      if (needs > left && rows.at(-1).length > 0) {
        rows.push([]);
        left = free;
      }
      left -= needs;
      rows.at(-1).push({ name, fill, needs });
    }
    return rows;
  }

  #drawLegend(pen, width, rows) {
    pen.textAlign = "right";
    for (const [k, row] of rows.slice(0, MOST_ROWS).entries()) {
      let x = width - RIGHT;
      for (const { name, fill, needs } of row.reverse()) {
        pen.fillStyle = color(fill);
        pen.fillText(name, x, 13 + k * LINE);
        x -= needs;
      }
    }
    pen.textAlign = "left";
  }
}
