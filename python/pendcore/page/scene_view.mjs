/** The picture of the chain: links, trace, arrows, ghost and neighbours, on a canvas; y points down. */

import { color, drawDisc, drawLine, fitted } from "./canvas.mjs";
import { clamp } from "./simulate.mjs";

const MARGIN = 0.12; // of the total length
const ARROW = 0.45; // of the total length, for the largest force of the run
const ZOOMS = [0.1, 50];

export class SceneView {
  constructor(canvas) {
    this.canvas = canvas;
    this.largestForce = 0;
    this.pixels = 1;
    this.center = [0, 0];
    this.fit();
  }

  /** Shows the whole chain in the middle. */
  fit() {
    this.zoom = 1;
    this.shift = [0, 0];
  }

  /** Moves the picture by CSS pixels. */
  move(x, y) {
    this.shift = [this.shift[0] + x, this.shift[1] + y];
  }

  /** Enlarges the picture; a place on the canvas, in CSS pixels, stays where it is. */
  enlarge(factor, place = this.center) {
    const zoom = clamp(this.zoom * factor, ...ZOOMS);
    const further = zoom / this.zoom - 1;
    this.move(further * (this.center[0] - place[0]), further * (this.center[1] - place[1]));
    this.zoom = zoom;
  }

  /** Metres of a place on the canvas, in CSS pixels. */
  metres(x, y) {
    return [(x - this.center[0]) / this.pixels, (y - this.center[1]) / this.pixels];
  }

  draw(shown) {
    const { pen, width, height } = fitted(this.canvas);
    const total = shown.lengths.reduce((sum, length) => sum + length, 0);
    this.pixels = (this.zoom * Math.min(width, height)) / (2 * total * (1 + MARGIN));
    this.center = [width / 2 + this.shift[0], height / 2 + this.shift[1]];
    this.pen = pen;
    this.#axes(width, height, total);
    if (shown.neighbours) this.#neighbours(shown);
    if (shown.path) this.#line(shown.path, color(shown.isLost ? "lost" : "second"), 1.4, 0.75);
    if (shown.ghost) this.#chain(shown.ghost, color("first"), 0.55);
    this.#chain(shown.places, color(shown.isLost ? "lost" : "chain"), 1);
    if (shown.forces) this.#arrows(shown.places, shown.forces, total);
  }

  #at(x, y) {
    return [this.center[0] + x * this.pixels, this.center[1] + y * this.pixels];
  }

  /** Points x, y, x, y, ... as places on the canvas. */
  #places(points) {
    return Array.from({ length: points.length / 2 }, (_x, k) =>
      this.#at(points[2 * k], points[2 * k + 1]),
    );
  }

  #axes(width, height, total) {
    const { pen } = this;
    pen.strokeStyle = color("line");
    pen.lineWidth = 1;
    const [x, y] = this.#at(0, 0);
    drawLine(pen, [0, y], [width, y]);
    drawLine(pen, [x, 0], [x, height]);
    pen.fillStyle = color("faint");
    pen.font = "12px system-ui, sans-serif";
    pen.fillText("x", width - 14, y - 6);
    pen.fillText("y", x + 6, height - 8);
    const nice = 10 ** Math.floor(Math.log10(total / this.zoom));
    const bar = nice * this.pixels;
    pen.fillRect(12, height - 16, bar, 2);
    pen.fillText(`${nice} m`, 12, height - 22);
  }

  #line(points, stroke, lineWidth, alpha) {
    const { pen } = this;
    pen.globalAlpha = alpha;
    pen.strokeStyle = stroke;
    pen.lineWidth = lineWidth;
    pen.lineJoin = "round";
    drawLine(pen, ...this.#places(points));
    pen.globalAlpha = 1;
  }

  #chain(places, stroke, alpha) {
    this.#line(places, stroke, 5, alpha);
    const { pen } = this;
    pen.globalAlpha = alpha;
    pen.fillStyle = stroke;
    for (const [k, place] of this.#places(places).entries()) drawDisc(pen, place, k === 0 ? 4 : 6);
    pen.globalAlpha = 1;
  }

  #arrows(places, forces, total) {
    const { pen } = this;
    const scale = (ARROW * total) / (this.largestForce || 1);
    pen.strokeStyle = pen.fillStyle = color("first");
    pen.lineWidth = 2;
    pen.font = "12px system-ui, sans-serif";
    for (let k = 0; k < forces.length; k += 2) {
      const size = Math.hypot(forces[k], forces[k + 1]);
      if (!(size > 0)) continue;
      const [x, y] = this.#at(places[k], places[k + 1]);
      const [dx, dy] = [forces[k] * scale * this.pixels, forces[k + 1] * scale * this.pixels];
      const along = Math.hypot(dx, dy) || 1;
      const [u, v] = [dx / along, dy / along];
      drawLine(pen, [x, y], [x + dx, y + dy]);
      pen.beginPath();
      pen.moveTo(x + dx + 7 * u, y + dy + 7 * v);
      pen.lineTo(x + dx - 4 * v, y + dy + 4 * u);
      pen.lineTo(x + dx + 4 * v, y + dy - 4 * u);
      pen.fill();
      pen.fillText(`${size.toPrecision(3)} N`, x + dx + 10, y + dy);
    }
  }

  /** All neighbours are one path, so that a thousand take no longer than a frame. */
  #neighbours({ neighbours, lengths, t, pivot }) {
    const { angles, count, n, rate, begin } = neighbours;
    const steps = angles.length / (count * n);
    const frame = clamp(Math.round(Math.abs(t - begin) * rate), 0, steps - 1);
    const { pen, pixels } = this;
    const [x0, y0] = this.#at(pivot[0], pivot[1]);
    pen.globalAlpha = 0.12;
    pen.strokeStyle = color("third");
    pen.lineWidth = 1;
    pen.beginPath();
    for (let k = 0; k < count; ++k) {
      let [x, y] = [x0, y0];
      pen.moveTo(x, y);
      for (let i = 0; i < n; ++i) {
        const angle = angles[(frame * count + k) * n + i];
        x += lengths[i] * pixels * Math.cos(angle);
        y += lengths[i] * pixels * Math.sin(angle);
        pen.lineTo(x, y);
      }
    }
    pen.stroke();
    pen.globalAlpha = 1;
  }
}
