// The monitor as its user: commission, watch, move, record, identify the record, break the sensor, lose the source.
import { spawnSync } from "node:child_process";
import fs from "node:fs";
import http from "node:http";
import path from "node:path";
import { browser, check, open, out, pictures, sleep, until } from "./common.mjs";
import { TOKEN, answered, confirm, end, records, start, state } from "./session.mjs";

const { TRENDID, SEED } = process.env;

/** Status of a request with these headers. */
const status = (address, where, headers = {}) => new Promise((done, failed) => {
  const { hostname, port } = new URL(address);
  const request = http.request({ hostname, port, path: where, headers }, (answer) => { answer.resume(); done(answer.statusCode); });
  request.on("upgrade", (answer, socket) => { socket.destroy(); done(answer.statusCode); });
  request.on("error", failed);
  request.end();
});

fs.rmSync(records, { recursive: true, force: true });
const axis = ["--axis", SEED, "--family", "ball-screw"];
const monitor = await start([...axis, "--http", "0"]);
const chrome = await browser();
try {
  const socket = { connection: "Upgrade", upgrade: "websocket", "sec-websocket-version": "13", "sec-websocket-key": "AAAAAAAAAAAAAAAAAAAAAA==" };
  const own = new URL(monitor.address).origin;
  check("a page without the token", (await status(monitor.address, "/")) === 403, 403);
  check("a socket of another page", (await status(monitor.address, `/ws?token=${TOKEN}`, { ...socket, origin: "http://evil.example" })) === 403, 403);
  check("a socket without the token", (await status(monitor.address, "/ws?token=abcdefgh12345679", { ...socket, origin: own })) === 403, 403);
  check("a socket of its own page", (await status(monitor.address, `/ws?token=${TOKEN}`, { ...socket, origin: own })) === 101, 101);
  check("a name that is pointed here", (await status(monitor.address, "/app.js", { host: "evil.example:80" })) === 403, 403);

  const page = await open(chrome, monitor.address);
  await until(page, "samples come", () => window.monitor.samples.count > 500, 10);
  check("nothing moves by itself", (await state(page)) === "idle", await state(page));
  await page.click("#move button");
  await confirm(page);
  await answered(page, "move", false);
  check("why", /commission it first/.test(await page.$eval("#answer", (e) => e.textContent)), await page.$eval("#answer", (e) => e.textContent));
  await page.click("#commission");
  await page.waitForSelector("#confirm[open]");
  await page.click("#confirm button[value=no]");
  await sleep(300);
  check("not confirmed, not asked", !(await page.evaluate(() => window.monitor.answers.some((a) => a.asked.do === "commission"))));
  await page.click("#record");
  await page.click("#commission");
  await confirm(page);
  await until(page, "a model is verified", () => window.monitor.events.some((e) => e.includes("verified")), 30);
  await until(page, "the loop controls", () => ["verified", "adapting", "frozen"].includes(window.monitor.latest.state), 10);
  await sleep(1000);
  const travel = await page.evaluate(() => [Number(document.forms.move.target.min), Number(document.forms.move.target.max)]);
  for (const place of [0.3, 0.7, 0.45]) {
    const target = Number((travel[0] + place * (travel[1] - travel[0])).toFixed(1));
    await page.$eval("#move input", (e, x) => { e.value = x; }, target);
    await page.click("#move button");
    await confirm(page);
    await until(page, `moves to ${target}`, (x, near) => { const l = window.monitor.latest; return Math.abs(l.setpoint - x) < 1e-3 && Math.abs(l.position - x) < near; }, 20, target, 0.005 * (travel[1] - travel[0]));
  }
  const rates = [];
  for (let k = 0; k < 4; k++) { const before = await page.evaluate(() => window.monitor.redraws); await sleep(1000); rates.push((await page.evaluate(() => window.monitor.redraws)) - before); }
  check("redraws per second", Math.max(...rates) > 0, rates.join(" "));
  await page.click("#record");
  await until(page, "the record ends", () => document.getElementById("record-link"), 5);
  await pictures(page, "monitor");

  // The record is what the page shows, digit by digit.
  const name = await page.$eval("#record-link", (e) => e.textContent);
  const text = fs.readFileSync(path.join(records, name), "utf8").trim().split("\n").filter((line) => !line.startsWith("#")).slice(1);
  const shown = await page.evaluate(() => { const { column: c, count } = window.monitor.samples; const rows = []; for (let i = 0; i < count; i++) rows.push([c.t[i], c.u[i], c.y[i], c.r[i], c.v[i]]); return rows; });
  const byTick = new Map(shown.map((row) => [Math.round(row[0] * 1000), row]));
  let compared = 0, different = 0;
  for (const line of text) {
    const [, u, y, r, v, , , , tick] = line.split(",").map(Number);
    const row = byTick.get(tick);
    if (!row) continue;
    compared++;
    if (row[1] !== u || row[2] !== y || row[3] !== r || row[4] !== v) different++;
  }
  check("the numbers of the page are those of the record", compared > 1000 && different === 0, `${compared} samples compared, ${different} differ, record of ${text.length}`);
  const model = await page.evaluate(() => window.monitor.model);
  const identified = spawnSync(TRENDID, ["identify", path.join(records, name), "--order", "3", "--integrator", "--constant", "--delay", "auto", "--json"], { encoding: "utf8" });
  check("trendid identify takes the record", identified.status === 0, identified.stderr.trim() || "as it is");
  const found = JSON.parse(identified.stdout);
  fs.writeFileSync(path.join(out, "identified.json"), identified.stdout);
  const [a1, , b0] = model.model;
  const theirs = found.model ?? found;
  const gain = Math.abs(theirs.physical?.gain ?? theirs.reading?.gain ?? NaN), omega0 = theirs.physical?.omega0 ?? theirs.reading?.omega0 ?? NaN;
  console.log(`     in control C ${(b0 / a1).toFixed(3)}, w0 ${Math.sqrt(a1).toFixed(3)}; identified C ${gain}, w0 ${omega0}`);
  check("the velocity gain of the record is that of the page", Math.abs(gain / (b0 / a1) - 1) < 0.1, `${gain.toFixed(2)} and ${(b0 / a1).toFixed(2)}`);
  check("its natural frequency is that of the page", Math.abs(omega0 / Math.sqrt(a1) - 1) < 0.15, `${omega0.toFixed(2)} and ${Math.sqrt(a1).toFixed(2)}`);

  // Settings: refused out of bounds, taken at rest.
  await page.evaluate(() => document.querySelectorAll("details").forEach((d) => { d.open = true; }));
  await page.evaluate(() => { const i = document.getElementById("set-memory"); i.removeAttribute("max"); i.value = "5000"; i.form.requestSubmit(); });
  await until(page, "a memory of 5000 s is refused with its bounds", () => /memory = 5000 is not within 0.05..=1000/.test(document.getElementById("answer").textContent), 5);
  await page.evaluate(() => { const i = document.getElementById("set-memory"); i.value = "2"; i.form.requestSubmit(); });
  await until(page, "a memory of 2 s is taken", () => window.monitor.answers.some((a) => a.asked.do === "set" && a.asked.value === 2 && a.done), 5);
  await sleep(1500);
  check("the loop goes on with it", ["adapting", "frozen", "verified"].includes(await state(page)), await state(page));
  await page.evaluate(() => document.querySelectorAll("details").forEach((d) => { d.open = false; }));

  // A second page watches, may stop, and takes the control.
  const other = await open(chrome, monitor.address);
  await until(other, "the second page watches", () => window.monitor.samples.count > 500, 10);
  check("and has no buttons", await other.$eval("#commission", (e) => e.disabled));
  await other.evaluate(() => ask({ do: "move", target: 1 }));
  await until(other, "what it asks is refused", () => window.monitor.answers.some((a) => !a.done && /another page/.test(a.why)), 5);
  await other.click("#take");
  await until(other, "it takes the control", () => !document.getElementById("commission").disabled, 5);
  await until(page, "the first page loses it", () => document.getElementById("commission").disabled, 5);
  check("no error in the console of the second page", other.errors.length === 0, other.errors.join(" | "));
  await other.close();
  await page.click("#take");
  await until(page, "the first page takes it back", () => !document.getElementById("commission").disabled, 5);

  // The sensor freezes in motion.
  await page.click("#oscillate button");
  await confirm(page);
  await answered(page, "oscillate", true);
  await sleep(1500);
  await page.click('[data-trick="freeze"]');
  await until(page, "the loop fails and says why", () => document.getElementById("state-name").textContent === "failed" && /stuck|does not follow|jumped/.test(document.getElementById("state-why").textContent), 15);
  check("the reason", true, await page.$eval("#state-why", (e) => e.textContent));
  await page.screenshot({ path: path.join(out, "monitor-failed.png") });
  await page.click('[data-trick="heal"]');
  await page.click("#commission");
  await confirm(page);
  await until(page, "healed, it controls again", () => ["verified", "adapting", "frozen"].includes(window.monitor.latest.state), 30);
  await page.keyboard.press("Escape");
  await until(page, "Escape stops it", () => document.getElementById("state-name").textContent === "idle" && /stop: done/.test(document.getElementById("answer").textContent), 5);

  // By keyboard alone: from the page to a plot range, and to a confirmation.
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("+");
  check("the plots are zoomed by keys", !(await page.$eval("#reset", (e) => e.disabled)));
  await page.focus("#commission");
  await page.keyboard.press("Enter");
  await page.waitForSelector("#confirm[open]");
  check("a confirmation begins on Cancel", (await page.evaluate(() => document.activeElement.value)) === "no");
  await page.keyboard.press("Escape");
  check("the report", (await status(monitor.address, `/report?token=${TOKEN}`)) === 200, 200);
  const report = await open(chrome, `${own}/report?token=${TOKEN}`);
  check("its pictures", (await report.$$("svg polyline")).length === 4);
  await report.screenshot({ path: path.join(out, "report.png") });
  check("no error in the console of the report", report.errors.length === 0, report.errors.join(" | "));
  await report.close();
  check("no error in the console", page.errors.length === 0, page.errors.join(" | ") || "none");

  // The source ends and comes again.
  const { port } = new URL(monitor.address);
  await end(monitor.child);
  console.log(monitor.child.lines.trim().split("\n").slice(1).map((line) => `     ${line}`).join("\n"));
  check("the line lost nothing", /missing 0, dropped at the target 0/.test(monitor.child.lines) && /frames lost on the line 0, damaged 0/.test(monitor.child.lines));
  await until(page, "the page says that the monitor is gone", () => /does not answer/.test(document.getElementById("source").textContent), 5);
  const again = await start([...axis, "--http", port]);
  await until(page, "the page comes back by itself", () => /simulated/.test(document.getElementById("source").textContent) && window.monitor.latest && window.monitor.latest.state === "idle", 15);
  check("nothing moves by itself after it", (await state(page)) === "idle");
  await end(again.child);
} finally {
  await chrome.close();
  monitor.child.removeAllListeners("exit");
  monitor.child.kill();
}
