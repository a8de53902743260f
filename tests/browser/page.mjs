// A headless Chromium that remembers what went wrong in a page.
import { chromium } from "playwright-core";
import { existsSync } from "node:fs";

const executablePath = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser"].find(
  (path) => path && existsSync(path),
);

export const launch = () => chromium.launch({ executablePath, args: ["--no-sandbox"] });

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
  await page.goto(address);
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
