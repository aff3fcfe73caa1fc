"use strict";
// Samples in bounded buffers, and plots over the number of the sample (not over the clock of this computer).

/** The newest samples, column by column; at most `most` are kept. */
class Samples {
  constructor(most) {
    this.most = most;
    this.names = ["t", "y", "r", "v", "vr", "u", "e", "s", "why"];
    this.column = {};
    for (const name of this.names) this.column[name] = new Float64Array(2 * most);
    this.count = 0;
  }
  clear() { this.count = 0; }
  push(row, dt) {
    if (this.count === 2 * this.most) {
      for (const name of this.names) this.column[name].copyWithin(0, this.most);
      this.count = this.most;
    }
    const c = this.column, i = this.count++;
    c.t[i] = row[0] * dt; c.y[i] = row[1] ?? NaN; c.r[i] = row[2] ?? NaN; c.v[i] = row[3] ?? NaN; c.vr[i] = row[4] ?? NaN;
    c.u[i] = row[5] ?? NaN; c.e[i] = row[6] ?? NaN; c.s[i] = row[7]; c.why[i] = row[8];
  }
  /** Place of the first sample at or after `t`. */
  at(t) {
    let low = 0, high = this.count;
    while (low < high) { const mid = (low + high) >> 1; if (this.column.t[mid] < t) low = mid + 1; else high = mid; }
    return low;
  }
  get last() { return this.count ? this.column.t[this.count - 1] : 0; }
  get first() { return this.count ? this.column.t[0] : 0; }
}

/** Pixels of a column of which a plot draws the extremes: without a graphics processor longer paths cost redraws. */
const COLUMN = 3;

/** Columns for a plot: every sample while there is room, else the extremes of each column; null where samples are missing. */
function extremes(samples, from, to, width, dt, signals) {
  const begin = Math.max(0, samples.at(from) - 1), end = Math.min(samples.count, samples.at(to) + 1);
  const part = Math.max(1, Math.ceil((end - begin) / Math.max(100, width)));
  const t = samples.column.t, out = [[], ...signals.map(() => [])];
  for (let i = begin; i < end; i += part) {
    const stop = Math.min(end, i + part);
    if (i > begin && t[i] - t[i - 1] > 1.5 * dt) {
      out[0].push(t[i] - 0.5 * dt);
      signals.forEach((_, k) => out[k + 1].push(null));
    }
    if (stop - i === 1) {
      out[0].push(t[i]);
      signals.forEach((f, k) => { const x = f(i); out[k + 1].push(Number.isNaN(x) ? null : x); });
      continue;
    }
    out[0].push(t[i], t[stop - 1]);
    signals.forEach((f, k) => {
      let low = Infinity, high = -Infinity, lowAt = i, highAt = i;
      for (let j = i; j < stop; j++) { const x = f(j); if (x < low) { low = x; lowAt = j; } if (x > high) { high = x; highAt = j; } }
      // In the order in which they came: what falls is no saw.
      if (low > high) out[k + 1].push(null, null); else if (lowAt > highAt) out[k + 1].push(high, low); else out[k + 1].push(low, high);
    });
  }
  return out;
}

/** Colours of the style sheet, read once for each theme: a question to the style settles the whole page. */
let colours = {};
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { colours = {}; });
function colour(name) { return colours[name] ||= getComputedStyle(document.documentElement).getPropertyValue(name).trim(); }

/** A range that is never empty, and not smaller than `least`: noise shall look like noise. */
function roomy(least) {
  return (_, low, high) => {
    if (low === null || high === null || !Number.isFinite(low) || !Number.isFinite(high)) return [-1, 1];
    const span = high - low, pad = Math.max(0.08 * span, 0.5 * (least() - span));
    return pad > 0 ? [low - pad, high + pad] : [low - Math.max(1e-6, 0.05 * Math.abs(low)), high + Math.max(1e-6, 0.05 * Math.abs(high))];
  };
}

/** Short digits for an axis or a reading. */
function digits(x, places = 5) {
  if (x === null || x === undefined || Number.isNaN(x)) return "\u2013";
  if (!Number.isFinite(x)) return "unknown";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size >= 1e6 || size < 1e-4) return x.toExponential(Math.max(0, places - 2));
  return String(Number(x.toPrecision(places)));
}

/** Texts of ticks, with the digits that tell them apart. */
function ticks(values) {
  const known = values.filter((x) => x !== null);
  if (known.length < 2) return values.map((x) => digits(x));
  const step = Math.abs(known[1] - known[0]), most = Math.max(...known.map(Math.abs));
  if (most >= 1e5 || most < 1e-3) {
    const places = Math.max(0, Math.ceil(Math.log10(most / step) - 1e-9));
    return values.map((x) => x === null ? "" : x === 0 ? "0" : x.toExponential(Math.min(8, places)).replace("e+", "e"));
  }
  const places = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9) + (String(Number((step / 10 ** Math.floor(Math.log10(step))).toFixed(6))).includes(".") ? 1 : 0));
  return values.map((x) => x === null ? "" : x.toFixed(Math.min(8, places)));
}

