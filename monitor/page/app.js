"use strict";
// The page of the monitor: what the socket says is shown, what is asked goes back over it.

const $ = (id) => document.getElementById(id);
const token = new URLSearchParams(location.search).get("token") || "";
const MOST = 32768, ESTIMATES = 3000, EVENTS = 300;

const samples = new Samples(MOST);
let learned = [];
let machine = { name: "", unit: "mm", dt: 1e-3, travel: [0, 0], simulated: false };
let states = [], reasons = [], settings = [];
let socket = null, mine = false, up = false, silent = false, paused = false, view = null, dirty = true, redraws = 0;
let plots = null, cursorAt = null, hadSamples = false;

// ---- the socket -------------------------------------------------------------------------------------------------

function connect() {
  socket = new WebSocket(`ws://${location.host}/ws?token=${encodeURIComponent(token)}`);
  socket.onmessage = (event) => { const said = JSON.parse(event.data); if (Array.isArray(said)) { begin(); said.forEach(hear); } else hear(said); };
  socket.onclose = () => { mine = false; up = false; $("source").textContent = "the monitor does not answer: trying again"; showState(); enable(); setTimeout(connect, 1000); };
}

function ask(what) {
  if (!socket || socket.readyState !== WebSocket.OPEN) return answer({ done: false, why: "the monitor does not answer" }, what);
  socket.send(JSON.stringify(what));
}

/** Everything is told again after a connection. */
function begin() { samples.clear(); learned = []; $("events").replaceChildren(); }

const heard = {
  hello(m) {
    states = m.states; reasons = m.reasons; settings = m.settings;
    if (m.machine) { machine = m.machine; }
    showMachine(); buildSettings();
  },
  rows(m) {
    for (const row of m.v) samples.push(row, machine.dt);
    dirty = true;
    if (m.v.length) { silent = false; if (!hadSamples) { hadSamples = true; enable(); } showState(); }
  },
  learned(m) { learned.push(m); if (learned.length > ESTIMATES) learned.splice(0, learned.length - ESTIMATES); showModel(m); dirty = true; },
  health(m) { list($("counters"), Object.entries(m.counters)); },
  event(m) { if (m.begin && m.number === 0) { samples.clear(); learned = []; } showEvent(m); },
  answer(m) { answer(m, m.asked); },
  setting(m) { const input = document.querySelector(`[data-setting="${m.name}"]`); if (input && document.activeElement !== input) input.value = m.value === null ? "" : m.value; },
  control(m) { mine = m.yours; $("control").firstChild.textContent = mine ? `This page is in control${m.pages > 1 ? `; ${m.pages - 1} more open` : ""}. ` : m.taken ? "Another page is in control. " : "No page is in control. "; $("take").hidden = mine; enable(); },
  line(m) {
    up = m.up; silent = m.silent; document.body.classList.toggle("gone", !up || silent);
    $("source").textContent = up ? m.words : `line lost: ${m.words}`;
    $("rate").textContent = m.rate; $("missing").textContent = m.missing; $("dropped").textContent = m.dropped; $("lost").textContent = m.lost + m.corrupt;
    if (m.recorded !== null) $("record-says").textContent = `recording: ${m.recorded} samples`;
    showState(); enable();
  },
  record(m) {
    $("record").setAttribute("aria-pressed", m.on); $("record").textContent = m.on ? "End the record" : "Record";
    const says = $("record-says");
    says.replaceChildren(m.on ? "recording" : m.rows ? `${m.rows} samples in ` : m.why);
    if (!m.on && m.rows) {
      const link = document.createElement("a");
      link.href = `/record/${encodeURIComponent(m.name)}?token=${encodeURIComponent(token)}`; link.textContent = m.name; link.download = m.name; link.id = "record-link";
      says.append(link, m.why ? `; ${m.why}` : "");
    }
  },
  missed(m) { $("answer").textContent = `this page was too slow for ${m.messages} messages`; },
};
function hear(m) { const f = heard[m.t]; if (f) f(m); }

// ---- what is shown ----------------------------------------------------------------------------------------------

