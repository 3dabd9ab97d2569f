/** The page: what is shown, and what happens when somebody touches it. */

import { load } from "../../../cpp/wasm/pendcore.mjs";
import { Background } from "./background.mjs";
import { addressOf, caseInAddress, parseCase, toPython, toToml, writeCase } from "./case.mjs";
import { Chart } from "./chart.mjs";
import { Controls, methodFields } from "./controls.mjs";
import { copyAndSay } from "./copy.mjs";
import { Curves, drawCost } from "./curves.mjs";
import { coreBytes, LiveRun, Recording } from "./runs.mjs";
import { SceneView } from "./scene_view.mjs";
import { clamp, grid, simulateCase } from "./simulate.mjs";
import { listenToKeys, listenToPointer, listenToView, STEP } from "./touch.mjs";

const TRACE = 2; // s
const TRACE_PARTS = { least: 240, most: 2000, angle: 0.1 }; // in each, a link turns by this, rad
const SETTLED = 300; // ms, after which the address follows a change
const FORCES = 400; // times at which the largest force of a run is looked for
const GHOST = 1e-9; // rad
const FINDING_OUT = "how far it is right is being found out";
const NEIGHBOURS = { count: 1000, spread: 1e-5, rate: 60 };

/** @type {(id: string) => any} */
const byId = (id) => document.getElementById(id);
const data = parseCase(byId("data").textContent);

class Page {
  run = null;
  ghost = null;
  /** The run beside this one, if there is one. */
  other = null;
  neighbours = null;
  hash = "";
  copied = null;
  measured = undefined;
  dragged = 0;
  /** Whether a joint was dragged since the last frame. */
  isMoved = false;
  settling = undefined;
  question = 0;
  before = undefined;
  later = undefined;
  /** Why the address was refused, if it was. */
  refusal = "";
  traceParts = TRACE_PARTS.least;
  /** Whether the case was refused, so that the picture is older than it. */
  isRefused = false;
  comparisons = {};
  /** What is said as long as it is not known until when the run is right. */
  unknown = FINDING_OUT;

  constructor(core, bytes) {
    this.core = core;
    this.original = writeCase(data.case);
    this.given = this.#fromAddress() ?? parseCase(this.original);
    this.t = this.given.run.t_start ?? 0;
    this.speed = 1;
    this.isPlaying = false;
    this.validUntil = data.valid_until;
    this.view = new SceneView(byId("scene"));
    this.otherView = new SceneView(byId("other"));
    this.curves = new Curves(byId);
    this.cost = new Chart(byId("cost"), ["time (ms)", "error / total length"], { log: true });
    if (core) {
      this.background = new Background(bytes);
      this.controls = new Controls(byId("setup"), {
        kinds: data.kinds,
        defaults: data.defaults,
        changed: () => this.changed(),
      });
    } else {
      document.body.classList.add("without-core");
    }
    byId("about").textContent = data.about;
    byId("notice").textContent = data.notice;
    byId("notice").hidden = data.notice === "";
    this.#listen();
    this.begin();
    this.tell();
    requestAnimationFrame((now) => this.frame(now));
  }

