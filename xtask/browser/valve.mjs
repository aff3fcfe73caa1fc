// A valve with a dead zone, as the user of the monitor identifies it: record moves, hand the dead zone of the page to `trendid identify`.
import { spawnSync } from "node:child_process";
import path from "node:path";
import { browser, check, open, sleep, until } from "./common.mjs";
import { confirm, end, records, start } from "./session.mjs";

const { TRENDID } = process.env;
const monitor = await start(["--axis", "200019", "--family", "pneumatic", "--http", "0"]);
const chrome = await browser();
try {
  const page = await open(chrome, monitor.address);
  await until(page, "samples of the valve come", () => window.monitor.samples.count > 500, 20);
  await page.click("#record");
  await page.click("#commission");
  await confirm(page);
  await until(page, "the loop controls the valve", () => ["verified", "adapting", "frozen"].includes(window.monitor.latest.state), 60);
  const travel = await page.evaluate(() => [Number(document.forms.move.target.min), Number(document.forms.move.target.max)]);
  for (const place of [0.3, 0.7, 0.45, 0.6, 0.35, 0.5]) {
    const target = Number((travel[0] + place * (travel[1] - travel[0])).toFixed(1));
    await page.$eval("#move input", (e, x) => { e.value = x; }, target);
    await page.click("#move button");
    await confirm(page);
    await until(page, `the valve moves to ${target}`, (x, near) => { const l = window.monitor.latest; return Math.abs(l.setpoint - x) < 1e-3 && Math.abs(l.position - x) < near; }, 30, target, 0.02 * (travel[1] - travel[0]));
    await sleep(2500);
  }
  const [a1, , b0, zone] = await page.evaluate(() => window.monitor.model.model);
  await page.click("#record");
  await until(page, "the record of the valve ends", () => document.getElementById("record-link"), 10);
  const file = path.join(records, await page.$eval("#record-link", (e) => e.textContent));
  const identify = (...more) => {
    const done = spawnSync(TRENDID, ["identify", file, "--order", "3", "--integrator", "--constant", "--delay", "auto", "--json", ...more], { encoding: "utf8" });
    check(`trendid identify takes the record${more.length ? ` with ${more.join(" ")}` : ""}`, done.status === 0, done.stderr.trim() || "as it is");
    const { gain, omega0 } = JSON.parse(done.stdout).physical;
    return [Math.abs(gain) / (b0 / a1), omega0 / Math.sqrt(a1)];
  };
  const plain = identify(), valve = identify("--dead-zone", zone.toFixed(4));
  const shown = ([gain, omega0]) => `gain ${gain.toFixed(3)}, frequency ${omega0.toFixed(3)} of those of the page`;
  // How near they are is held over many axes by the test `dead_zones` of the command line.
  check("the gain is nearer to that of the page with its dead zone", Math.abs(plain[0] - 1) > Math.abs(valve[0] - 1), `${shown(valve)}; without ${shown(plain)}`);
  check("no error in the console of the valve", page.errors.length === 0, page.errors.join(" | ") || "none");
  await end(monitor.child);
} finally {
  await chrome.close();
  monitor.child.removeAllListeners("exit");
  monitor.child.kill();
}
