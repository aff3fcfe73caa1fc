"use strict";
// The playground: two simulated drives in WebAssembly, and records identified in the browser.

const $ = (id) => document.getElementById(id);
const bytes = (base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
/** A module from its gzip in base64. */
async function module(base64) {
  const stream = new Blob([bytes(base64)]).stream().pipeThrough(new DecompressionStream("gzip"));
  return (await WebAssembly.instantiate(await new Response(stream).arrayBuffer(), {})).instance.exports;
}
let core = null;

function rows(count, width) { return new Float32Array(core.memory.buffer, core.buffer(), count * width); }
function words(length) { return new TextDecoder().decode(new Uint8Array(core.memory.buffer, core.text(), length)); }
const playground = { frames: 0 };
window.playground = playground;

// ---- tabs -------------------------------------------------------------------------------------------------------

const tabs = [...document.querySelectorAll("[role=tab]")];
let shown = "servo";
function show(tab) {
  for (const other of tabs) { const on = other === tab; other.setAttribute("aria-selected", on); other.tabIndex = on ? 0 : -1; $(other.getAttribute("aria-controls")).hidden = !on; }
  shown = tab.id.slice(4);
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

/** What the third part needs comes with its first look. */
let recordParts = null;
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
  $(id).oninput = () => { tell(); if (id.startsWith("loop")) beginLoop(); else beginServo(); };
  tell();
}

// ---- the servo of the paper ---------------------------------------------------------------------------------------

const TRUTH = [400, 20, 1e6, 2500, 20, 0.5];
const NAMES = ["a1 [1/s\u00b2]", "a2 [1/s]", "b0 [mm/s\u00b3]", "C [mm/s]", "\u03c90 [rad/s]", "\u03be"];
const servo = { samples: new Samples(16384), reads: [], paused: false, seed: 1, owed: 0, plots: null };

function beginServo() {
  if (!core) return;
  const memory = value("memory");
  core.servo_start(value("eta"), value("drift"), value("eps"), value("filter"), memory > 8 ? 0 : memory, servo.seed++);
  servo.samples.clear(); servo.reads = []; servo.owed = 0;
}

function stepServo(seconds) {
  if (servo.paused) return;
  servo.owed += Math.min(0.1, seconds) * 1000 * value("speed");
  const count = Math.floor(servo.owed);
  servo.owed -= count;
  if (count < 1) return;
  const got = core.servo_run(count), r = rows(got, 4);
  for (let i = 0; i < got; i++) servo.samples.push([Math.round(r[4 * i] * 1000), r[4 * i + 2], r[4 * i + 3], 0, 0, r[4 * i + 1], null, 0, 255], 1e-3);
  core.servo_read();
  servo.reads.push([servo.samples.last, ...rows(18, 1)]);
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

// ---- the pneumatic axis -------------------------------------------------------------------------------------------

const STATES = ["idle", "exciting", "identifying", "verified", "adapting", "frozen", "rejected", "failed"];
const loop = { samples: new Samples(16384), paused: false, seed: 1, owed: 0, plots: null, said: "" };

function beginLoop() {
  if (!core) return;
  core.loop_start(value("loop-noise"), value("loop-eps"), value("loop-memory"), loop.seed++);
  loop.samples.clear(); loop.owed = 0; loop.said = ""; $("loop-events").replaceChildren();
}

function askLoop(what, a, b, name) {
  const refused = core.loop_ask(what, a, b), said = $("loop-answer");
  said.textContent = refused ? `${name}: refused, ${words(refused)}` : `${name}: done`;
  said.classList.toggle("refused", refused > 0);
}

function stepLoop(seconds) {
  if (loop.paused) return;
  loop.owed += Math.min(0.1, seconds) * 1000;
  // One state at a time, so that no state is missed in the list of events.
  let count = Math.floor(loop.owed);
  loop.owed -= count;
  while (count > 0) {
    const part = Math.min(10, count);
    count -= part;
    const got = core.loop_run(part), r = rows(got, 8);
    for (let i = 0; i < got; i++) {
      const k = 8 * i;
      loop.samples.push([Math.round(r[k] * 1000), r[k + 2], r[k + 1], 0, 0, r[k + 3], Number.isNaN(r[k + 4]) ? null : r[k + 4], r[k + 5], r[k + 6]], 1e-3);
      if (r[k + 7]) note("a model reached the controller");
    }
    const state = words(core.loop_words());
    if (state !== loop.said) { loop.said = state; note(state); const box = $("loop-state"); box.textContent = state; box.dataset.s = LOOKS[loop.samples.column.s[loop.samples.count - 1]]; }
  }
}

function note(text) {
  const li = document.createElement("li"), time = document.createElement("time");
  time.textContent = `${loop.samples.last.toFixed(2)} s`;
  li.append(time, text);
  $("loop-events").prepend(li);
  while ($("loop-events").children.length > 100) $("loop-events").lastChild.remove();
}

function buildLoop() {
  const place = $("loop-signals"), c = loop.samples.column;
  place.replaceChildren();
  const plot = (title, unit, lines, height, signals, least, axis) => Object.assign(makePlot(place, { title, unit, lines, height, axis, least: () => least }), { signals });
  loop.plots = [
    plot("Position", "mm", [{ name: "measured", colour: "--blue" }, { name: "setpoint", colour: "--orange", dash: [7, 4] }], 200, [(i) => c.y[i], (i) => c.r[i]], 8),
    plot("Error", "mm", [{ colour: "--purple" }], 110, [(i) => c.r[i] - c.y[i]], 0.8),
    plot("Command", "", [{ colour: "--green" }], 120, [(i) => c.u[i]], 0.1, true),
  ];
}

function drawLoop() {
  const { samples, plots } = loop, end = Math.max(8, samples.last), from = end - 8;
  for (const p of plots) p.draw(extremes(samples, from, end, p.box.clientWidth / 1.5, 1e-3, p.signals), from, end);
  drawTimeline($("loop-timeline"), samples, from, end, STATES, 64);
  core.loop_read();
  const r = [...rows(14, 1)], known = r[12] > 0, show = (x, n) => known ? digits(x, n) : "\u2013", body = $("loop-table").tBodies[0];
  ["a1 [1/s\u00b2]", "a2 [1/s]", "b0 [mm/s\u00b3]"].forEach((name, k) => fill(body, k, [name, show(r[k], 5), show(2 * r[k + 3], 2), show(r[k + 6], 5)]));
  ["dead zone", "offset", "friction [mm/s\u00b2]"].forEach((name, k) => fill(body, k + 3, [name, "", "", show(r[k + 9], 3)]));
  const i = samples.count - 1;
  playground.loop = i < 0 ? null : { t: samples.last, state: loop.said, position: samples.column.y[i], setpoint: samples.column.r[i], model: r.slice(6, 12) };
}

// ---- every frame --------------------------------------------------------------------------------------------------

function build() {
  if (shown === "servo") buildServo();
  if (shown === "loop") buildLoop();
  if (shown === "record" && playground.wired && record.found) drawRecord();
}

let before = 0, drawn = 0;
function frame(now) {
  requestAnimationFrame(frame);
  const seconds = before ? (now - before) / 1000 : 0;
  before = now;
  if (shown === "servo") stepServo(seconds);
  if (shown === "loop") stepLoop(seconds);
  if (now - drawn < 30) return;
  drawn = now;
  if (shown === "servo") drawServo();
  if (shown === "loop") drawLoop();
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

function wire() {
  const toggle = (id, part) => { $(id).onclick = () => { part.paused = !part.paused; $(id).setAttribute("aria-pressed", part.paused); }; };
  toggle("servo-pause", servo); toggle("loop-pause", loop);
  $("servo-again").onclick = beginServo; $("loop-again").onclick = beginLoop;
  $("loop-commission").onclick = () => askLoop(0, 0, 0, "commission");
  $("loop-stop").onclick = () => askLoop(1, 0, 0, "stop");
  $("loop-mass").onclick = () => askLoop(4, 3, 0, "three times the mass");
  $("loop-freeze").onclick = () => askLoop(5, 0, 0, "frozen sensor");
  $("loop-supply").onclick = () => askLoop(6, 4, 0, "supply of 4 bar");
  $("loop-heal").onclick = () => askLoop(7, 0, 0, "heal");
  $("loop-move").onsubmit = (event) => { event.preventDefault(); askLoop(2, Number(event.target.target.value), 0, "move"); };
  $("loop-osc").onsubmit = (event) => { event.preventDefault(); askLoop(3, Number(event.target.amplitude.value), Number(event.target.frequency.value), "oscillate"); };
  let timer = 0, width = 0;
  new ResizeObserver(([e]) => { const now = Math.round(e.contentRect.width); if (width && now !== width) { clearTimeout(timer); timer = setTimeout(build, 150); } width = now; }).observe(document.querySelector("main"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", build);
}

async function start() {
  core = await module(CORE);
  wire(); beginServo(); beginLoop(); build();
  requestAnimationFrame(frame);
  setTimeout(benchmark, 300);
}
