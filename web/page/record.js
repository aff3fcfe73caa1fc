"use strict";
// A record that was dropped: read, identified by the second module, shown, given as code.

const record = { name: "", columns: [], data: [], bad: [], found: null, plot: null, module: null, language: "rust" };

/** Columns of a CSV: comments begin with #, cells are separated by commas, or by semicolons or tabs when the header has no comma. */
// What is no number is told where its column is used.
function parseCsv(text) {
  const lines = text.replace(/^\ufeff/, "").split(/\r?\n/), bare = (cell) => cell.trim().replace(/^"(.*)"$/, "$1").trim();
  let names = null, separator = ",";
  const data = [], bad = [];
  for (let n = 0; n < lines.length; n++) {
    const line = lines[n];
    if (line.startsWith("#") || line.trim() === "") continue;
    if (!names) {
      separator = line.includes(",") ? "," : line.includes(";") ? ";" : "\t";
      names = line.split(separator).map(bare);
      if (names.length < 3) throw new Error(`line ${n + 1}: ${names.length} columns where time, input and output are expected`);
      if (names.every((name) => number(name) !== null)) throw new Error(`line ${n + 1}: numbers where the names of the columns are expected`);
      names.forEach(() => data.push([]));
      continue;
    }
    const cells = line.split(separator);
    if (cells.length !== names.length) throw new Error(`line ${n + 1}: ${cells.length} cells where the header has ${names.length}`);
    cells.map(bare).forEach((cell, k) => {
      const value = number(cell);
      if (value === null && !bad[k]) bad[k] = `line ${n + 1}, column ${names[k]}: ${cell === "" ? "nothing" : `\u201c${cell.slice(0, 40)}\u201d`} where a number is expected${/^[-+]?\d+,\d+$/.test(cell) ? ", with a point and no comma" : ""}`;
      data[k].push(value === null ? NaN : value);
    });
    if (data[0].length > 500000) throw new Error("more than 500 000 samples");
  }
  if (!names || !data[0].length) throw new Error("no samples");
  return { names, data, bad };
}

/** A finite decimal number, or null: Number() takes an empty cell and 0x10, too. */
function number(cell) { const value = Number(cell); return /^[-+]?[\d.]/.test(cell) && !/^[-+]?0[box]/i.test(cell) && Number.isFinite(value) ? value : null; }

const UNITS = { ms: 1e-3, msec: 1e-3, us: 1e-6, usec: 1e-6, "\u00b5s": 1e-6, "\u03bcs": 1e-6, ns: 1e-9, nsec: 1e-9 };

/** The unit other than s that the name of a column of times ends with, as `trendid identify` reads it. */
function unitOf(name) { const last = name.split(/[^\p{L}\p{N}]+/u).filter(Boolean).pop(); return Object.hasOwn(UNITS, last ?? "") ? last : "s"; }

/** How the times of a column are taken. */
function clockSays(name, t) {
  const unit = unitOf(name);
  return unit !== "s" ? `${name} in ${unit}` : t.length > 1 && t.every(Number.isInteger) ? `${name} holds whole numbers, taken for s: name it ${name}_ms where they count ms` : "";
}

/** Sample time of a column of times; refuses steps that differ by more than a hundredth. */
function sampleTime(t) {
  const dt = (t[t.length - 1] - t[0]) / (t.length - 1);
  if (!(dt > 0)) throw new Error("the time does not grow");
  for (let i = 1; i < t.length; i++) {
    const step = t[i] - t[i - 1];
    if (!(Math.abs(step - dt) <= 0.01 * dt)) throw new Error(`sample ${i + 1}: a step of ${digits(step)} s where ${digits(dt)} s are expected`);
  }
  return dt;
}

async function load(file) {
  const says = $("file-says");
  try {
    const { names, data, bad } = parseCsv(await file.text());
    Object.assign(record, { name: file.name, columns: names, data, bad });
    const form = $("problem");
    const guess = { t: [/^t(ime)?(?!\p{L})/iu, 0], u: [/^u(?!\p{L})|input|command/iu, 1], y: [/^y(?!\p{L})|output|position/iu, 2] };
    for (const [field, [pattern, otherwise]] of Object.entries(guess)) {
      const select = form[field];
      select.replaceChildren(...names.map((name, k) => new Option(name, k)));
      const hit = names.findIndex((name) => pattern.test(name));
      select.value = hit < 0 ? otherwise : hit;
    }
    form.hidden = false; says.classList.remove("refused");
    const clock = clockSays(names[form.t.value], data[form.t.value]);
    says.textContent = `${file.name}: ${data[0].length} samples, columns ${names.join(", ")}${clock ? `; ${clock}` : ""}`;
  } catch (error) { says.classList.add("refused"); says.textContent = `${file.name}: ${error.message}`; }
}