function showMachine() {
  $("name").textContent = machine.name || "trendid monitor";
  document.title = `${machine.name || "trendid"} \u2013 monitor`;
  document.querySelectorAll("[data-unit]").forEach((e) => { e.textContent = machine.unit; });
  const target = document.forms.move.target;
  target.min = machine.travel[0]; target.max = machine.travel[1];
  if (!target.value && machine.travel[1] > machine.travel[0]) target.value = digits(0.5 * (machine.travel[0] + machine.travel[1]), 3);
  const amplitude = document.forms.oscillate.amplitude;
  if (!amplitude.value) amplitude.value = digits(0.05 * (machine.travel[1] - machine.travel[0]), 2);
  $("play").hidden = !machine.simulated;
  $("report").href = `/report?token=${encodeURIComponent(token)}`;
  if (plots) plots.signals.forEach((p) => p.name(p.unit()));
}

function showState() {
  const box = $("state"), i = samples.count - 1;
  if (!up || i < 0) { box.dataset.s = up ? "idle" : "bad"; $("state-name").textContent = up ? "no samples yet" : "no line"; $("state-why").textContent = ""; return; }
  if (silent) { box.dataset.s = "bad"; $("state-name").textContent = "silent"; $("state-why").textContent = "the target sends no samples: what is shown is old"; return; }
  const state = samples.column.s[i], why = samples.column.why[i];
  const name = states[state] || `state ${state}`, words = why === 255 ? "" : reasons[why] || `reason ${why}`;
  box.dataset.s = LOOKS[state] || "idle";
  if ($("state-name").textContent !== name) $("state-name").textContent = name;
  if ($("state-why").textContent !== words) $("state-why").textContent = words;
}

function list(place, pairs) {
  while (place.children.length > 2 * pairs.length) place.lastChild.remove();
  pairs.forEach(([name, value], k) => {
    let dt = place.children[2 * k], dd = place.children[2 * k + 1];
    if (!dt) { dt = document.createElement("dt"); dd = document.createElement("dd"); place.append(dt, dd); }
    if (dt.textContent !== name) dt.textContent = name;
    if (dd.textContent !== String(value)) dd.textContent = value;
  });
}

/** A margin; the largest f32 stands for one without an end. */
const bounded = (x) => x > 1e30 ? "any" : digits(x, 3);

function showModel(m) {
  const unit = machine.unit, [a1, a2, b0, zone, offset, friction] = m.model;
  const used = m.accepted > 0;
  const inUse = used ? [a1, a2, b0, b0 / a1, Math.sqrt(a1), a2 / (2 * Math.sqrt(a1))] : Array(6).fill(null);
  const reading = m.reading || Array(3).fill([null, null]);
  const rows = [["a1 [1/s\u00b2]", m.theta[0], m.band[0]], ["a2 [1/s]", m.theta[1], m.band[1]], ["b0", m.theta[2], m.band[2]],
    [`C [${unit}/s]`, ...reading[0]], ["\u03c90 [rad/s]", ...reading[1]], ["\u03be", ...reading[2]]];
  const body = $("model").tBodies[0];
  rows.forEach((row, k) => {
    let tr = body.rows[k];
    if (!tr) { tr = body.insertRow(); const th = document.createElement("th"); th.scope = "row"; tr.append(th); tr.insertCell(); tr.insertCell(); tr.insertCell(); }
    const learns = used && row[1] !== null;
    [row[0], learns ? digits(row[1], 5) : "\u2013", learns ? digits(row[2], 2) : "\u2013", digits(inUse[k], 5)].forEach((text, c) => { if (tr.cells[c].textContent !== text) tr.cells[c].textContent = text; });
  });
  const margin = m.margins;
  list($("model-facts"), [
    ["dead zone", used ? digits(zone, 3) : "\u2013"], ["offset", used ? digits(offset, 3) : "\u2013"], [`friction [${unit}/s\u00b2]`, used ? digits(friction, 4) : "\u2013"],
    ["delay", used ? `${digits(1e3 * m.delay, 3)} ms` : "\u2013"], ["valve", used ? (m.reversed ? "reversed" : "as wired") : "\u2013"],
    [`expected innovation [${unit}]`, digits(m.expected, 3)],
    ["models accepted / refused", `${m.accepted} / ${m.refused}`], ["last refusal", m.refusal || "none"],
    ["bandwidth factor", digits(m.derating, 3)],
    ...(margin ? [["gain margin", bounded(margin[0])], ["phase margin", `${digits(margin[1], 3)}\u00b0`], ["delay margin", `${bounded(1e3 * margin[2])} ms`], ["largest sensitivity", digits(margin[3], 3)]] : []),
  ]);
  monitor.model = m;
}

