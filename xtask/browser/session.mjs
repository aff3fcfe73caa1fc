// A monitor that runs, and what a user does on its page.
import { spawn } from "node:child_process";
import path from "node:path";
import { out, until } from "./common.mjs";

const { MONITOR } = process.env;
export const TOKEN = "abcdefgh12345678";
export const records = path.join(out, "records");

/** A monitor; gives its address. */
export function start(args) {
  const child = spawn(MONITOR, [...args, "--token", TOKEN, "--out", records], { stdio: ["ignore", "pipe", "inherit"] });
  child.lines = "";
  return new Promise((done, failed) => {
    child.stdout.on("data", (data) => { child.lines += data; const address = /http:\S+/.exec(child.lines); if (address) done({ child, address: address[0] }); });
    child.on("exit", (code) => failed(new Error(`the monitor has ended: ${code}`)));
  });
}
/** Waits until it has ended. */
export const ended = (child) => new Promise((done) => { if (child.exitCode !== null || child.signalCode) done(); else child.on("exit", done); });

/** Ends a monitor as its user would. */
export async function end(child) {
  child.removeAllListeners("exit");
  child.kill("SIGINT");
  await ended(child);
}

export const confirm = async (page) => { await page.waitForSelector("#confirm[open]"); await page.click("#confirm .go"); };
export const answered = (page, what, done) => until(page, `${what} is ${done ? "done" : "refused"}`, (w, d) => window.monitor.answers.some((a) => a.asked && a.asked.do === w && a.done === d), 5, what, done);
export const state = (page) => page.$eval("#state-name", (e) => e.textContent);
