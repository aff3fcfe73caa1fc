// The playground as its user, from a file: a servo is found, the loop is broken, a record is identified.
import { spawnSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";
import { browser, check, open, out, pictures, sleep, until } from "./common.mjs";

const { CORE, TRENDID, WEB, RECORD } = process.env;
const chrome = await browser();
try {
  const page = await open(chrome, `file://${WEB}/index.html`);
  const requests = [];
  page.on("request", (request) => requests.push(request.url()));
  await until(page, "the servo runs", () => window.playground.servo && window.playground.servo.t > 8, 60);
  const servo = await page.evaluate(() => window.playground.servo);
  const truth = [400, 20, 1e6, 2500, 20, 0.5];
  servo.values.forEach((x, k) => check(`${["a1", "a2", "b0", "C", "omega0", "xi"][k]} within four of its standard deviations`, Math.abs(x - truth[k]) < 4 * servo.sigma[k] && servo.sigma[k] < 0.05 * truth[k], `${x} +- ${servo.sigma[k]}, bound ${servo.bound[k]}`));
  await until(page, "speed is measured", () => window.playground.milliseconds, 30);
  const ms = await page.evaluate(() => window.playground.milliseconds);
  // The page takes the time of the clock, in which other programs run too; here it is that of the processor.
  const core = (await WebAssembly.instantiate(fs.readFileSync(CORE), new Proxy({}, { get: () => new Proxy({}, { get: () => () => 0 }) }))).instance.exports;
  core.speed_fill(100000);
  const times = Array.from({ length: 100 }, () => { const begin = process.cpuUsage(); core.speed_run(); const { user, system } = process.cpuUsage(begin); return (user + system) / 1000; });
  check("1e5 samples within 20 ms of a processor", Math.min(...times) <= 20, `${Math.min(...times).toFixed(1)} ms, median ${times.sort((a, b) => a - b)[50].toFixed(1)} ms; in the page ${ms.toFixed(1)} ms`);
  await pictures(page, "servo");
  await page.$eval("#eta", (e) => { e.value = 3000; e.oninput(); });
  await until(page, "a slider begins again", () => window.playground.servo.t < 3, 5);

  check("the loop is not loaded before", !requests.some((url) => url.includes("loop.js")));
  await page.click("#tab-loop");
  await until(page, "the loop is there", () => window.playground.looping, 10);
  await page.click("#loop-commission");
  await until(page, "a model is verified", () => window.playground.loop && ["verified", "adapting", "frozen"].some((s) => window.playground.loop.state.startsWith(s)), 60);
  await page.click("#loop-move button");
  await until(page, "moves to 300 mm", () => Math.abs(window.playground.loop.position - 300) < 1, 30);
  const before = await page.evaluate(() => window.playground.loop.model);
  await page.click("#loop-mass");
  await page.click("#loop-osc button");
  await until(page, "three times the mass is learned", (a1) => window.playground.loop.model[0] < 0.7 * a1, 60, before[0]);
  const after = await page.evaluate(() => window.playground.loop.model);
  check("the model in control", true, `a1 ${before[0].toFixed(0)} -> ${after[0].toFixed(0)}`);
  await page.$eval("#loop-again", (e) => e.scrollIntoView());
  await pictures(page, "loop");
  await page.click("#loop-freeze");
  await until(page, "the frozen sensor is found", () => /^failed: .*(stuck|follow|jumped)/.test(window.playground.loop.state), 15);
  check("the reason", true, await page.$eval("#loop-state", (e) => e.textContent));

  await page.click("#tab-record");
  await until(page, "the part for records is there", () => window.playground.wired, 5);
  check("identify is not loaded before", !requests.some((url) => url.includes("identify")));
  await (await page.$("#file")).uploadFile(RECORD);
  await until(page, "the record is read", () => !document.getElementById("problem").hidden, 10);
  await page.click("#problem .row button");
  await until(page, "the record is identified", () => window.playground.found, 120);
  const found = await page.evaluate(() => window.playground.found);
  const reference = JSON.parse(spawnSync(TRENDID, ["identify", RECORD, "--order", "3", "--integrator", "--json"], { encoding: "utf8" }).stdout);
  fs.writeFileSync(path.join(out, "reference.json"), JSON.stringify(reference, null, 1));
  const theirs = (reference.model ?? reference).a ?? reference.estimate?.a;
  const apart = Math.max(...found.model.a.map((a, k) => Math.abs(a - theirs[k]) / Math.max(1, Math.abs(theirs[k]))));
  check("the model is that of the command line", apart < 1e-6, `largest relative difference ${apart.toExponential(1)}, ${found.seconds.toFixed(2)} s`);
  for (const [language, has] of [["rust", "TransferFunction::<3, 1>"], ["c", "static const float model_a[3]"], ["python", "signal.TransferFunction"], ["matlab", "tf(["]]) {
    await page.click(`[data-lang="${language}"]`);
    check(`a snippet in ${language}`, (await page.$eval("#code", (e) => e.textContent)).includes(has));
    fs.writeFileSync(path.join(out, `snippet.${language}`), await page.$eval("#code", (e) => e.textContent));
  }
  await page.click("#copy");
  await until(page, "it is copied", () => document.getElementById("copy").textContent === "Copied", 5);
  await pictures(page, "record");
  await page.click("#compare");
  await until(page, "structures are compared", () => window.playground.selected, 300);
  const best = await page.evaluate(() => window.playground.selected.candidates.find((c) => c.recommended));
  check("the recommended structure", best.order === 3 && best.integrator, JSON.stringify(best));
  // Times in ms and positions in pm: the same poles, and numbers in the snippet that a compiler takes for such.
  const given = fs.readFileSync(RECORD, "utf8").split("\n").filter((line) => line && !line.startsWith("#"));
  const drop = async (name, lines) => { const file = path.join(out, name); fs.writeFileSync(file, `${lines.join("\n")}\n`); await (await page.$("#file")).uploadFile(file); };
  const other = given.slice(1).map((line) => line.split(",")).map(([t, u, y]) => `${(1000 * t).toFixed(3)},${u},"${1e9 * y}"`);
  await drop("ms.csv", ["time [ms],u,y", ...other]);
  await until(page, "the unit of the times is said", () => /time \[ms\] in ms/.test(document.getElementById("file-says").textContent), 10);
  await page.evaluate(() => { window.playground.found = null; });
  await page.click("#problem .row button");
  await until(page, "the record in ms is identified", () => window.playground.found, 120);
  const scaled = await page.evaluate(() => window.playground.found);
  const off = Math.max(...scaled.model.a.map((a, k) => Math.abs(a - theirs[k]) / Math.max(1, Math.abs(theirs[k]))));
  check("the model is that of the record in s", off < 1e-4 && Math.abs(scaled.model.b[0] / 1e15 - 1) < 1e-2, `largest relative difference ${off.toExponential(1)}, b0 ${scaled.model.b[0]}`);
  for (const language of ["rust", "c"]) {
    await page.click(`[data-lang="${language}"]`);
    const code = (await page.$eval("#code", (e) => e.textContent)).replace(/\/\/.*|\/\*.*?\*\/|<[^>]*>|\[\d+\]/g, "");
    const whole = [...code.matchAll(/(?<![\w.])\d[\w.+]*/g)].map(([number]) => number).filter((number) => !/[.e]/.test(number));
    check(`each number in ${language} is one of floating point`, whole.length === 0, whole.join(" "));
  }
  // A record that is broken is named by its line and column.
  await drop("broken.csv", ["t,u,y", "0,1,2", "0.1,1"]);
  await until(page, "a broken record is named by its line", () => /line 3: 2 cells/.test(document.getElementById("file-says").textContent), 5);
  await drop("bare.csv", ["0,1,2", "0.1,1,2"]);
  await until(page, "a record without names is refused", () => /line 1: numbers where the names/.test(document.getElementById("file-says").textContent), 5);
  await drop("comma.csv", ["t;u;y", "0;0,5;1", "0.1;0,5;1"]);
  await until(page, "a record with commas is read", () => /2 samples/.test(document.getElementById("file-says").textContent), 5);
  await page.click("#problem .row button");
  await until(page, "a decimal comma is named by its cell", () => /line 2, column u: .0,5. where a number is expected, with a point/.test(document.getElementById("found").textContent), 5);
  await drop("whole.csv", ["t,u,y", "0,1,2", "1,1,2"]);
  await until(page, "whole times are taken for s, and that is said", () => /whole numbers, taken for s/.test(document.getElementById("file-says").textContent), 5);
  await sleep(200);
  check("nothing but files was asked for", requests.every((url) => url.startsWith("file:") || url.startsWith("data:")), `${requests.length} requests`);
  check("no error in the console", page.errors.length === 0, page.errors.join(" | ") || "none");
} finally {
  await chrome.close();
}