/** A plot with its caption; lines: {name, colour, dash, step}. */
function makePlot(place, { title, unit, lines, height, band, axis, least, onRange, onCursor, sync }) {
  const figure = document.createElement("figure"), caption = document.createElement("figcaption");
  const heading = document.createElement("b");
  caption.append(heading);
  for (const line of lines) {
    if (!line.name) continue;
    const i = document.createElement("i");
    i.innerHTML = `<svg aria-hidden="true" viewBox="0 0 22 8"><line x1="0" y1="4" x2="22" y2="4" stroke="var(${line.colour})" stroke-width="2.5" stroke-dasharray="${line.dash ? line.dash.join(" ") : "none"}"/></svg>`;
    i.append(line.name);
    caption.append(i);
  }
  const name = (u) => { heading.textContent = u ? `${title} [${u}]` : title; };
  name(unit);
  const box = document.createElement("div");
  figure.append(caption, box);
  place.append(figure);
  const soft = colour("--soft"), grid = colour("--grid");
  const options = {
    width: Math.max(120, box.clientWidth || place.clientWidth), height,
    legend: { show: false }, padding: [6, 8, axis ? 0 : 4, 0],
    cursor: { drag: { x: true, y: false, setScale: false }, sync: sync ? { key: sync } : undefined, points: { size: 6 } },
    scales: { x: { time: false }, y: { range: roomy(least || (() => 0)) } },
    axes: [
      { show: axis, stroke: soft, grid: { stroke: grid, width: 1 }, ticks: { stroke: grid }, size: 26, font: "12px system-ui", values: (_, v) => ticks(v) },
      { stroke: soft, grid: { stroke: grid, width: 1 }, ticks: { show: false }, size: 64, font: "12px system-ui", values: (_, v) => ticks(v) },
    ],
    series: [{}, ...lines.map((line) => ({
      stroke: line.hidden ? "transparent" : colour(line.colour), width: line.width || 1.5, dash: line.dash, spanGaps: false, points: { show: false },
      paths: line.step ? uPlot.paths.stepped({ align: 1 }) : uPlot.paths.linear(),
    }))],
    bands: band ? [{ series: band, fill: colour("--band") }] : undefined,
    hooks: {
      setSelect: [(u) => { if (onRange && u.select.width > 4) { onRange(u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x")); u.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false); } }],
      setCursor: [(u) => { if (onCursor) onCursor(u.cursor.left >= 0 ? u.posToVal(u.cursor.left, "x") : null); }],
    },
  };
  const plot = new uPlot(options, [[], ...lines.map(() => [])], box);
  plot.root.setAttribute("role", "img");
  plot.root.setAttribute("aria-label", title);
  return { plot, figure, box, name, height, draw(data, from, to) { plot.batch(() => { plot.setData(data, false); plot.setScale("x", { min: from, max: to }); }); } };
}

/** What a state looks like. */
const LOOKS = { 0: "idle", 1: "moving", 2: "moving", 3: "good", 4: "good", 5: "still", 6: "bad", 7: "bad" };

/** States over time: colour, and words where there is room. */
function drawTimeline(canvas, samples, from, to, names, left) {
  const ratio = devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio); canvas.height = Math.round(height * ratio);
  }
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  const fills = { idle: colour("--grey"), moving: colour("--orange"), good: colour("--green"), still: colour("--blue"), bad: colour("--red") };
  const x = (t) => left + (t - from) / (to - from) * (width - left - 8);
  pen.font = "12px system-ui"; pen.textBaseline = "middle";
  pen.fillStyle = colour("--soft"); pen.fillText("state", 4, height / 2);
  const { t, s } = samples.column;
  let i = samples.at(from);
  const end = samples.at(to);
  while (i < end) {
    const state = s[i], begin = i;
    while (i < end && s[i] === state) i++;
    const a = Math.max(left, x(t[begin])), b = Math.max(a + 1, x(t[Math.min(i, end - 1)]));
    const look = LOOKS[state] || "idle";
    pen.fillStyle = fills[look];
    if (look === "idle") pen.fillRect(a, height - 5, b - a, 3); else if (look === "bad") { pen.fillRect(a, 0, b - a, 2); pen.fillRect(a, height - 7, b - a, 5); } else pen.fillRect(a, height - 7, b - a, 5);
    const words = names[state] || String(state);
    if (pen.measureText(words).width + 8 < b - a) { pen.fillStyle = colour("--ink"); pen.fillText(words, a + 4, height / 2 - 3); }
  }
}
