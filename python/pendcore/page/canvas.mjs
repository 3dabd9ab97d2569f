/** What drawings on a canvas share: the style's colours, sharp pixels, lines and discs. */

/** A colour of the page's style. */
export function color(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** A canvas whose units are CSS pixels, sharp on every screen. */
export function fitted(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const { clientWidth: width, clientHeight: height } = canvas;
  const [across, down] = [width, height].map((size) => Math.round(size * ratio));
  if (canvas.width !== across || canvas.height !== down)
    Object.assign(canvas, { width: across, height: down });
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  return { pen, width, height };
}

/** A line through places [x, y], with a gap wherever one is not a number. */
export function drawLine(pen, ...places) {
  pen.beginPath();
  let isOpen = false;
  for (const [x, y] of places) {
    const isNumber = Number.isFinite(x) && Number.isFinite(y);
    if (isNumber && isOpen) pen.lineTo(x, y);
    else if (isNumber) pen.moveTo(x, y);
    isOpen = isNumber;
  }
  pen.stroke();
}

/** A text that can be read in front of anything. */
export function drawText(pen, text, x, y, fill) {
  pen.strokeStyle = color("panel");
  pen.lineWidth = 4;
  pen.strokeText(text, x, y);
  pen.fillStyle = fill;
  pen.fillText(text, x, y);
}

/** The name of the colour of link i, counted from 0. */
export const linkColor = (i) => `link-${(i % 6) + 1}`;

/** The name of the colour of part i of a sum, such as an energy. */
export const partColor = (i) => `part-${(i % 6) + 1}`;

export const FONT = "13px system-ui";

export function drawDisc(pen, place, radius) {
  pen.beginPath();
  pen.arc(place[0], place[1], radius, 0, 2 * Math.PI);
  pen.fill();
}