function showEvent(m) {
  const li = document.createElement("li"), time = document.createElement("time"), b = document.createElement("b");
  const mark = { fault: "\u25c6 ", warn: "\u25b2 ", good: "\u2713 ", note: "" }[m.grave];
  li.className = m.grave; time.textContent = `${(m.tick * machine.dt).toFixed(3)} s`; b.textContent = mark + m.words;
  li.append(time, b);
  const events = $("events");
  events.prepend(li);
  while (events.children.length > EVENTS) events.lastChild.remove();
}

const NAMES = { set: (a) => `setting ${a.name}`, play: () => "simulated machine", move: (a) => `move to ${a.target} ${machine.unit}`, control: () => "control" };
function answer(m, asked) {
  const name = asked ? (NAMES[asked.do] ? NAMES[asked.do](asked) : asked.do) : "request";
  $("answer").textContent = m.done ? `${name}: done` : `${name}: refused, ${m.why}`;
  $("answer").classList.toggle("refused", !m.done);
  monitor.answers.push({ asked, done: m.done, why: m.why });
  if (monitor.answers.length > 100) monitor.answers.shift();
}

// ---- plots ------------------------------------------------------------------------------------------------------

function build() {
  const place = $("plots");
  if (plots) plots.all.forEach((p) => p.plot.destroy());
  place.replaceChildren();
  const c = samples.column, unit = () => machine.unit, speed = () => `${machine.unit}/s`;
  const last = () => learned.length ? learned[learned.length - 1].expected : null;
  const onRange = (from, to) => { view = [from, to]; $("reset").disabled = false; dirty = true; };
  const onCursor = (t) => { cursorAt = t; showCursor(); };
  const signal = (title, u, lines, height, signals, more = {}) => Object.assign(
    makePlot(place, { title, unit: u(), lines, height, onRange, onCursor, sync: "time", axis: false, ...more }), { signals, unit: u });
  const travel = (part) => ({ least: () => part * (machine.travel[1] - machine.travel[0]) });
  const bounds = () => { const e = last(); return e === null || e === undefined ? NaN : 2 * e; };
  const signals = [
    signal("Position", unit, [{ name: "measured", colour: "--blue" }, { name: "setpoint", colour: "--orange", dash: [7, 4] }], 200, [(i) => c.y[i], (i) => c.r[i]], travel(0.02)),
    signal("Error", unit, [{ colour: "--purple" }], 120, [(i) => c.r[i] - c.y[i]], travel(0.002)),
    signal("Command", () => "", [{ colour: "--green" }], 120, [(i) => c.u[i]], { least: () => 0.1 }),
    signal("Velocity", speed, [{ name: "observed", colour: "--blue" }, { name: "setpoint", colour: "--orange", dash: [7, 4] }], 120, [(i) => c.v[i], (i) => c.vr[i]], travel(0.1)),
    signal("Innovation", unit, [{ colour: "--purple", width: 1 }, { name: "\u00b1 2 \u03c3 expected", colour: "--orange", dash: [7, 4] }, { colour: "--orange", dash: [7, 4] }], 150, [(i) => c.e[i], bounds, () => -bounds()], { axis: true }),
  ];
  const pair = document.createElement("div");
  pair.className = "pair";
  place.append(pair);
  const parameter = (k, title) => Object.assign(makePlot(pair, {
    title, unit: "", height: 160, axis: true, onRange, band: [2, 3],
    lines: [{ name: "estimate \u00b1 2 \u03c3", colour: "--blue" }, { hidden: true, colour: "--blue" }, { hidden: true, colour: "--blue" }, { name: "in control", colour: "--orange", dash: [7, 4], step: true }],
  }), { k });
  const parameters = [parameter(0, "a1 [1/s\u00b2]"), parameter(1, "a2 [1/s]"), parameter(2, "b0")];
  plots = { signals, parameters, all: [...signals, ...parameters] };
  drawnOf = null;
  dirty = true;
}

