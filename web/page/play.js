"use strict";
// The playground: a simulated drive in WebAssembly; the adaptive loop and records come with their first look.

const $ = (id) => document.getElementById(id);
const bytes = (base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
/** A module from its gzip in base64. */
async function module(base64) {
  const stream = new Blob([bytes(base64)]).stream().pipeThrough(new DecompressionStream("gzip"));
  return (await WebAssembly.instantiate(await new Response(stream).arrayBuffer(), {})).instance.exports;
}
let core = null;

/** Rows of a module's buffer. */
function rows(of, count, width) { return new Float32Array(of.memory.buffer, of.buffer(), count * width); }
const playground = { frames: 0 };
window.playground = playground;

// ---- tabs -------------------------------------------------------------------------------------------------------

const tabs = [...document.querySelectorAll("[role=tab]")];
let shown = "servo";
function show(tab) {
  for (const other of tabs) { const on = other === tab; other.setAttribute("aria-selected", on); other.tabIndex = on ? 0 : -1; $(other.getAttribute("aria-controls")).hidden = !on; }
  shown = tab.id.slice(4);
  if (shown === "loop") loadLoop();
  if (shown === "record") loadRecord();
  if (core) build();
}
tabs.forEach((tab, k) => {
  tab.onclick = () => show(tab);
  tab.onkeydown = (event) => { const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key]; if (step) { const next = tabs[(k + step + tabs.length) % tabs.length]; show(next); next.focus(); } };
});

/** A script beside the page, when it is needed: pages from files may not fetch. */
function script(name) {
  return new Promise((done, failed) => { const element = document.createElement("script"); element.src = name; element.onload = done; element.onerror = () => failed(new Error(`${name} is not beside the page`)); document.head.append(element); });
}

/** What the second and the third part need comes with their first look. */
let loopParts = null, recordParts = null;
function loadLoop() {
  loopParts = loopParts || script("loop.js").then(() => startLoop()).catch((error) => { loopParts = null; $("loop-answer").textContent = error.message; });
}
function loadRecord() {
  recordParts = recordParts || script("record.js").then(() => { wireRecord(); playground.wired = true; }, (error) => { recordParts = null; $("file-says").textContent = error.message; });
}

// ---- sliders ----------------------------------------------------------------------------------------------------

const READS = {
  eta: (x) => `${x / 1000} mm`, drift: (x) => `${x / 1000} mm`, eps: (x) => `${x} \u00b5m`, filter: (x) => `${x} rad/s`, memory: (x) => x > 8 ? "all" : `${x} s`,
  "loop-noise": (x) => `\u00b1${x} \u00b5m`, "loop-eps": (x) => `${x} \u00b5m`, "loop-memory": (x) => `${x} s`,
};
const value = (id) => Number($(id).value);
for (const id of Object.keys(READS)) {
  const output = document.querySelector(`output[for="${id}"]`), tell = () => { output.textContent = READS[id](value(id)); $(id).setAttribute("aria-valuetext", output.textContent); };
  $(id).oninput = () => { tell(); if (!id.startsWith("loop")) beginServo(); else if (playground.looping) beginLoop(); };
  tell();
}

// ---- the servo of the paper ---------------------------------------------------------------------------------------

const TRUTH = [400, 20, 1e6, 2500, 20, 0.5];
const NAMES = ["a1 [1/s\u00b2]", "a2 [1/s]", "b0 [mm/s\u00b3]", "C [mm/s]", "\u03c90 [rad/s]", "\u03be"];
const servo = { samples: new Samples(16384), reads: [], paused: false, seed: 1, owed: 0, tick: 0, plots: null };

function beginServo() {
  if (!core) return;
  const memory = value("memory");
  core.servo_start(value("eta"), value("drift"), value("eps"), value("filter"), memory > 8 ? 0 : memory, servo.seed++);
  servo.samples.clear(); servo.reads = []; servo.owed = 0; servo.tick = 0;
}

function stepServo(seconds) {
  if (servo.paused) return;
  servo.owed += Math.min(0.1, seconds) * 1000 * value("speed");
  const count = Math.floor(servo.owed);
  servo.owed -= count;
  if (count < 1) return;
  const got = core.servo_run(count), r = rows(core, got, 4);
  // Counted here: as an f32 the time has whole milliseconds for four hours only, a quarter of one at twenty times the speed.
  for (let i = 0; i < got; i++) servo.samples.push([servo.tick++, r[4 * i + 2], r[4 * i + 3], 0, 0, r[4 * i + 1], null, 0, 255], 1e-3);
  core.servo_read();
  servo.reads.push([servo.samples.last, ...rows(core, 18, 1)]);
  if (servo.reads.length > 2500) servo.reads = servo.reads.filter((_, k) => k % 2 === 1 || k > 2000);
}

