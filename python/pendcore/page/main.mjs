/** The page: what is shown, and what happens when somebody touches it. */

import { load } from "../../../cpp/wasm/pendcore.mjs";
import { convention } from "./angles.mjs";
import { Background } from "./background.mjs";
import { addressOf, caseInAddress, parseCase, toPython, toToml, writeCase } from "./case.mjs";
import { Chart } from "./chart.mjs";
import { Controls } from "./controls.mjs";
import { copyAndSay } from "./copy.mjs";
import { Curves, drawCost } from "./curves.mjs";
import { coreBytes, LiveRun, Recording, trust } from "./runs.mjs";
import { SceneView } from "./scene_view.mjs";
import { clamp, grid, simulateCase } from "./simulate.mjs";
import { listenToKeys, listenToPointer, listenToWheel, STEP } from "./touch.mjs";

const TRACE = 2; // s
const TRACE_PARTS = { least: 240, most: 2000, angle: 0.1 }; // in each, a link turns by this, rad
const SETTLED = 300; // ms, after which the address follows a change
const ASKED = 150; // ms, after which the worker is asked about a change
const FORCES = 400; // times at which the largest force of a run is looked for
const GHOST = 1e-9; // rad
const NEIGHBOURS = { count: 1000, spread: 1e-5, rate: 60 };
const NOTHING = "nothing";

/** @type {(id: string) => any} */
const byId = (id) => document.getElementById(id);
const data = parseCase(byId("data").textContent);
const original = writeCase(data.case);

function say(text) {
  byId("message").textContent = text;
}

/** Moves the last link of a case at the start. */
function away(angle) {
  return ({ start }) => {
    start.q[start.q.length - 1] += angle;
  };
}

class Page {
  /** The number of the joint that is dragged, or 0. */
  dragged = 0;
  /** Whether the case was refused, so that the picture is older than it. */
  isRefused = false;

  constructor(core, bytes) {
    this.core = core;
    this.given = parseCase(original);
    this.t = this.given.run.t_start ?? 0;
    this.view = new SceneView(byId("scene"));
    this.otherView = new SceneView(byId("other"));
    this.curves = new Curves(byId);
    this.cost = new Chart(byId("cost"), ["time (ms)", "error / total length"], { log: true });
    if (core) {
      this.background = new Background(bytes);
      this.controls = new Controls(byId, data, () => this.changed());
    }
    this.rerun();
    this.controls?.show(this.given);
    this.follow();
    this.#listen();
    this.tell();
    requestAnimationFrame((now) => this.frame(now));
  }

  /** Shows the case in the address, if it is another; one that is refused leaves all as it is. */
  follow() {
    const before = this.given;
    try {
      const given = this.core && caseInAddress(data);
      if (!given || writeCase(given) === writeCase(before)) return;
      this.given = given;
      this.rerun();
      this.controls.show(given);
    } catch (error) {
      this.given = before;
      say(`The address holds a run that is refused: ${error.message}`);
    }
  }

  /**
   * The case has changed: it runs anew, and the address will hold it. If it is refused, the picture
   * stays that of the last run that was possible, and nothing is said of it.
   */
  changed() {
    try {
      this.rerun();
    } catch (error) {
      this.isRefused = true;
      say(error.message);
      byId("bits").textContent = "";
      this.#sayTrust();
    }
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

  /** Tells a notebook around the page what it shows, in TOML, which has infinities. */
  tell() {
    if (window.parent !== window) window.parent.postMessage({ pendcore: toToml(this.given) }, "*");
  }

  /** Runs the case and shows it; a case that is refused throws an error, and all stays as it is. */
  rerun() {
    const { core, given } = this;
    const run = core ? new LiveRun(core, given) : new Recording(data.recording, given);
    this.run?.free();
    this.run = run;
    this.neighbours = null;
    this.isRefused = false;
    if (writeCase(given) === original) run.until = data.valid_until;
    /** What is said as long as it is not known until when the run is right. */
    this.unknown = `how far it is right is ${core ? "being found out" : "not known"}`;
    say(run.success ? "" : run.message);
    this.t = run.within(this.t);
    const time = byId("time");
    [time.min, time.max] = [run.begin, run.end].sort((a, b) => a - b).map(String);
    this.view.typicalForce = this.otherView.typicalForce = this.#typicalForce();
    if (!this.dragged) this.#bits();
    this.curves.set(run);
    this.#offerComparisons();
    this.showBeside();
  }

  /** What can run beside this one: without an effect, from another start, as the page was made. */
  #offerComparisons() {
    const menu = byId("compare");
    const before = menu.value;
    const name = (kind) => data.kinds.find((one) => one.kind === kind).name;
    const without = this.given.effect.map(({ kind }, i) => [
      `without ${i + 1}: ${name(kind)}`,
      (given) => given.effect.splice(i, 1),
    ]);
    this.comparisons = {
      [NOTHING]: null,
      ...Object.fromEntries(without),
      "the last link 0.001 rad further": away(1e-3),
      "the last link 0.1 rad further": away(0.1),
      "the run as it was": (given) => Object.assign(given, parseCase(original)),
    };
    menu.replaceChildren(...Object.keys(this.comparisons).map((one) => new Option(one)));
    menu.value = before in this.comparisons ? before : NOTHING;
  }

