// What both pages need: a browser, checks with names, screenshots, axe.
import fs from "node:fs";
import path from "node:path";
import puppeteer from "puppeteer-core";

export const out = process.env.OUT;
const axe = fs.readFileSync(process.env.AXE, "utf8");
export const results = [];

/** A check; the first that fails ends the run. */
export function check(name, holds, seen) {
  const line = `${holds ? "ok  " : "FAIL"} ${name}${seen === undefined ? "" : `: ${seen}`}`;
  console.log(line);
  results.push(line);
  if (!holds) throw new Error(line);
}

export const sleep = (ms) => new Promise((done) => setTimeout(done, ms));

export async function browser() {
  return puppeteer.launch({
    executablePath: process.env.CHROMIUM, headless: true,
    args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--allow-file-access-from-files=false"],
  });
}

/** A page whose errors are kept. */
export async function open(chrome, address) {
  const page = await chrome.newPage();
  page.errors = [];
  page.on("console", (message) => { if (message.type() === "error") page.errors.push(message.text()); });
  page.on("pageerror", (error) => page.errors.push(String(error)));
  await page.setViewport({ width: 1280, height: 900 });
  await page.goto(address, { waitUntil: "load" });
  return page;
}

/** Waits until `f` is true in the page. */
export async function until(page, name, f, seconds, ...args) {
  const begin = Date.now();
  try { await page.waitForFunction(f, { timeout: 1000 * seconds, polling: 100 }, ...args); } catch (error) {
    await page.screenshot({ path: path.join(out, "failed.png"), fullPage: true });
    check(name, false, `not within ${seconds} s (${error.message})`);
  }
  check(name, true, `${((Date.now() - begin) / 1000).toFixed(1)} s`);
}

/** Accessibility by axe: no violation. */
export async function accessible(page, name) {
  // By the protocol, since the page's policy allows no foreign script.
  await page.evaluate(axe);
  const found = await page.evaluate(async () => {
    const { violations, passes } = await window.axe.run(document, { resultTypes: ["violations"] });
    return { passes: passes.length, violations: violations.map((v) => `${v.id} (${v.impact}): ${v.nodes.slice(0, 3).map((n) => n.target.join(" ")).join("; ")}`) };
  });
  check(`axe, ${name}`, found.violations.length === 0, found.violations.join(" | ") || `no violation, ${found.passes} rules pass`);
}

/** Pictures at both widths and in both themes, with axe in each. */
export async function pictures(page, name) {
  for (const theme of ["light", "dark"]) {
    for (const width of [1280, 400]) {
      await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: theme }]);
      await page.setViewport({ width, height: width === 400 ? 850 : 900 });
      await page.evaluate(() => { scrollTo(0, 0); document.activeElement.blur(); });
      await page.mouse.move(5, 400);
      await sleep(1200);
      await page.screenshot({ path: path.join(out, `${name}-${width}-${theme}.png`), fullPage: width === 1280 });
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
      check(`${name} fits ${width} pixels, ${theme}`, wide <= 0, `${wide} px beyond`);
      await accessible(page, `${name} ${width} ${theme}`);
    }
  }
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "light" }]);
  await page.setViewport({ width: 1280, height: 900 });
  await sleep(400);
}