/** The second module comes when it is needed. */
async function identifier() {
  if (record.module) return record.module;
  if (!window.IDENTIFY) await script("identify.js");
  record.module = await module(window.IDENTIFY);
  return record.module;
}

async function compute(act) {
  const found = $("found"), form = $("problem");
  found.innerHTML = "<p class=\"note\">computing</p>"; $("snippet").hidden = true; $("record-plot").replaceChildren();
  record.found = null;
  try {
    const [t, u, y] = ["t", "u", "y"].map((field) => { const k = form[field].value; if (record.bad[k]) throw new Error(record.bad[k]); return record.data[k]; });
    const dt = sampleTime(t) * (UNITS[unitOf(record.columns[form.t.value])] ?? 1), wasm = await identifier();
    await new Promise((later) => setTimeout(later, 30));
    const n = u.length, at = wasm.room(n);
    if (!at) throw new Error("too many samples");
    const place = new Float64Array(wasm.memory.buffer, at, 2 * n);
    place.set(u, 0); place.set(y, n);
    const begin = performance.now(), length = act(wasm, dt, form);
    const answer = JSON.parse(new TextDecoder().decode(new Uint8Array(wasm.memory.buffer, wasm.answer(), length)));
    if (answer.error) throw new Error(answer.error);
    return Object.assign(answer, { seconds: (performance.now() - begin) / 1000, dt, y });
  } catch (error) { const p = document.createElement("p"); p.className = "refused"; p.textContent = error.message; found.replaceChildren(p); return null; }
}

function polynomial(coefficients, top) {
  const power = (k) => k === 0 ? "" : k === 1 ? " s" : ` s^${k}`;
  const terms = [];
  for (let k = coefficients.length - 1; k >= 0; k--) {
    const c = coefficients[k];
    if (c === 0) continue;
    const one = k === top && c === 1;
    terms.push(`${terms.length ? (c < 0 ? " - " : " + ") : c < 0 ? "-" : ""}${one ? power(k).trim() : digits(Math.abs(c), 6) + power(k)}`);
  }
  return terms.join("") || "0";
}

async function identifyRecord(event) {
  event.preventDefault();
  const answer = await compute((wasm, dt, f) => wasm.identify_record(dt, Number(f.order.value), Math.min(Number(f.zeros.value), Number(f.order.value) - 1), (f.integrator.checked ? 1 : 0) + (f.constant.checked ? 2 : 0) + (f.delay.checked ? 4 : 0)));
  if (!answer) return;
  record.found = answer;
  const { model } = answer, den = [...model.a, 1], num = model.b, top = polynomial(num, -1), bottom = polynomial(den, model.a.length);
  const wide = Math.max(top.length, bottom.length), pad = (text) => " ".repeat(Math.floor((wide - text.length) / 2)) + text;
  const box = document.createElement("div"), tf = document.createElement("div"), table = document.createElement("table");
  tf.className = "tf"; tf.tabIndex = 0; tf.setAttribute("role", "img"); tf.setAttribute("aria-label", `transfer function ${top} over ${bottom}`);
  tf.textContent = `       ${pad(top)}\nG(s) = ${"\u2500".repeat(wide)}${answer.delay ? `  delay ${digits(answer.delay * answer.dt)} s` : ""}\n       ${pad(bottom)}`;
  table.innerHTML = "<thead><tr><th scope=\"col\">quantity</th><th scope=\"col\">value</th><th scope=\"col\">standard deviation</th></tr></thead><tbody></tbody>";
  const names = [];
  const integrator = model.a[0] === 0 && model.theta.length < model.a.length + num.length + (model.constant ? 1 : 0);
  for (let i = integrator ? 1 : 0; i < model.a.length; i++) names.push(`a${i}`);
  for (let i = 0; i < num.length; i++) names.push(`b${i}`);
  if (model.theta.length > names.length) names.push("constant");
  let k = 0;
  model.theta.forEach((x, i) => fill(table.tBodies[0], k++, [names[i] || `theta ${i}`, digits(x, 6), digits(model.sigma[i], 2)]));
  const sigma = model.reading_sigma || [];
  [["gain", model.gain, sigma[0]], ["\u03c90 [rad/s]", model.omega0, sigma[1]], ["\u03be", model.damping, sigma[2]]].forEach(([name, x, s]) => { if (x !== null) fill(table.tBodies[0], k++, [name, digits(x, 6), digits(s, 2)]); });
  const p = document.createElement("p"); p.className = "note";
  p.textContent = `${answer.simulated ? `Free simulation of the second half by the model of the first: fit ${digits(answer.simulated.fit, 4)} %. ` : ""}Sampled every ${digits(answer.dt, 4)} s. ${answer.pole ? `Filter poles at ${digits(answer.pole, 4)} rad/s. ` : ""}${digits(answer.seconds, 2)} s.`;
  box.append(tf, table, p); $("found").replaceChildren(box);
  drawRecord(); snippet(); $("snippet").hidden = false;
  playground.found = answer;
}

