// The firmware in the emulator, in motion and watched on a page for SECONDS: what arrives, what is lost, how often the page redraws.
import fs from "node:fs";
import path from "node:path";
import { browser, check, open, out, sleep, until } from "./common.mjs";
import { answered, confirm, ended, start } from "./session.mjs";

const seconds = Number(process.env.SECONDS);
const csv = path.join(out, "watch.csv");
fs.rmSync(csv, { force: true });
const over = process.env.RTT ? ["--rtt"] : [];
const begin = Date.now();
const left = () => seconds - (Date.now() - begin) / 1000;
const monitor = await start(["--emulator", ...over, "--image", process.env.IMAGE, "--http", "0", "--seconds", String(seconds), "--csv", csv]);
monitor.child.removeAllListeners("exit");
const chrome = await browser();
try {
  const page = await open(chrome, monitor.address);
  await until(page, "the firmware tells samples", () => window.monitor.samples.count > 500, 60);
  await page.click("#commission");
  await confirm(page);
  await until(page, "the loop controls", () => ["verified", "adapting", "frozen"].includes(window.monitor.latest.state), 120);
  await page.click("#oscillate button");
  await confirm(page);
  await answered(page, "oscillate", true);
  // By the page's own clock, so that a question that comes late counts for no second.
  const look = () => page.evaluate(() => [window.monitor.redraws, performance.now()]);
  const rates = [], heap = [];
  let [count, at] = await look();
  while (left() > 2) {
    await sleep(1000);
    const [now, then] = await look();
    rates.push(1000 * (now - count) / (then - at));
    heap.push((await page.metrics()).JSHeapUsedSize / 1e6);
    [count, at] = [now, then];
  }
  const state = await page.evaluate(() => window.monitor.latest.state);
  check("the loop still controls", ["verified", "adapting", "frozen"].includes(state), state);
  check("no error in the console", page.errors.length === 0, page.errors.join(" | ") || "none");
  await page.screenshot({ path: path.join(out, "watch.png") });
  await ended(monitor.child);
  rates.sort((a, b) => a - b);
  const share = (part) => rates[Math.min(rates.length - 1, Math.floor(part * rates.length))].toFixed(1);
  const third = Math.max(1, Math.floor(heap.length / 3)), most = (part) => Math.max(...part).toFixed(1);
  console.log(`redraws per second over ${rates.length} s: ${share(0)} at least, ${share(0.5)} median, ${share(1)} at most; 30 and more in ${(100 * rates.filter((r) => r >= 29.95).length / rates.length).toFixed(0)} %`);
  console.log(`heap of the page [MB]: at most ${most(heap.slice(0, third))} in the first third, ${most(heap.slice(-third))} in the last`);
  console.log(monitor.child.lines.trim().split("\n").slice(1).join("\n"));
  console.log(`load of the computer: ${fs.existsSync("/proc/loadavg") ? fs.readFileSync("/proc/loadavg", "utf8").split(" ").slice(0, 3).join(" ") : "unknown"}`);
  const rows = fs.readFileSync(csv, "utf8").split("\n").filter((line) => /^[0-9]/.test(line)).length;
  const received = Number(/samples (\d+)/.exec(monitor.child.lines)[1]);
  check("the record has what was received after the first words", rows <= received && received - rows < 200, `${rows} of ${received}`);
  check("nothing was missing, dropped or lost", /missing 0, dropped at the target 0,/.test(monitor.child.lines) && /frames lost on the line 0, damaged 0,/.test(monitor.child.lines));
} finally {
  await chrome.close();
  monitor.child.kill();
}
