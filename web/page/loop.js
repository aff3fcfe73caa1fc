"use strict";
// The pneumatic axis under the adaptive loop, in a module of its own: LOOP is its gzip in base64.

let axis = null;

function words(length) { return new TextDecoder().decode(new Uint8Array(axis.memory.buffer, axis.text(), length)); }

const STATES = ["idle", "exciting", "identifying", "verified", "adapting", "frozen", "rejected", "failed"];
const loop = { samples: new Samples(16384), paused: false, seed: 1, owed: 0, tick: 0, plots: null, said: "" };

function beginLoop() {
  axis.loop_start(value("loop-noise"), value("loop-eps"), value("loop-memory"), loop.seed++);
  loop.samples.clear(); loop.owed = 0; loop.tick = 0; loop.said = ""; $("loop-events").replaceChildren();
}

function askLoop(what, a, b, name) {
  const refused = axis.loop_ask(what, a, b), said = $("loop-answer");
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
    const got = axis.loop_run(part), r = rows(axis, got, 8);
    for (let i = 0; i < got; i++) {
      const k = 8 * i;
      loop.samples.push([++loop.tick, r[k + 2], r[k + 1], 0, 0, r[k + 3], Number.isNaN(r[k + 4]) ? null : r[k + 4], r[k + 5], r[k + 6]], 1e-3);
      if (r[k + 7]) note("a model reached the controller");
    }
    const state = words(axis.loop_words());
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
  axis.loop_read();
  const r = [...rows(axis, 14, 1)], known = r[12] > 0, show = (x, n) => known ? digits(x, n) : "\u2013", body = $("loop-table").tBodies[0];
  ["a1 [1/s\u00b2]", "a2 [1/s]", "b0 [mm/s\u00b3]"].forEach((name, k) => fill(body, k, [name, show(r[k], 5), show(2 * r[k + 3], 2), show(r[k + 6], 5)]));
  ["dead zone", "offset", "friction [mm/s\u00b2]"].forEach((name, k) => fill(body, k + 3, [name, "", "", show(r[k + 9], 3)]));
  const i = samples.count - 1;
  playground.loop = i < 0 ? null : { t: samples.last, state: loop.said, position: samples.column.y[i], setpoint: samples.column.r[i], model: r.slice(6, 12) };
}

function wireLoop() {
  toggle("loop-pause", loop);
  $("loop-again").onclick = beginLoop;
  $("loop-commission").onclick = () => askLoop(0, 0, 0, "commission");
  $("loop-stop").onclick = () => askLoop(1, 0, 0, "stop");
  $("loop-mass").onclick = () => askLoop(4, 3, 0, "three times the mass");
  $("loop-freeze").onclick = () => askLoop(5, 0, 0, "frozen sensor");
  $("loop-supply").onclick = () => askLoop(6, 4, 0, "supply of 4 bar");
  $("loop-heal").onclick = () => askLoop(7, 0, 0, "heal");
  $("loop-move").onsubmit = (event) => { event.preventDefault(); askLoop(2, Number(event.target.target.value), 0, "move"); };
  $("loop-osc").onsubmit = (event) => { event.preventDefault(); askLoop(3, Number(event.target.amplitude.value), Number(event.target.frequency.value), "oscillate"); };
}

async function startLoop() {
  axis = await module(LOOP);
  wireLoop(); beginLoop();
  playground.looping = true;
  build();
}