  /** Shows beside the run what the menu and the boxes under the picture say. */
  showBeside() {
    const name = byId("compare").value;
    this.ghost = this.#beside(this.ghost, byId("ghost").checked && away(GHOST));
    /** The run beside this one, if there is one. */
    this.other = this.#beside(this.other, this.comparisons[name]);
    this.runs = [this.run, this.other].filter(Boolean);
    for (const id of ["own-name", "beside"]) byId(id).hidden = !this.other;
    byId("other-name").textContent = name;
    this.curves.compare(this.other?.n === this.run.n ? this.other : null, name);
    this.#ask();
    this.draw();
  }

  /** A run of a changed case in the place of an older one; null without a change, or if refused. */
  #beside(older, change) {
    older?.free();
    if (!this.core || !change) return null;
    const given = structuredClone(this.given);
    change(given);
    try {
      return new LiveRun(this.core, given);
    } catch (error) {
      say(`The run beside this one is refused: ${error.message}`);
      return null;
    }
  }

  /** The size of a force, N, than which few of the run are larger: arrows are as long as that. */
  #typicalForce() {
    const { run } = this;
    const forces = run.moments(grid(run.begin, run.end, FORCES)).flatMap((one) => one.forces);
    const sizes = forces.map(([x, y]) => Math.hypot(x, y));
    const sorted = sizes.filter(Number.isFinite).sort((a, b) => a - b);
    return sorted[Math.floor(0.95 * (sorted.length - 1))] || 1;
  }

  /** Shows the hash of the run, beside Python's if it is still Python's run. */
  #bits() {
    const badge = byId("bits");
    if (!this.core) {
      badge.textContent = data.hash ? `played back; Python's hash ${data.hash}` : "played back";
      return;
    }
    const run = simulateCase(this.core, this.given);
    this.hash = run.hash;
    run.free();
    run.scene.free();
    if (writeCase(this.given) !== original || !data.hash) badge.textContent = `hash ${this.hash}`;
    else if (this.hash === data.hash)
      badge.textContent = `the bits of Python: hash ${this.hash} = ${data.hash}`;
    else badge.textContent = `not the bits of Python: hash ${this.hash}, Python's ${data.hash}`;
  }

  /** What takes longer than a frame comes later; what is told of an older run is dropped. */
  async #ask() {
    const { run, other, background } = this;
    if (!background) return;
    const isPast = () => run !== this.run || other !== this.other;
    await new Promise((resolve) => setTimeout(resolve, ASKED));
    if (isPast()) return;
    try {
      for (const one of this.runs.filter(({ until }) => until === null)) {
        one.until = await background.ask("horizon", one.given, { limit: data.limit });
        if (isPast()) return;
        this.curves.choose();
        this.draw();
      }
      if (byId("neighbours").checked && !this.neighbours) {
        byId("rate").textContent = "computing a thousand neighbours";
        const found = await background.ask("neighbours", run.given, NEIGHBOURS);
        byId("rate").textContent = "";
        if (run !== this.run) return;
        this.neighbours = found;
        this.draw();
      }
    } catch (error) {
      if (!isPast()) this.unknown = `how far it is right is not known: ${error.message}`;
    }
  }

  /** The words of the badge, for what is shown now, and the colour of its dot. */
  #trust() {
    if (this.isRefused) return ["the picture is that of the last run that was possible", "red"];
    if (this.runs.some(({ until }) => until === null)) return [this.unknown, "quiet"];
    return trust(this.runs, this.t, data.limit);
  }

  #sayTrust() {
    const badge = byId("trust");
    const [words, dot] = this.#trust();
    if (badge.textContent === words) return; // else it would be read aloud again and again
    badge.textContent = words;
    badge.style.setProperty("--dot", `var(--${dot})`);
  }

  frame(now) {
    const passed = Math.min((now - (this.before ?? now)) / 1000, 0.25);
    this.before = now;
    if (this.isPlaying && !this.dragged) {
      const { run } = this;
      this.t = run.within(this.t + run.direction * passed * Number(byId("speed").value));
      if (this.t === run.end) this.play(false);
      this.draw();
    }
    requestAnimationFrame((later) => this.frame(later));
  }

  draw() {
    const { run, t, ghost, other } = this;
    const now = run.at(t);
    this.view.draw({
      ...this.#shown(run, now),
      ghost: ghost?.at(t).places,
      neighbours: byId("neighbours").checked ? this.neighbours : null,
    });
    if (other) {
      Object.assign(this.otherView, { zoom: this.view.zoom, shift: this.view.shift });
      this.otherView.draw(this.#shown(other, other.at(t)));
    }
    this.#sayTrust();
    this.curves.draw(now);
    this.cost.draw();
    byId("clock").textContent = `${t.toFixed(2)} s`;
    byId("time").value = String(t);
    const { letter, angle } = convention();
    const degrees = (q) => ((angle(q) * 180) / Math.PI).toFixed(1);
    const angles = Array.from(now.q, (q, i) => `${letter}${i + 1} ${degrees(q)} degrees`);
    this.view.canvas.setAttribute("aria-label", `At ${t.toFixed(2)} s: ${angles.join(", ")}`);
  }

  /** What the picture of a run shows at a time; it is pale where the run is not right. */
  #shown(run, now) {
    const { t, places } = now;
    return {
      places,
      t,
      lengths: run.lengths,
      isLost: !run.isRight(t),
      forces: byId("reactions").checked ? now.forces : null,
      path: byId("trace").checked ? this.#path(t, run) : null,
    };
  }

  #path(t, run) {
    const since = run.within(t - run.direction * TRACE);
    const { least, most, angle } = TRACE_PARTS;
    const parts = clamp((TRACE * this.curves.fastest) / angle, least, most);
    const times = grid(since, t, Math.ceil(parts));
    return run.moments(times).map((one) => one.places.at(-1));
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
    const on = (id, event, act) => byId(id).addEventListener(event, act);
    on("play", "click", () => this.play(!this.isPlaying));
    on("back", "click", () => this.go(this.t - STEP));
    on("forth", "click", () => this.go(this.t + STEP));
    on("time", "input", () => this.go(Number(byId("time").value)));
    on("options", "change", () => this.showBeside());
    on("vertical", "change", () => this.controls?.show(this.given));
    on("measure", "click", () => this.#measure());
    on("quantities", "change", () => {
      this.curves.choose();
      this.draw();
    });
    this.#tabs();
    listenToKeys(byId("scene"), this);
    listenToPointer(byId("scene"), this);
    listenToWheel(byId("scene"), this);
    const copy = (id, text) =>
      on(id, "click", () => {
        this.copied = text();
        copyAndSay(byId(id), this.copied);
      });
    // A notebook's frame has no address to copy.
    byId("copy-link").hidden = location.protocol === "about:";
    copy("copy-link", () => location.href.split("#")[0] + addressOf(this.given));
    copy("copy-toml", () => toToml(this.given));
    copy("copy-python", () => toPython(this.given, data.kinds));
    window.addEventListener("resize", () => this.draw());
    window.addEventListener("hashchange", () => this.follow());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
  }

  #tabs() {
    const tabs = [...document.querySelectorAll("[role=tab]")];
    const choose = (chosen) => {
      for (const tab of tabs) {
        tab.setAttribute("aria-selected", String(tab === chosen));
        byId(tab.getAttribute("aria-controls")).hidden = tab !== chosen;
      }
      this.draw();
    };
    for (const tab of tabs) tab.addEventListener("click", () => choose(tab));
  }

  async #measure() {
    const { run, background, cost } = this;
    const told = byId("measured");
    told.textContent = "measuring";
    byId("measure").disabled = true;
    background.progress = (points) => run === this.run && drawCost(cost, points);
    try {
      const methods = data.methods.filter((name) => name !== "auto" && !name.includes("-"));
      const points = await background.ask("cost", structuredClone(this.given), { methods });
      if (run !== this.run) throw new Error("the scene has changed since");
      drawCost(cost, points);
      this.measured = points;
      const beyond = run.isRight(run.end)
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
  const core = bytes && (await load(bytes));
  const page = new Page(core, bytes);
  /** @type {any} */ (window).pendcorePage = page;
  page.play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
}

begin().catch((error) => say(`This page cannot run here: ${error.message}`));
