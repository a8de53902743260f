// A headless Chromium that remembers what went wrong in a page.
import { chromium } from "playwright-core";
import { existsSync } from "node:fs";

const executablePath = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser"].find(
  (path) => path && existsSync(path),
);

/** Opens the address, calls `visit(page, faults)` and closes the browser. */
export async function withPage(address, visit) {
  const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
  try {
    const page = await browser.newPage();
    const faults = [];
    page.on("pageerror", (error) => faults.push(String(error)));
    page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
    page.on("requestfailed", (request) => faults.push(`${request.url().slice(0, 80)} failed`));
    page.on("request", (request) => {
      if (!/^(file|data):/.test(request.url())) faults.push(`asked for ${request.url()}`);
    });
    await page.goto(address);
    await visit(page, faults);
  } finally {
    await browser.close();
  }
}
