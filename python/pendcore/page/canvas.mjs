/** What drawings on a canvas share: the style's colours, sharp pixels, lines and discs. */

/** A colour of the page's style. */
export function color(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** A canvas whose units are CSS pixels, sharp on every screen. */
export function fitted(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const { clientWidth: width, clientHeight: height } = canvas;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  return { pen, width, height };
}

/** A line through places [x, y]. */
export function drawLine(pen, ...places) {
  pen.beginPath();
  for (const [x, y] of places) pen.lineTo(x, y); // the first lineTo of a path moves there
  pen.stroke();
}

export function drawDisc(pen, place, radius) {
  pen.beginPath();
  pen.arc(place[0], place[1], radius, 0, 2 * Math.PI);
  pen.fill();
}