function span() {
  if (view) return view;
  const width = Number($("window").value), end = paused ? pausedAt : samples.last;
  return [end - width, end];
}
let pausedAt = 0;

/** What the parameters were drawn of: they come ten times a second, the samples all the time. */
let drawnOf = null;

function draw() {
  const [from, to] = span();
  for (const p of plots.signals) p.draw(extremes(samples, from, to, p.box.clientWidth / COLUMN, machine.dt, p.signals), from, to);
  drawTimeline($("timeline"), samples, from, to, states, 64);
  redraws++;
  const newest = learned[learned.length - 1];
  if (!view && !paused && drawnOf === newest) return;
  drawnOf = newest;
  const part = learned.filter((m) => { const t = m.tick * machine.dt; return t >= from - 0.2 && t <= to + 0.2; });
  const t = part.map((m) => m.tick * machine.dt);
  for (const p of plots.parameters) {
    // Before the first model the recursion stands at its prior: nothing to show.
    const value = (m) => m.accepted > 0 ? m.theta[p.k] : null;
    const side = (sign) => (m) => m.accepted > 0 && m.band[p.k] !== null ? m.theta[p.k] + sign * m.band[p.k] : null;
    p.draw([t, part.map(value), part.map(side(1)), part.map(side(-1)), part.map((m) => m.accepted > 0 ? m.model[p.k] : null)], from, to);
  }
}

function showCursor() {
  if (cursorAt === null || !samples.count) { if (!view) $("cursor").textContent = "drag over a plot to zoom"; return; }
  const i = Math.min(samples.count - 1, samples.at(cursorAt)), c = samples.column, u = machine.unit;
  $("cursor").textContent = `t ${c.t[i].toFixed(3)} s   y ${digits(c.y[i], 6)} ${u}   r ${digits(c.r[i], 6)} ${u}   u ${digits(c.u[i], 4)}   v ${digits(c.v[i], 4)} ${u}/s   e ${digits(c.e[i], 3)} ${u}`;
}

let lastFrame = 0;
function frame(now) {
  requestAnimationFrame(frame);
  if (!dirty || now - lastFrame < 15) return;
  lastFrame = now; dirty = false;
  draw();
}

// ---- requests ---------------------------------------------------------------------------------------------------

function enable() {
  const able = mine && up;
  document.querySelectorAll("aside button, aside input").forEach((e) => { if (e.id !== "take") e.disabled = !able; });
  $("stop").disabled = !up;
}

/** What moves the axis is asked for twice. */
function confirmed(words, then) {
  const dialog = $("confirm");
  $("confirm-what").textContent = words;
  dialog.returnValue = "no";
  dialog.onclose = () => { if (dialog.returnValue === "yes") then(); };
  dialog.showModal();
}

function field(form, name) { return Number(form[name].value); }

