/** Keys and fingers on the picture: play, step, start elsewhere by dragging a joint, look closer. */

export const STEP = 1 / 60; // s
const CLOSER = 1.25; // by a key
const CLOSER_A_PIXEL = 0.002; // of a wheel, as a logarithm
const REACH = 30; // pixels from a joint within which it is taken

export function listenToKeys(canvas, page) {
  const actions = {
    " ": () => page.play(!page.isPlaying),
    ArrowLeft: () => page.go(page.t - STEP),
    ArrowRight: () => page.go(page.t + STEP),
    Home: () => page.go(page.run.begin),
    End: () => page.go(page.run.end),
    "+": () => page.view.enlarge(CLOSER),
    "=": () => page.view.enlarge(CLOSER), // the same key without Shift
    "-": () => page.view.enlarge(1 / CLOSER),
    0: () => page.view.fit(),
  };
  canvas.addEventListener("keydown", (event) => {
    if (!(event.key in actions) || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    actions[event.key]();
    page.draw();
  });
}

/** The wheel with Ctrl, or two fingers on a touchpad, look closer; a double click shows it all. */
export function listenToWheel(canvas, page) {
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey) return; // the page scrolls
    event.preventDefault();
    const factor = Math.exp(-CLOSER_A_PIXEL * event.deltaY);
    page.view.enlarge(factor, [event.offsetX, event.offsetY]);
    page.draw();
  });
  canvas.addEventListener("dblclick", () => {
    page.view.fit();
    page.draw();
  });
}

/** The number of the joint near a place, or of the tip; 0 where there is none. */
function jointNear(page, [x, y]) {
  const { places } = page.run.at(page.t);
  let [nearest, least] = [0, REACH / page.view.pixels];
  for (let i = 1; i <= page.run.n; ++i) {
    const away = Math.hypot(x - places[i][0], y - places[i][1]);
    if (away < least) [nearest, least] = [i, away];
  }
  return nearest;
}

/**
 * Dragging a joint or the tip starts the run from the new pose, at rest; a mouse elsewhere moves
 * the picture.
 */
export function listenToPointer(canvas, page) {
  const { view } = page;
  let held = null; // where the mouse was, while it moves the picture
  const place = ({ clientX, clientY }) => {
    const { left, top } = canvas.getBoundingClientRect();
    return view.metres(clientX - left, clientY - top);
  };
  const nearest = (event) => (page.core ? jointNear(page, place(event)) : 0);
  canvas.addEventListener("pointerdown", (event) => {
    const joint = nearest(event);
    if (!joint && event.pointerType !== "mouse") return;
    canvas.setPointerCapture(event.pointerId);
    if (!joint) {
      held = [event.clientX, event.clientY];
      return;
    }
    page.play(false);
    page.dragged = joint;
    const { start } = page.given;
    start.q = [...page.run.at(page.t).q];
    start.qd = start.qd.map(() => 0);
    page.t = page.run.begin;
    page.changed();
  });
  // A finger that is not on a joint scrolls the page.
  canvas.addEventListener("touchstart", (event) => {
    if (nearest(event.touches[0])) event.preventDefault();
  });
  canvas.addEventListener("pointermove", (event) => {
    if (held) {
      view.move(event.clientX - held[0], event.clientY - held[1]);
      held = [event.clientX, event.clientY];
      page.draw();
    }
    if (!page.dragged) return;
    const { run, dragged, given } = page;
    const [x, y] = place(event);
    const [jointX, jointY] = run.at(run.begin).places[dragged - 1];
    const before = given.start.q[dragged - 1];
    const angle = Math.atan2(y - jointY, x - jointX);
    const turns = Math.round((before - angle) / (2 * Math.PI));
    given.start.q[dragged - 1] = angle + 2 * Math.PI * turns;
    page.t = run.begin;
    page.changed();
  });
  const end = () => {
    held = null;
    if (!page.dragged) return;
    page.dragged = 0;
    page.changed();
    page.settle();
    page.controls.show(page.given);
  };
  canvas.addEventListener("pointerup", end);
  canvas.addEventListener("pointercancel", end);
}
