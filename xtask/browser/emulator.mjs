// The firmware in the emulator, as its user watches it: commission, move, freeze the sensor, acknowledge, kill the emulator.
import fs from "node:fs";
import path from "node:path";
import { accessible, browser, check, open, out, sleep, until } from "./common.mjs";
import { answered, confirm, end, start, state } from "./session.mjs";

/** The emulator of a monitor. */
function emulator(monitor) {
  const children = fs.readFileSync(`/proc/${monitor.pid}/task/${monitor.pid}/children`, "utf8").trim().split(" ")
    .concat(fs.readdirSync(`/proc/${monitor.pid}/task`).flatMap((task) => fs.readFileSync(`/proc/${monitor.pid}/task/${task}/children`, "utf8").trim().split(" ")))
    .filter(Boolean).map(Number);
  return children.find((pid) => fs.readFileSync(`/proc/${pid}/comm`, "utf8").startsWith("qemu-system"));
}

const controls = () => ["verified", "adapting", "frozen"].includes(window.monitor.latest.state);
const monitor = await start(["--emulator", "--image", process.env.IMAGE, "--http", "0"]);
const chrome = await browser();
try {
  const page = await open(chrome, monitor.address);
  await until(page, "the firmware tells samples", () => window.monitor.samples.count > 500, 60);
  check("the page says what it is", /in QEMU/.test(await page.$eval("#source", (e) => e.textContent)), await page.$eval("#source", (e) => e.textContent));
  check("nothing moves by itself", (await state(page)) === "idle", await state(page));
  await page.click("#move button");
  await confirm(page);
  await answered(page, "move", false);
  check("why", /commission it first/.test(await page.$eval("#answer", (e) => e.textContent)), await page.$eval("#answer", (e) => e.textContent));
  // Settings are refused with their bounds by the target, and taken while it rests.
  await page.evaluate(() => document.querySelectorAll("details").forEach((d) => { d.open = true; }));
  await page.evaluate(() => { const i = document.getElementById("set-memory"); i.removeAttribute("max"); i.value = "5000"; i.form.requestSubmit(); });
  await until(page, "a memory of 5000 s is refused with its bounds", () => /memory = 5000 is not within 0.05..=1000/.test(document.getElementById("answer").textContent), 20);
  const memory = await page.evaluate(() => { const i = document.getElementById("set-memory"), value = Number((2 * settings.find((s) => s.name === "memory").value).toFixed(3)); i.value = value; i.form.requestSubmit(); return value; });
  await until(page, `a memory of ${memory} s is taken`, (x) => window.monitor.answers.some((a) => a.asked.do === "set" && a.asked.value === x && a.done), 20, memory);
  await page.evaluate(() => document.querySelectorAll("details").forEach((d) => { d.open = false; }));
  await page.click("#store");
  await answered(page, "store", false);
  check("the emulator has no flash", /cannot do that/.test(await page.$eval("#answer", (e) => e.textContent)));

  await page.click("#commission");
  await confirm(page);
  await until(page, "a model is verified", () => window.monitor.events.some((e) => e.includes("verified")), 120);
  await until(page, "the loop controls", controls, 20);
  for (const target of [120, 280, 200]) {
    await page.$eval("#move input", (e, x) => { e.value = x; }, target);
    await page.click("#move button");
    await confirm(page);
    await until(page, `moves to ${target}`, (x) => { const l = window.monitor.latest; return Math.abs(l.setpoint - x) < 1e-3 && Math.abs(l.position - x) < 1; }, 120, target);
  }
  await until(page, "the margins of the controller are shown", () => window.monitor.model.margins && /phase margin/.test(document.getElementById("model-facts").textContent), 20);
  const model = await page.evaluate(() => window.monitor.model);
  const [a1, a2, b0] = model.model;
  check("the model is that of the drive", Math.abs(a1 / 400 - 1) < 0.1 && Math.abs(a2 / 20 - 1) < 0.25 && Math.abs(b0 / 1e6 - 1) < 0.1, `a1 ${a1}, a2 ${a2}, b0 ${b0}, margins ${model.margins}`);
  await page.evaluate(() => scrollTo(0, 0));
  await sleep(500);
  await page.screenshot({ path: path.join(out, "emulator.png"), fullPage: true });
  await accessible(page, "emulator");

  await page.click("#oscillate button");
  await confirm(page);
  await answered(page, "oscillate", true);
  await sleep(1500);
  await page.click('[data-trick="freeze"]');
  await until(page, "the loop fails and says why", () => document.getElementById("state-name").textContent === "failed" && /stuck|does not follow|jumped/.test(document.getElementById("state-why").textContent), 60);
  check("the reason", true, await page.$eval("#state-why", (e) => e.textContent));
  await until(page, "the fault is latched", () => window.monitor.events.some((e) => e.includes("fault:")), 20);
  await page.screenshot({ path: path.join(out, "emulator-failed.png") });
  await page.click("#commission");
  await confirm(page);
  await answered(page, "commission", false);
  check("nothing moves before it is acknowledged", /acknowledge it first/.test(await page.$eval("#answer", (e) => e.textContent)));
  const losses = await page.evaluate(() => ["missing", "dropped", "lost"].map((id) => document.getElementById(id).textContent).join(" "));
  check("nothing was missing, dropped or lost", losses === "0 0 0", losses);
  await page.click("#acknowledge");
  await answered(page, "acknowledge", true);
  await until(page, "it begins again", () => window.monitor.events[window.monitor.events.length - 1].includes("start 2") || window.monitor.events.some((e) => e.includes("start 2")), 20);
  await until(page, "and rests", () => window.monitor.latest && window.monitor.latest.state === "idle", 20);
  await page.click("#commission");
  await confirm(page);
  await until(page, "it controls again", controls, 120);

  process.kill(emulator(monitor.child), "SIGKILL");
  await until(page, "the page says that the line is lost", () => document.getElementById("state-name").textContent === "no line", 20);
  await until(page, "the emulator comes again", () => /in QEMU/.test(document.getElementById("source").textContent) && window.monitor.latest && window.monitor.latest.state === "idle", 60);
  await sleep(1000);
  check("nothing moves by itself after it", (await state(page)) === "idle" && (await page.evaluate(() => window.monitor.latest.command)) === 0);
  check("no error in the console", page.errors.length === 0, page.errors.join(" | ") || "none");
  await end(monitor.child);
  console.log(monitor.child.lines.trim().split("\n").slice(1).map((line) => `     ${line}`).join("\n"));
  // The restart may have cut the frame that was on its way.
  check("nor was it over the restart, but for a frame that was cut", /missing 0, dropped at the target 0/.test(monitor.child.lines) && /frames lost on the line 0, damaged [01],/.test(monitor.child.lines));
} finally {
  await chrome.close();
  monitor.child.removeAllListeners("exit");
  monitor.child.kill();
}
