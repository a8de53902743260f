// A headless browser that remembers what went wrong in a page.
import playwright from "playwright-core";
import { existsSync } from "node:fs";

const executablePath = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser"].find(
  (path) => path && existsSync(path),
);

/** How long is waited for what must come, in milliseconds: only what hangs takes as long, however busy the machine. */
export const patience = 180000;

/** Chromium; or Firefox over WebDriver BiDi, where CHIARO_FIREFOX names the program. Pages wait with patience. */
export const firefox = process.env.CHIARO_FIREFOX;
export async function launch() {
  const browser = firefox ? await playwright._bidiFirefox.launch({ executablePath: firefox, timeout: patience }) : await playwright.chromium.launch({ executablePath, args: ["--no-sandbox"], timeout: patience });
  for (const name of ["newPage", "newContext"]) {
    const make = browser[name].bind(browser);
    browser[name] = async (...given) => {
      const made = await make(...given);
      made.setDefaultTimeout(patience);
      return made;
    };
  }
  return browser;
}

/** Waits for the frame in which the page shows what was done to it. */
export const drawn = (page) =>
  page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))).catch(() => {});

/** What a test does to the page ends when the page has drawn it: a loaded machine draws late. */
function endWithAFrame(page) {
  for (const [owner, name] of [[page, "click"], [page.keyboard, "press"], [page.mouse, "up"], [page.mouse, "click"], [page.mouse, "dblclick"]]) {
    const act = owner[name].bind(owner);
    owner[name] = async (...given) => {
      await act(...given);
      await drawn(page);
    };
  }
}

/** Tests that trust the machine's speed fail when each frame comes CHIARO_LATE_FRAMES milliseconds late. */
async function drawLate(page, late = Number(process.env.CHIARO_LATE_FRAMES ?? 0)) {
  if (late)
    await page.addInitScript((ms) => {
      const next = window.requestAnimationFrame.bind(window);
      window.requestAnimationFrame = (draw) => setTimeout(next, ms, draw);
    }, late);
}

/** A page at the address that gathers its faults; it may ask for files and data, and for what its own server has. */
export async function openPage(browser, address, options = {}) {
  const page = await browser.newPage(options);
  const faults = [];
  const own = new URL(address).host;
  page.on("pageerror", (error) => faults.push(String(error.stack ?? error)));
  page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
  page.on("requestfailed", (request) => faults.push(`${request.url().slice(0, 80)} failed`));
  page.on("request", (request) => {
    const url = new URL(request.url());
    if (!/^(file|data|blob):/.test(url.protocol) && !(own && url.host === own)) faults.push(`asked for ${url}`);
  });
  await drawLate(page);
  await page.goto(address);
  endWithAFrame(page);
  return { page, faults };
}

/** Opens the address, calls `visit(page, faults)` and closes the browser. */
export async function withPage(address, visit) {
  const browser = await launch();
  try {
    const { page, faults } = await openPage(browser, address);
    await visit(page, faults);
  } finally {
    await browser.close();
  }
}
