/** The picture of the chain: links, trace, arrows, ghost and neighbours, on a canvas; y points down. */

import { color, drawDisc, drawLine, drawText, FONT, fitted, linkColor } from "./canvas.mjs";
import { clamp } from "./simulate.mjs";

const MARGIN = 0.12; // of the total length
const ARROW = { longest: 0.4, shortest: 0.14 }; // of the total length
const MOST_NUMBERED = 8; // places of joints
const ZOOMS = [0.1, 50];
const NEIGHBOUR = { size: 3, alpha: 0.45 }; // pixels; where many tips are, they are darker

export class SceneView {
  constructor(canvas) {
    this.canvas = canvas;
    this.typicalForce = 0; // N
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
    pen.lineCap = pen.lineJoin = "round";
    this.#axes(width, height, total);
    if (shown.neighbours) this.#neighbours(shown);
    const colorOf = (i) => color(shown.isLost ? "lost" : linkColor(i));
    if (shown.path) this.#trace(shown.path, colorOf(shown.lengths.length - 1));
    if (shown.ghost) this.#chain(shown.ghost, () => color("quiet"), 0.6);
    this.#chain(shown.places, colorOf, 1);
    if (shown.forces) this.#arrows(shown.places, shown.forces, total);
  }

  #at(x, y) {
    return [this.center[0] + x * this.pixels, this.center[1] + y * this.pixels];
  }

  /** Points [x, y], m, as places on the canvas. */
  #places(points) {
    return points.map(([x, y]) => this.#at(x, y));
  }

  #axes(width, height, total) {
    const { pen } = this;
    pen.strokeStyle = color("line");
    pen.lineWidth = 1;
    const [x, y] = this.#at(0, 0);
    drawLine(pen, [0, y], [width, y]);
    drawLine(pen, [x, 0], [x, height]);
    pen.fillStyle = color("quiet");
    pen.font = FONT;
    pen.fillText("x", width - 14, y - 6);
    pen.fillText("y", x + 6, height - 8);
    const nice = 10 ** Math.floor(Math.log10(total / this.zoom));
    const bar = nice * this.pixels;
    pen.fillRect(12, height - 16, bar, 2);
    pen.fillText(`${nice} m`, 12, height - 22);
  }

  #trace(points, stroke) {
    const { pen } = this;
    pen.globalAlpha = 0.7;
    pen.strokeStyle = stroke;
    pen.lineWidth = 1.6;
    drawLine(pen, ...this.#places(points));
    pen.globalAlpha = 1;
  }

  #chain(points, colorOf, alpha) {
    const { pen } = this;
    const places = this.#places(points);
    pen.globalAlpha = alpha;
    pen.lineWidth = 6;
    for (let i = 0; i + 1 < places.length; ++i) {
      pen.strokeStyle = colorOf(i);
      drawLine(pen, places[i], places[i + 1]);
    }
    pen.fillStyle = color("ink");
    for (const place of places) drawDisc(pen, place, 4.5);
    pen.globalAlpha = 1;
  }

  /** Arrows as long as forces are large, but neither so short nor so long that they vanish. */
  #arrows(points, forces, total) {
    const { pen, pixels } = this;
    const fill = color("force");
    const places = this.#places(points);
    pen.textAlign = "center";
    for (const [k, [fx, fy]] of forces.entries()) {
      const size = Math.hypot(fx, fy);
      if (!(size > 1e-6 * this.typicalForce)) continue;
      const share = (ARROW.longest * size) / this.typicalForce;
      const length = clamp(share, ARROW.shortest, ARROW.longest) * total * pixels;
      const [u, v] = [fx / size, fy / size];
      const [x, y] = places[k];
      pen.strokeStyle = pen.fillStyle = fill;
      pen.lineWidth = 2.5;
      const [ex, ey] = [x + length * u, y + length * v];
      drawLine(pen, [x, y], [ex, ey]);
      pen.beginPath();
      pen.moveTo(ex + 8 * u, ey + 8 * v);
      pen.lineTo(ex - 5 * v, ey + 5 * u);
      pen.lineTo(ex + 5 * v, ey - 5 * u);
      pen.fill();
      if (places.length > MOST_NUMBERED) continue; // they would cover each other
      // Most forces are along a link: the text is beside the head, on the side away from the link.
      const [nx, ny] = places[k - 1] ?? places[k + 1];
      const side = (ny - y) * u > (nx - x) * v ? -1 : 1;
      const [tx, ty] = [ex - 36 * side * v, ey + 20 * side * u];
      drawText(pen, `${size.toPrecision(3)} N`, tx, ty + 4, fill);
    }
    pen.textAlign = "left";
  }

  /** The tips of the neighbours, as a cloud that is the darker the more of them are in a place. */
  #neighbours({ neighbours, lengths, t, places }) {
    const { pen } = this;
    const { angles, count, n, rate, begin } = neighbours;
    const steps = angles.length / (count * n);
    const frame = clamp(Math.round(Math.abs(t - begin) * rate), 0, steps - 1);
    const { size, alpha } = NEIGHBOUR;
    pen.fillStyle = color("teal");
    pen.globalAlpha = alpha;
    for (let k = 0; k < count; ++k) {
      let [x, y] = places[0]; // of the pivot
      for (let i = 0; i < n; ++i) {
        const angle = angles[(frame * count + k) * n + i];
        x += lengths[i] * Math.cos(angle);
        y += lengths[i] * Math.sin(angle);
      }
      const [left, top] = this.#at(x, y);
      pen.fillRect(left - size / 2, top - size / 2, size, size);
    }
    pen.globalAlpha = 1;
  }
}
