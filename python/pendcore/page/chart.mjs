/** A small chart: curves in axes with units, their names, a line that moves along, what it reads. */

import { color, drawDisc, drawLine, FONT, fitted } from "./canvas.mjs";
import { clamp } from "./simulate.mjs";

const LEFT = 56;
const RIGHT = 12;
const TOP = 8;
const BOTTOM = 40;
const DASH = [5, 4];
const NEAR = 40; // CSS pixels from the pointer, within which a curve over no time is read

/** Round numbers that cover an interval: some five of them. */
function ticks(low, high) {
  const span = high - low || 1;
  const step = 10 ** Math.floor(Math.log10(span / 4));
  const wide = [1, 2, 5, 10].map((k) => k * step).find((one) => span / one <= 6);
  const first = Math.ceil(low / wide);
  const count = Math.floor(high / wide + 1e-9) - first + 1;
  return Array.from({ length: count }, (_x, k) => (first + k) * wide);
}

function label(value) {
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e5 || size < 1e-3)) return value.toExponential(0);
  return String(Number(value.toPrecision(6)));
}

/** The value of a curve at a time, on the straight line between two of its points. */
function valueAt({ x, y }, t) {
  const isBackward = x.at(-1) < x[0];
  const found = x.findIndex((one) => (isBackward ? one <= t : one >= t));
  const k = found < 0 ? x.length - 1 : Math.max(found, 1);
  const part = (t - x[k - 1]) / (x[k] - x[k - 1]) || 0;
  return y[k - 1] + part * (y[k] - y[k - 1]);
}

/** A disc on a curve, or a ring on a dashed one. */
function drawMark(pen, place, { color: fill, isDashed }) {
  pen.fillStyle = color(fill);
  drawDisc(pen, place, 4);
  if (!isDashed) return;
  pen.fillStyle = color("panel");
  drawDisc(pen, place, 2);
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
    Object.assign(this.canvas, { role: "img", ariaLabel: figure.ariaLabel });
    this.names = names;
    this.scaled = log ? Math.log10 : (value) => value;
    this.back = log ? (value) => 10 ** value : (value) => value;
    this.ticks = log ? (...ends) => ticks(...ends).filter(Number.isInteger) : ticks;
    this.isDown = false; // y points up, as it does not in the plane of the pendulum
    this.pointer = null; // where it is, CSS pixels
    const point = ({ type, offsetX, offsetY }) => {
      this.pointer = /down|move/.test(type) ? [offsetX, offsetY] : null;
      this.draw(this.shown);
    };
    for (const what of ["down", "move", "leave", "cancel"])
      this.canvas.addEventListener(`pointer${what}`, point);
    /** All that does not move with time, drawn once. */
    this.still = document.createElement("canvas");
  }

  /** Curves are { name, color, x, y, hasDots, isDashed }; what is not a number is a gap. */
  set(curves) {
    this.curves = curves;
    this.drawnFor = "";
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
  draw(shown = {}) {
    const { shade = null, now = null, points = [] } = shown;
    this.shown = shown;
    const { pen, width, height } = fitted(this.canvas);
    if (width === 0) return; // in a tab that is closed
    /** The size of the plane between the axes, CSS pixels. */
    this.width = width - LEFT - RIGHT;
    this.height = height - TOP - BOTTOM;
    const { canvas, still } = this;
    const needed = String([canvas.width, canvas.height, shade, color("ink")]);
    if (needed !== this.drawnFor) {
      [still.width, still.height] = [canvas.width, canvas.height];
      const quiet = still.getContext("2d");
      quiet.setTransform(pen.getTransform());
      this.#drawStill(quiet, shade);
      this.drawnFor = needed;
    }
    pen.drawImage(still, 0, 0, width, height);
    this.reading = now === null ? this.#nearest() : this.#across(now);
    const times = now === null ? [] : [this.reading[0]?.t, now];
    for (const [k, time] of times.entries()) {
      const [x] = this.#at(time, 1);
      pen.strokeStyle = color(k === 0 ? "quiet" : "ink");
      drawLine(pen, [x, TOP], [x, TOP + this.height]);
    }
    for (const one of [...points, ...this.reading]) drawMark(pen, this.#at(one.x, one.y), one);
    this.#tell(pen);
  }

  /** The points of all curves at the time under the pointer, or else at the present. */
  #across(now) {
    const [left, right] = this.box;
    const share = this.pointer && clamp((this.pointer[0] - LEFT) / this.width, 0, 1);
    const t = share === null ? now : left + share * (right - left);
    return this.curves.map((curve) => {
      const y = valueAt(curve, t);
      return { ...curve, x: t, y, t, told: [y] };
    });
  }

  /** The point of a curve that is nearest to the pointer, if one is near. */
  #nearest() {
    let [least, found] = [NEAR, []];
    for (const curve of this.pointer ? this.curves : []) {
      for (const [k, x] of curve.x.entries()) {
        const y = curve.y[k];
        const [px, py] = this.#at(x, y);
        const distance = Math.hypot(px - this.pointer[0], py - this.pointer[1]);
        if (!(distance < least)) continue; // also in a gap
        [least, found] = [distance, [{ ...curve, x, y, t: curve.t?.[k], told: [x, y] }]];
      }
    }
    return found;
  }

  /** Writes what is read below the axes: the time, then values, each behind its curve's mark. */
  #tell(pen) {
    const { reading } = this;
    const digits = (value) => value.toPrecision(4).replaceAll("-", "−");
    const texts = reading.map(({ told }) => told.map(digits).join(", "));
    const time = reading[0]?.t;
    texts.unshift(time === undefined ? "" : `${time.toFixed(2)} s`);
    pen.font = FONT;
    pen.textAlign = "left";
    const end = LEFT + this.width - pen.measureText(this.names[0]).width;
    let [x, y] = [0, TOP + this.height + BOTTOM - 6];
    for (const [k, text] of texts.entries()) {
      const width = pen.measureText(text).width + 22;
      if (x + width > end) return;
      if (k > 0) drawMark(pen, [x + 4, y - 4], reading[k - 1]);
      pen.fillStyle = color("ink");
      pen.fillText(text, x + 12, y);
      x += width;
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