  /** The case in the address, or null: one that is refused is refused as a whole. */
  #fromAddress() {
    this.refusal = "";
    try {
      return this.core && caseInAddress(data);
    } catch (error) {
      this.refusal = error.message;
      return null;
    }
  }

  #sayRefusal() {
    if (this.refusal) this.say(`The address holds a run that is refused: ${this.refusal}`);
  }

  /** The first run: if the core refuses the case in the address, that of the page. */
  begin() {
    this.rerun();
    if (this.run === null) {
      this.refusal = byId("message").textContent;
      this.given = parseCase(this.original);
      this.rerun();
    }
    this.#sayRefusal();
    this.showFields();
  }

  showFields() {
    if (!this.core) return;
    this.controls.show(this.given);
    methodFields(byId("method"), this.given, data.methods, () => this.changed());
  }

  /** The case has changed: it runs anew, and the address will hold it. */
  changed() {
    this.neighbours = null;
    this.validUntil = null;
    this.rerun();
    clearTimeout(this.settling);
    this.settling = setTimeout(() => this.settle(), SETTLED);
  }

  /** Writes the case into the address, which browsers allow a few times a second, and tells it. */
  settle() {
    clearTimeout(this.settling);
    this.tell();
    try {
      history.replaceState(null, "", addressOf(this.given));
    } catch {
      // A frame in a notebook has no address of its own.
    }
  }

  /** Tells a notebook around the page what it shows. */
  tell() {
    if (window.parent !== window)
      window.parent.postMessage({ pendcore: writeCase(this.given) }, "*");
  }

  rerun() {
    let run;
    try {
      run = this.core
        ? new LiveRun(this.core, this.given)
        : new Recording(data.recording, this.given);
    } catch (error) {
      return this.refused(error.message);
    }
    this.run?.free();
    this.run = run;
    this.isRefused = false;
    this.unknown = this.core ? FINDING_OUT : "how far it is right is not known";
    this.say(run.success ? "" : run.message);
    this.t = run.within(this.t);
    const time = byId("time");
    [time.min, time.max] = [run.begin, run.end].sort((a, b) => a - b).map(String);
    this.view.typicalForce = this.otherView.typicalForce = this.#typicalForce();
    this.#ghost();
    this.#offerComparisons();
    this.#compare();
    if (!this.dragged) this.#bits();
    this.curves.until = this.validUntil;
    this.curves.set(run);
    const needed = (TRACE * this.curves.fastest) / TRACE_PARTS.angle;
    this.traceParts = Math.ceil(clamp(needed, TRACE_PARTS.least, TRACE_PARTS.most));
    this.#ask();
    this.draw();
    return undefined;
  }

  /** What can run beside this one: without an effect, from another start, as the page was made. */
  #offerComparisons() {
    const menu = byId("compare");
    const before = menu.value;
    const known = (kind) => data.kinds.find((one) => one.kind === kind).name;
    this.comparisons = {
      nothing: null,
      ...Object.fromEntries(
        this.given.effect.map((one, i) => [
          `without ${i + 1}: ${known(one.kind)}`,
          (given) => given.effect.splice(i, 1),
        ]),
      ),
      "a start 0.001 rad away": ({ start }) => (start.q[start.q.length - 1] += 1e-3),
      "the run as it was": (given) => Object.assign(given, parseCase(this.original)),
    };
    const names = Object.keys(this.comparisons);
    menu.replaceChildren(...names.map((name) => new Option(name, name)));
    menu.value = names.includes(before) ? before : "nothing";
  }

  #compare() {
    this.other?.free();
    this.other = null;
    const name = byId("compare").value;
    const change = this.comparisons[name];
    if (this.core && change) {
      const given = structuredClone(this.given);
      change(given);
      try {
        this.other = new LiveRun(this.core, given);
      } catch (error) {
        this.say(`${name}: ${error.message}`);
      }
    }
    byId("beside").hidden = !this.other;
    byId("other-name").textContent = name;
    if (this.run) this.curves.compare(this.other?.n === this.run.n ? this.other : null);
  }

  /** The picture stays that of the last run that was possible, and nothing is said of it. */
  refused(reason) {
    this.isRefused = true;
    this.say(reason);
    this.question += 1;
    byId("bits").textContent = "";
    this.#sayTrust("lost", "the picture is that of the last run that was possible");
  }

  /** The size of a force, N, than which few of the run are larger: arrows are as long as that. */
  #typicalForce() {
    const { run } = this;
    const sizes = grid(run.begin, run.end, FORCES).flatMap((t) => {
      const forces = run.reactions(t, run.state(t));
      return Array.from({ length: run.n }, (_x, i) => Math.hypot(forces[2 * i], forces[2 * i + 1]));
    });
    const sorted = sizes.filter(Number.isFinite).sort((a, b) => a - b);
    return sorted[Math.floor(0.95 * (sorted.length - 1))] || 1;
  }

  say(text) {
    const message = byId("message");
    message.textContent = text;
    message.hidden = text === "";
  }

  /** Shows the hash of the run, beside Python's if it is still Python's run. */
  #bits() {
    const badge = byId("bits");
    if (!this.core) {
      badge.textContent = data.hash ? `played back; Python's hash ${data.hash}` : "played back";
      return;
    }
    const { run, scene } = simulateCase(this.core, this.given);
    this.hash = run.hash;
    run.free();
    scene.free();
    if (writeCase(this.given) !== this.original || !data.hash) {
      badge.textContent = `hash ${this.hash}`;
      return;
    }
    const same = this.hash === data.hash;
    badge.textContent = same
      ? `the bits of Python: hash ${this.hash} = ${data.hash}`
      : `not the bits of Python: hash ${this.hash}, Python's ${data.hash}`;
  }

  #ghost() {
    this.ghost?.free();
    this.ghost = null;
    if (!this.core || !byId("ghost").checked) return;
    const start = structuredClone(this.given.start);
    start.q[start.q.length - 1] += GHOST;
    try {
      this.ghost = new LiveRun(this.core, { ...this.given, start });
    } catch {
      this.ghost = null;
    }
  }

  /** What takes longer than a frame comes later; an answer to an older question is dropped. */
  #ask() {
    if (!this.background) return;
    clearTimeout(this.later);
    const asked = ++this.question;
    const isStale = () => asked !== this.question;
    this.later = setTimeout(async () => {
      const given = structuredClone(this.given);
      try {
        if (this.validUntil === null) {
          const until = await this.background.ask("horizon", given, { limit: data.limit });
          if (isStale()) return;
          this.validUntil = until;
          this.curves.until = until;
          this.curves.choose();
          this.draw();
        }
        if (byId("neighbours").checked && !this.neighbours) {
          byId("rate").textContent = "computing a thousand neighbours";
          const found = await this.background.ask("neighbours", given, NEIGHBOURS);
          if (isStale()) return;
          this.neighbours = found;
          byId("rate").textContent = "";
          this.draw();
        }
      } catch (error) {
        if (!isStale()) this.unknown = `how far it is right is not known: ${error.message}`;
      }
    }, 150);
  }

  /** Says until when the run is right, in the words of what is shown now. */
  trust() {
    const until = this.validUntil;
    const [kind, words] =
      until === null
        ? ["", this.unknown]
        : this.#isRight(this.run.end) || Math.abs(until - this.run.end) < 1e-9 * Math.abs(until)
          ? ["right", `right to ${data.limit} rad to the end`]
          : this.#isRight(this.t)
            ? ["until", `right to ${data.limit} rad until ${until.toPrecision(4)} s`]
            : ["lost", `not right any more, since ${until.toPrecision(4)} s`];
    this.#sayTrust(kind, words);
  }

  #sayTrust(kind, words) {
    const told = byId("trust");
    if (told.textContent === words) return;
    told.className = `badge ${kind}`;
    told.textContent = words;
  }

  #isRight(t) {
    if (this.validUntil === null) return true;
    return this.run.direction > 0 ? t <= this.validUntil * (1 + 1e-12) : t >= this.validUntil;
  }

  frame(now) {
    const passed = Math.min((now - (this.before ?? now)) / 1000, 0.25);
    this.before = now;
    if (this.isMoved) {
      this.isMoved = false;
      this.changed();
    }
    if (this.isPlaying && !this.dragged) {
      this.t = this.run.within(this.t + this.run.direction * passed * this.speed);
      if (this.t === this.run.end) this.play(false);
      this.draw();
    }
    requestAnimationFrame((later) => this.frame(later));
  }

  draw() {
    const { run, t, ghost, other } = this;
    this.view.draw({
      ...this.#shown(run, t),
      ghost: ghost && ghost.places(ghost.within(t), ghost.state(t)),
      neighbours: byId("neighbours").checked ? this.neighbours : null,
    });
    if (other) {
      Object.assign(this.otherView, { zoom: this.view.zoom, shift: this.view.shift });
      this.otherView.draw(this.#shown(other, other.within(t)));
    }
    const state = run.state(t);
    if (!this.isRefused) this.trust();
    const past = this.#isRight(run.end) ? null : this.validUntil;
    this.curves.draw(t, state, past);
    byId("clock").textContent = `${t.toFixed(2)} s`;
    byId("time").value = String(t);
    const angles = Array.from(
      { length: run.n },
      (_x, i) => `q${i + 1} ${((state[i] * 180) / Math.PI).toFixed(1)} degrees`,
    );
    this.view.canvas.setAttribute("aria-label", `At ${t.toFixed(2)} s: ${angles.join(", ")}`);
  }

  /** What the picture of a run shows at a time; it is pale where this page's run is not right. */
  #shown(run, t) {
    const state = run.state(t);
    const places = run.places(t, state);
    return {
      places,
      t,
      lengths: run.lengths,
      isLost: !this.#isRight(t),
      pivot: [places[0], places[1]],
      forces: byId("reactions").checked ? run.reactions(t, state) : null,
      path: byId("trace").checked ? this.#path(t, run) : null,
    };
  }

  #path(t, run) {
    const since = run.within(t - run.direction * TRACE);
    const times = grid(since, t, this.traceParts);
    return run.states(times).flatMap((state, k) => [...run.places(times[k], state).slice(-2)]);
  }

  play(isPlaying) {
    if (isPlaying && this.t === this.run.end) this.t = this.run.begin;
    this.isPlaying = isPlaying;
    const button = byId("play");
    button.textContent = isPlaying ? "Pause" : "Play";
    button.setAttribute("aria-pressed", String(isPlaying));
  }

  go(t) {
    this.play(false);
    this.t = this.run.within(t);
    this.draw();
  }

  #listen() {
    byId("play").addEventListener("click", () => this.play(!this.isPlaying));
    byId("back").addEventListener("click", () => this.go(this.t - STEP));
    byId("forth").addEventListener("click", () => this.go(this.t + STEP));
    byId("time").addEventListener("input", () => this.go(Number(byId("time").value)));
    byId("speed").addEventListener("change", () => {
      this.speed = Number(byId("speed").value);
    });
    for (const id of ["trace", "reactions"]) byId(id).addEventListener("change", () => this.draw());
    byId("ghost").addEventListener("change", () => {
      this.#ghost();
      this.draw();
    });
    byId("neighbours").addEventListener("change", () => this.#ask());
    byId("compare").addEventListener("change", () => {
      this.#compare();
      this.draw();
    });
    byId("measure").addEventListener("click", () => this.#measure());
    this.#tabs();
    listenToKeys(byId("scene"), this);
    listenToPointer(byId("scene"), this);
    listenToView(byId("scene"), this);
    for (const menu of this.curves.menus)
      menu.addEventListener("change", () => {
        this.curves.choose();
        this.draw();
      });
    const copy = (id, text) =>
      byId(id).addEventListener("click", () => {
        this.copied = text();
        copyAndSay(byId(id), this.copied);
      });
    // A notebook's frame has no address to copy.
    byId("copy-link").hidden = location.protocol === "about:";
    copy("copy-link", () => location.href.split("#")[0] + addressOf(this.given));
    copy("copy-toml", () => toToml(this.given));
    copy("copy-python", () => toPython(this.given, data.kinds));
    window.addEventListener("resize", () => this.draw());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    window.addEventListener("hashchange", () => {
      const given = this.#fromAddress();
      this.#sayRefusal();
      if (!given || writeCase(given) === writeCase(this.given)) return;
      this.given = given;
      this.changed();
      this.showFields();
    });
  }

  #tabs() {
    const tabs = ["curves", "setup", "accuracy"];
    const show = (chosen) => {
      for (const name of tabs) {
        byId(name).hidden = name !== chosen;
        byId(`tab-${name}`).setAttribute("aria-selected", String(name === chosen));
      }
      this.draw();
      this.cost.draw();
    };
    for (const name of tabs) byId(`tab-${name}`).addEventListener("click", () => show(name));
  }

  async #measure() {
    const told = byId("measured");
    const question = this.question;
    told.textContent = "measuring";
    byId("measure").disabled = true;
    const draw = (points) => drawCost(this.cost, points);
    this.background.progress = (points) => question === this.question && draw(points);
    try {
      const methods = data.methods.filter((name) => name !== "auto" && !name.includes("-"));
      const points = await this.background.ask("cost", structuredClone(this.given), { methods });
      if (question !== this.question) throw new Error("the scene has changed since");
      draw(points);
      this.measured = points;
      const beyond = this.#isRight(this.run.end)
        ? ""
        : "; past the time until which it is right, no tolerance helps";
      told.textContent = `${points.length} runs; errors against the tightest run${beyond}`;
    } catch (error) {
      told.textContent = error.message;
    }
    byId("measure").disabled = false;
  }
}

async function begin() {
  const bytes = await coreBytes();
  const core = bytes && data.can_run ? await load(bytes.slice(0)) : null;
  const page = new Page(core, bytes);
  /** @type {any} */ (window).pendcorePage = page;
  const isStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
  byId("speed").value = "1"; // some browsers remember what was chosen before
  page.play(!isStill);
}

begin().catch((error) => {
  const message = byId("message");
  message.textContent = `This page cannot run here: ${error.message}`;
  message.hidden = false;
});