function wire() {
  $("stop").onclick = () => ask({ do: "stop" });
  $("take").onclick = () => ask({ do: "control" });
  $("commission").onclick = () => confirmed("Commission the axis? It will be moved within its travel to find the model.", () => ask({ do: "commission" }));
  $("store").onclick = () => ask({ do: "store" });
  $("acknowledge").onclick = () => ask({ do: "acknowledge" });
  $("record").onclick = () => ask({ do: "record", on: $("record").getAttribute("aria-pressed") !== "true" });
  document.querySelectorAll("[data-trick]").forEach((b) => { b.onclick = () => ask({ do: "play", trick: b.dataset.trick }); });
  const submit = (form, f) => { form.onsubmit = (event) => { event.preventDefault(); f(form); }; };
  submit(document.forms.move, (f) => { const target = field(f, "target"); confirmed(`Move the axis to ${target} ${machine.unit}?`, () => ask({ do: "move", target })); });
  submit(document.forms.oscillate, (f) => { const amplitude = field(f, "amplitude"), frequency = field(f, "frequency"); confirmed(`Oscillate by ${amplitude} ${machine.unit} at ${frequency} Hz?`, () => ask({ do: "oscillate", amplitude, frequency })); });
  submit(document.forms.limits, (f) => ask({ do: "limits", velocity: field(f, "velocity"), acceleration: field(f, "acceleration"), jerk: field(f, "jerk") }));
  const names = ["a1", "a2", "b0", "dead zone", "offset", "friction"], install = $("install");
  for (const name of names) { const label = document.createElement("label"), input = document.createElement("input"); input.type = "number"; input.step = "any"; input.required = true; input.name = name; if (names.indexOf(name) > 2) input.value = 0; label.append(name, input, document.createElement("span")); install.append(label); }
  const button = document.createElement("button"); button.textContent = "Install"; button.dataset.moves = ""; install.append(button);
  submit(install, (f) => { const model = names.map((name) => Number(f[name].value)); confirmed("Control the axis with this model?", () => ask({ do: "install", model })); });
  $("pause").onclick = () => { paused = !paused; pausedAt = samples.last; if (!paused) view = null; $("pause").setAttribute("aria-pressed", paused); $("reset").disabled = !view; dirty = true; };
  $("reset").onclick = () => { view = null; $("reset").disabled = true; dirty = true; };
  $("window").onchange = () => { view = null; dirty = true; };
  addEventListener("keydown", (event) => {
    if (event.key === "Escape" && !$("confirm").open) { ask({ do: "stop" }); return; }
    if (event.target.closest("input, select, button, summary, dialog, a") || event.ctrlKey || event.metaKey || event.altKey) return;
    const [from, to] = span(), width = to - from;
    const zoom = (a, b) => { view = [a, b]; $("reset").disabled = false; dirty = true; event.preventDefault(); };
    if (event.key === " ") { $("pause").click(); event.preventDefault(); }
    else if (event.key === "+") zoom(from + 0.25 * width, to - 0.25 * width);
    else if (event.key === "-") zoom(from - 0.5 * width, to + 0.5 * width);
    else if (event.key === "ArrowLeft") zoom(from - 0.2 * width, to - 0.2 * width);
    else if (event.key === "ArrowRight") zoom(from + 0.2 * width, to + 0.2 * width);
  });
  let timer = 0;
  const rebuild = () => { clearTimeout(timer); timer = setTimeout(build, 150); };
  let width = 0;
  new ResizeObserver(([e]) => { const now = Math.round(e.contentRect.width); if (width && now !== width) rebuild(); width = now; }).observe($("plots"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", rebuild);
}

function buildSettings() {
  const place = $("settings");
  if (place.children.length) { settings.forEach((s) => heard.setting(s)); return; }
  for (const s of settings) {
    const form = document.createElement("form"), label = document.createElement("label"), input = document.createElement("input"), button = document.createElement("button"), bounds = document.createElement("span");
    const unit = s.unit.replace(/^y$/, machine.unit);
    input.type = "number"; input.step = "any"; input.min = s.limits[0]; input.max = s.limits[1]; input.id = `set-${s.name}`; input.dataset.setting = s.name;
    input.placeholder = s.follows ? "follows" : ""; input.required = !s.follows; if (s.value !== null) input.value = s.value;
    label.htmlFor = input.id; label.textContent = s.name.replace(/([._])/g, "$1\u200b"); button.textContent = "Set"; button.setAttribute("aria-label", `Set ${s.name}`);
    bounds.className = "bounds"; bounds.textContent = `${s.limits[0]} to ${s.limits[1]} ${unit}`;
    form.append(label, input, button, bounds);
    form.onsubmit = (event) => { event.preventDefault(); ask({ do: "set", name: s.name, value: input.value === "" ? null : Number(input.value) }); };
    place.append(form);
  }
  enable();
}

/** For tests: what the page knows. */
const monitor = { samples, answers: [], model: null, get redraws() { return redraws; }, get events() { return [...$("events").children].map((li) => li.textContent); },
  get latest() { const i = samples.count - 1, c = samples.column; return i < 0 ? null : { t: c.t[i], position: c.y[i], setpoint: c.r[i], command: c.u[i], state: states[c.s[i]], reason: reasons[c.why[i]] }; } };
window.monitor = monitor;

wire();
build();
enable();
connect();
requestAnimationFrame(frame);
