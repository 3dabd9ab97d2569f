/** The picture of the chain: links, trace, arrows, ghost and neighbours, on a canvas; y points down. */

import { color, drawDisc, drawLine, drawText, FONT, fitted, linkColor } from "./canvas.mjs";
import { clamp } from "./simulate.mjs";

const MARGIN = 0.12; // of the total length
const ARROW = { longest: 0.4, shortest: 0.14 }; // of the total length
const ZOOMS = [0.1, 50];
const CELL = 4; // pixels, of the picture of the neighbours' tips
const MANY = 40; // neighbours in a cell, above which it is no darker

export class SceneView {
  constructor(canvas) {
    this.canvas = canvas;
    this.typicalForce = 0;
    this.cloud = document.createElement("canvas");
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
    if (shown.neighbours) this.#neighbours(shown, width, height);
    const last = shown.lengths.length - 1;
    const lost = shown.isLost ? color("lost") : null;
    if (shown.path) this.#line(shown.path, lost ?? linkColor(last), 1.6, 0.7);
    if (shown.ghost) this.#chain(shown.ghost, () => color("quiet"), 0.6);
    this.#chain(shown.places, (i) => lost ?? linkColor(i), 1);
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
    pen.fillStyle = color("quiet");
    pen.font = FONT;
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

  #chain(points, colorOf, alpha) {
    const { pen } = this;
    const places = this.#places(points);
    pen.globalAlpha = alpha;
    pen.lineCap = "round";
    pen.lineWidth = 6;
    for (let i = 0; i + 1 < places.length; ++i) {
      pen.strokeStyle = colorOf(i);
      drawLine(pen, places[i], places[i + 1]);
    }
    pen.fillStyle = color("ink");
    for (const place of places) drawDisc(pen, place, 4.5);
    pen.lineCap = "butt";
    pen.globalAlpha = 1;
  }

  /** Arrows as long as forces are large, but neither so short nor so long that they vanish. */
  #arrows(points, forces, total) {
    const { pen, pixels } = this;
    const fill = color("force");
    const places = this.#places(points);
    pen.font = FONT;
    pen.textAlign = "center";
    for (let k = 0; k + 1 < places.length; ++k) {
      const [fx, fy] = [forces[2 * k], forces[2 * k + 1]];
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
      const [tx, ty] = clearPlace([ex, ey], [u, v], places);
      drawText(pen, `${size.toPrecision(3)} N`, tx, ty + 4, fill);
    }
    pen.textAlign = "left";
  }

  /** How many tips of neighbours are in each cell, as a cloud that is the darker the more. */
  #neighbours({ neighbours, lengths, t, pivot }, width, height) {
    const { angles, count, n, rate, begin } = neighbours;
    const steps = angles.length / (count * n);
    const frame = clamp(Math.round(Math.abs(t - begin) * rate), 0, steps - 1);
    const [columns, rows] = [Math.ceil(width / CELL), Math.ceil(height / CELL)];
    const found = new Uint16Array(columns * rows);
    for (let k = 0; k < count; ++k) {
      let [x, y] = pivot;
      for (let i = 0; i < n; ++i) {
        const angle = angles[(frame * count + k) * n + i];
        x += lengths[i] * Math.cos(angle);
        y += lengths[i] * Math.sin(angle);
      }
      const [i, j] = this.#at(x, y).map((one) => Math.floor(one / CELL));
      if (i >= 0 && i < columns && j >= 0 && j < rows) found[j * columns + i] += 1;
    }
    const { cloud } = this;
    [cloud.width, cloud.height] = [columns, rows];
    const pen = cloud.getContext("2d");
    const pixels = pen.createImageData(columns, rows);
    const [red, green, blue] = channels(color("teal"));
    for (let k = 0; k < found.length; ++k) {
      if (found[k] === 0) continue;
      const shade = Math.min(Math.log1p(found[k]) / Math.log1p(MANY), 1);
      pixels.data.set([red, green, blue, 255 * (0.4 + 0.6 * shade)], 4 * k);
    }
    pen.putImageData(pixels, 0, 0);
    this.pen.drawImage(cloud, 0, 0, columns * CELL, rows * CELL);
  }
}

/** Red, green and blue of "#rrggbb". */
function channels(hex) {
  return [1, 3, 5].map((at) => Number.parseInt(hex.slice(at, at + 2), 16));
}

/** The place of a text at the head of an arrow that is farthest from the links, if one is near. */
function clearPlace([x, y], [u, v], places) {
  /** @type {[number, number][]} */
  const spots = [
    [x + 26 * u, y + 22 * v],
    [x + 8 * u - 34 * v, y + 8 * v + 22 * u],
    [x + 8 * u + 34 * v, y + 8 * v - 22 * u],
  ];
  const rooms = spots.map((spot) => distance(spot, places));
  return spots[rooms[0] > 16 ? 0 : rooms.indexOf(Math.max(...rooms))];
}

/** How far a place is from the nearest link, pixels. */
function distance([x, y], places) {
  let least = Infinity;
  for (let i = 0; i + 1 < places.length; ++i) {
    const [[ax, ay], [bx, by]] = [places[i], places[i + 1]];
    const [dx, dy] = [bx - ax, by - ay];
    const share = clamp(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1), 0, 1);
    least = Math.min(least, Math.hypot(ax + share * dx - x, ay + share * dy - y));
  }
  return least;
}