async function compareStructures() {
  const answer = await compute((wasm, dt, f) => wasm.select_structure(dt, 3, (f.constant.checked ? 2 : 0) + (f.delay.checked ? 4 : 0)));
  if (!answer) return;
  const table = document.createElement("table");
  table.innerHTML = "<thead><tr><th scope=\"col\">structure</th><th scope=\"col\">fit of unseen parts [%]</th><th scope=\"col\"></th></tr></thead><tbody></tbody>";
  answer.candidates.forEach((c, k) => fill(table.tBodies[0], k, [`order ${c.order}${c.integrator ? ", integrates" : ""}${c.zeros ? `, ${c.zeros} zero${c.zeros > 1 ? "s" : ""}` : ""}${c.delay ? `, delay ${digits(c.delay * answer.dt)} s` : ""}`, digits(c.fit, 5), c.recommended ? "recommended" : ""]));
  $("found").replaceChildren(table);
  const best = answer.candidates.find((c) => c.recommended), form = $("problem");
  if (best) { form.order.value = best.order; form.zeros.value = best.zeros; form.integrator.checked = best.integrator; }
  playground.selected = answer;
}

function drawRecord() {
  const place = $("record-plot"), { found } = record;
  place.replaceChildren();
  if (!found || !found.simulated) return;
  const points = found.simulated.points, t = points.map((p) => p[0]);
  const measured = points.map((p) => found.y[Math.min(found.y.length - 1, Math.round(p[0] / found.dt))]);
  const plot = makePlot(place, { title: "Second half: measured, and simulated from the input alone", unit: "", height: 230, axis: true, lines: [{ name: "measured", colour: "--blue" }, { name: "simulated", colour: "--orange", dash: [7, 4] }] });
  plot.draw([t, measured, points.map((p) => p[1])], t[0], t[t.length - 1]);
}

/** The model as code. */
function snippet() {
  const { model, delay, dt } = record.found, float = (x) => { const text = String(Number(x.toPrecision(9))); return /[.e]/.test(text) ? text : `${text}.0`; };
  const n = model.a.length, b = [...model.b, ...Array(n - model.b.length).fill(0)], falling = (c) => [...c].reverse().map(float).join(" "), seconds = delay * dt;
  const code = {
    rust: `// a0.. and b0.. ascending, the leading coefficient of the denominator is one${delay ? `; the input acts ${float(delay)} samples late` : ""}.\nlet model = trendid::TransferFunction::<${n}, 1> {\n    a: [${model.a.map(float).join(", ")}],\n    b: [[${b.map(float).join(", ")}]],\n    constant: ${float(model.constant)},\n};`,
    c: `/* Ascending powers of s; the leading coefficient of the denominator is one. */\nstatic const float model_a[${n}] = { ${model.a.map((x) => float(x) + "f").join(", ")} };\nstatic const float model_b[${n}] = { ${b.map((x) => float(x) + "f").join(", ")} };\nstatic const float model_constant = ${float(model.constant)}f;\nstatic const float model_delay = ${float(seconds)}f; /* s */`,
    python: `from scipy import signal\n\nmodel = signal.TransferFunction([${falling(model.b).replaceAll(" ", ", ")}], [1.0, ${falling(model.a).replaceAll(" ", ", ")}])\ndelay = ${float(seconds)}  # s`,
    matlab: `model = tf([${falling(model.b)}], [1 ${falling(model.a)}], 'InputDelay', ${float(seconds)});`,
  }[record.language];
  $("code").textContent = code;
}

function wireRecord() {
  $("file").onchange = (event) => { if (event.target.files[0]) load(event.target.files[0]); };
  const drop = $("drop"), over = (on) => (event) => { event.preventDefault(); drop.classList.toggle("over", on); };
  drop.ondragover = over(true); drop.ondragleave = over(false);
  drop.ondrop = (event) => { over(false)(event); if (event.dataTransfer.files[0]) load(event.dataTransfer.files[0]); };
  $("problem").onsubmit = identifyRecord; $("compare").onclick = compareStructures;
  document.querySelectorAll("[data-lang]").forEach((button) => { button.onclick = () => { record.language = button.dataset.lang; document.querySelectorAll("[data-lang]").forEach((b) => b.setAttribute("aria-pressed", b === button)); snippet(); }; });
  $("copy").onclick = async () => {
    const text = $("code").textContent, button = $("copy");
    try { await navigator.clipboard.writeText(text); } catch { const range = document.createRange(); range.selectNodeContents($("code")); getSelection().removeAllRanges(); getSelection().addRange(range); document.execCommand("copy"); }
    button.textContent = "Copied"; setTimeout(() => { button.textContent = "Copy"; }, 1500);
  };
}
