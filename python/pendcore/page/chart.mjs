/** A small chart on a canvas: curves in axes with units, a shade, and a line that moves along. */

import { color, drawDisc, drawLine, FONT, fitted } from "./canvas.mjs";

const LEFT = 56;
const RIGHT = 12;
const LINE = 17; // the height of a row of names
const BOTTOM = 40;
const SWATCH = 18; // the line before a name, with the gap after it
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
    /** All that does not move with time, drawn once, and what it was drawn for. */
    this.still = document.createElement("canvas");
    this.drawnFor = "";
    this.version = 0;
    /** Where a point stands on the canvas, and where its axes begin from above, CSS pixels. */
    this.at = (x, y) => [x, y];
    this.top = 0;
  }

  #scaled(value) {
    return this.log ? Math.log10(value) : value;
  }

  /** Curves are { name, color, x, y, dots, dash }; what is not a number is a gap. */
  set(curves) {
    this.curves = curves;
    this.version += 1;
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
    if (width === 0) return; // in a tab that is closed
    const { still } = this;
    const needed = [this.canvas.width, this.canvas.height, past, color("ink"), this.version].join();
    if (needed !== this.drawnFor) {
      [still.width, still.height] = [this.canvas.width, this.canvas.height];
      const quiet = still.getContext("2d");
      quiet.setTransform(pen.getTransform());
      this.#drawStill(quiet, width, height, past);
      this.drawnFor = needed;
    }
    pen.drawImage(still, 0, 0, width, height);
    if (now !== null) {
      const [x] = this.at(now, 1);
      pen.strokeStyle = color("ink");
      drawLine(pen, [x, this.top], [x, height - BOTTOM]);
    }
    for (const { x, y, color: fill } of points) {
      pen.fillStyle = color(fill);
      drawDisc(pen, this.at(x, y), 4);
    }
  }

  #drawStill(pen, width, height, past) {
    const [left, right, low, high] = this.box;
    pen.font = FONT;
    const legend = this.#legend(pen, width);
    const top = 8 + LINE * Math.min(legend.length, MOST_ROWS);
    const at = (x, y) => {
      const share = (this.#scaled(y) - low) / (high - low);
      return [
        LEFT + ((this.#scaled(x) - left) / (right - left)) * (width - LEFT - RIGHT),
        top + (this.isDown ? share : 1 - share) * (height - top - BOTTOM),
      ];
    };
    [this.at, this.top] = [at, top];
    if (past !== null && past < right) {
      pen.fillStyle = color("line");
      const [x] = at(past, 0);
      pen.fillRect(x, top, width - RIGHT - x, height - top - BOTTOM);
    }
    this.#axes(pen, width, height, top, at);
    for (const { x, y, color: stroke, dots, dash } of this.curves) {
      pen.strokeStyle = pen.fillStyle = color(stroke);
      pen.lineWidth = 1.5;
      pen.setLineDash(dash ?? []);
      const places = Array.from(x, (one, k) => at(one, y[k]));
      drawLine(pen, ...places);
      pen.setLineDash([]);
      if (dots) for (const [px, py] of places) pen.fillRect(px - 2, py - 2, 4, 4);
    }
    this.#drawLegend(pen, width, legend);
  }

  #axes(pen, width, height, top, at) {
    const [left, right, low, high] = this.box;
    const back = (value) => (this.log ? 10 ** value : value);
    const round = (from, to) =>
      this.log ? ticks(from, to).filter((one) => Number.isInteger(one)) : ticks(from, to);
    pen.strokeStyle = color("line");
    pen.fillStyle = color("quiet");
    pen.lineWidth = 1;
    for (const tick of round(left, right)) {
      const [x] = at(back(tick), back(low));
      pen.strokeRect(x, top, 0, height - top - BOTTOM);
      pen.textAlign = "center";
      pen.fillText(label(back(tick)), x, height - BOTTOM + 16);
    }
    for (const tick of round(low, high)) {
      const [, y] = at(back(left), back(tick));
      pen.strokeRect(LEFT, y, width - LEFT - RIGHT, 0);
      pen.textAlign = "right";
      pen.fillText(label(back(tick)), LEFT - 5, y + 4);
    }
    pen.textAlign = "left";
    pen.fillText(this.names[1], 4, 15);
    pen.textAlign = "right";
    pen.fillText(this.names[0], width - RIGHT, height - 6);
  }

  /** The names of the curves, in as many rows as they need beside the name of the axis. */
  #legend(pen, width) {
    const free = width - LEFT - RIGHT - pen.measureText(this.names[1]).width;
    const rows = [[]];
    let left = free;
    for (const { name, color: fill, dash } of this.curves) {
      if (!name) continue;
      const needs = pen.measureText(name).width + SWATCH + 10;
      if (needs > left && rows.at(-1).length > 0) {
        rows.push([]);
        left = free;
      }
      left -= needs;
      rows.at(-1).push({ name, fill, needs, dash });
    }
    return rows;
  }

  #drawLegend(pen, width, rows) {
    pen.textAlign = "left";
    pen.lineWidth = 2.5;
    for (const [k, row] of rows.slice(0, MOST_ROWS).entries()) {
      let x = width - RIGHT;
      const y = 15 + k * LINE;
      for (const { name, fill, needs, dash } of row.reverse()) {
        x -= needs;
        pen.strokeStyle = color(fill);
        pen.setLineDash(dash ?? []);
        drawLine(pen, [x + 10, y - 4], [x + 4 + SWATCH, y - 4]);
        pen.fillStyle = color("ink");
        pen.fillText(name, x + 10 + SWATCH, y);
      }
    }
    pen.setLineDash([]);
  }
}