function buildServo() {
  const place = $("servo-parameters"), signals = $("servo-signals");
  place.replaceChildren(); signals.replaceChildren();
  const parameter = (k) => Object.assign(makePlot(place, {
    title: NAMES[k], unit: "", height: 190, axis: true, band: [2, 3],
    lines: [{ name: "estimate \u00b1 2 \u03c3", colour: "--blue" }, { hidden: true, colour: "--blue" }, { hidden: true, colour: "--blue" }, { name: "truth", colour: "--green", dash: [8, 4] }, { name: "\u00b1 2 bound", colour: "--orange", dash: [2, 4] }, { colour: "--orange", dash: [2, 4] }],
  }), { k });
  const c = servo.samples.column;
  servo.plots = {
    parameters: [parameter(3), parameter(4), parameter(5)],
    signals: [
      Object.assign(makePlot(signals, { title: "Position", unit: "mm", height: 150, lines: [{ name: "measured", colour: "--blue", width: 1 }, { name: "true", colour: "--orange", dash: [7, 4] }] }), { signals: [(i) => c.y[i], (i) => c.r[i]] }),
      Object.assign(makePlot(signals, { title: "Command", unit: "", height: 90, axis: true, lines: [{ colour: "--green" }] }), { signals: [(i) => c.u[i]] }),
    ],
  };
}

function drawServo() {
  const { reads, plots, samples } = servo;
  if (!reads.length) return;
  // The first tenth of a second says little and would rule the scale.
  const part = reads.filter((r) => r[0] > 0.25), end = samples.last, t = part.map((r) => r[0]);
  for (const p of plots.parameters) {
    const k = p.k, truth = TRUTH[k];
    const sane = (x) => Number.isFinite(x) && Math.abs(x - truth) < 0.6 * truth ? x : null;
    const column = (f) => part.map((r) => sane(f(r[k + 1], r[k + 7], r[k + 13])));
    p.draw([t, column((x) => x), column((x, s) => x + 2 * s), column((x, s) => x - 2 * s), t.map(() => truth), column((x, s, b) => truth + 2 * b), column((x, s, b) => truth - 2 * b)], 0, Math.max(1, end));
  }
  for (const p of plots.signals) p.draw(extremes(samples, end - 2, end, p.box.clientWidth / 1.5, 1e-3, p.signals), end - 2, end);
  const last = reads[reads.length - 1], body = $("servo-table").tBodies[0];
  NAMES.forEach((name, k) => {
    const [x, s, b] = [last[k + 1], last[k + 7], last[k + 13]];
    fill(body, k, [name, digits(x, 6), digits(2 * s, 2), digits(TRUTH[k], 6), digits(2 * b, 2), digits((x - TRUTH[k]) / s, 2)]);
  });
  playground.servo = { t: last[0], values: last.slice(1, 7), sigma: last.slice(7, 13), bound: last.slice(13, 19) };
}

function fill(body, k, texts) {
  let tr = body.rows[k];
  if (!tr) { tr = body.insertRow(); const th = document.createElement("th"); th.scope = "row"; tr.append(th); for (let c = 1; c < texts.length; c++) tr.insertCell(); }
  texts.forEach((text, c) => { if (tr.cells[c].textContent !== text) tr.cells[c].textContent = text; });
}

// ---- every frame --------------------------------------------------------------------------------------------------

function build() {
  if (shown === "servo") buildServo();
  if (shown === "loop" && playground.looping) buildLoop();
  if (shown === "record" && playground.wired && record.found) drawRecord();
}

let before = 0, drawn = 0;
function frame(now) {
  requestAnimationFrame(frame);
  const seconds = before ? (now - before) / 1000 : 0;
  before = now;
  if (shown === "servo") stepServo(seconds);
  if (shown === "loop" && playground.looping) stepLoop(seconds);
  if (now - drawn < 30) return;
  drawn = now;
  if (shown === "servo") drawServo();
  if (shown === "loop" && playground.looping) drawLoop();
  playground.frames++;
}

/** 1e5 samples, the best of five. */
function benchmark() {
  core.speed_fill(100000);
  let best = Infinity;
  for (let k = 0; k < 5; k++) { const begin = performance.now(); core.speed_run(); best = Math.min(best, performance.now() - begin); }
  playground.milliseconds = best;
  $("benchmark").textContent = `100 000 samples are identified in ${best.toFixed(1)} ms here.`;
}

/** A button that pauses a part. */
function toggle(id, part) { $(id).onclick = () => { part.paused = !part.paused; $(id).setAttribute("aria-pressed", part.paused); }; }

function wire() {
  toggle("servo-pause", servo);
  $("servo-again").onclick = beginServo;
  let timer = 0, width = 0;
  new ResizeObserver(([e]) => { const now = Math.round(e.contentRect.width); if (width && now !== width) { clearTimeout(timer); timer = setTimeout(build, 150); } width = now; }).observe(document.querySelector("main"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", build);
}

async function start() {
  core = await module(CORE);
  wire(); beginServo(); build();
  requestAnimationFrame(frame);
  setTimeout(benchmark, 300);
}
