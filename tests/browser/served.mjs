// The program itself, serving a volume to a browser: for tests of page and program together.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before } from "node:test";
import { launch, openPage } from "./page.mjs";
import { final } from "./visit.mjs";

export const chiaro = join(process.env.CHIARO_BIN ?? "", "chiaro");
export const token = "0123456789abcdef0123456789abcdef";
const there = (() => {
  try {
    return execFileSync(chiaro, ["view", "--help"], { encoding: "utf8" }).includes("--no-open");
  } catch {
    return false;
  }
})();
export const skip = there ? false : "no chiaro view";

/** What a test that failed left running: the file of tests would wait for it for ever. */
const running = new Set();
after(() => running.forEach((child) => child.kill("SIGKILL")));

/** Starts the program in a folder and answers its address and how to end it. */
export async function serve(folder, volume = "sample:cornell:48", port = 0, more = []) {
  const child = spawn(chiaro, ["view", ...(volume ? [volume] : []), "--port", String(port), "--no-open", "--quiet", ...more], { cwd: folder, env: { ...process.env, CHIARO_VIEW_TOKEN: token, XDG_CACHE_HOME: folder } });
  running.add(child);
  child.once("exit", () => running.delete(child));
  const url = await new Promise((done, fail) => {
    child.stdout.once("data", (text) => done(String(text).split("\n")[0]));
    child.once("exit", (code) => fail(new Error(`chiaro view ended with ${code}`)));
  });
  const end = (signal = "SIGKILL") => new Promise((done) => (running.has(child) ? (child.once("exit", done), child.kill(signal)) : done()));
  return { url, port: Number(new URL(url).port), end };
}

export const options = { viewport: { width: 900, height: 560 }, colorScheme: "dark", acceptDownloads: true };

/** A browser and a folder for a file of tests: visit(act, {url, allowed faults, options of the page}). */
export function servedVisits(volume) {
  const folder = mkdtempSync(join(tmpdir(), "chiaro-test-")), all = { folder, server: null, browser: null, visit };
  before(async () => {
    if (skip) return;
    all.browser = await launch();
    all.server = await serve(folder, volume);
  });
  after(async () => {
    if (skip) return;
    await all.browser.close();
    await all.server.end("SIGINT");
    rmSync(folder, { recursive: true, force: true });
  });
  async function visit(act, { url = all.server.url, allowed = /$^/, page: own = options } = {}) {
    const { page, faults } = await openPage(all.browser, url, own);
    try {
      await final(page);
      await act(page);
      assert.deepEqual(faults.filter((fault) => !allowed.test(fault)), []);
    } finally {
      await page.close();
    }
  }
  return all;
}
