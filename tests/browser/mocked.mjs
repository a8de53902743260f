// Tests of the page on a mock of its server: a page and a mock for each; faults of the page fail the test.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Mock } from "./mock.mjs";
import { launch, openPage } from "./page.mjs";
import { final } from "./visit.mjs";

export const desktop = { viewport: { width: 1440, height: 900 }, colorScheme: "dark" };
export const phone = { viewport: { width: 390, height: 844 }, hasTouch: true };

/** visit(name, (page, mock) => ..., {options of the page, prepare(mock), allowed faults, ready: wait for the picture}). */
export function visits() {
  let browser;
  before(async () => (browser = await launch()));
  after(() => browser.close());
  return (name, act, { options = desktop, prepare = () => {}, allowed = /$^/, ready = true } = {}) =>
    test(name, async () => {
      const mock = await new Mock().start();
      prepare(mock);
      const { page, faults } = await openPage(browser, mock.address, options);
      try {
        if (ready) await final(page);
        await act(page, mock);
        assert.deepEqual(faults.filter((fault) => !allowed.test(fault)), []);
      } finally {
        await page.close();
        await mock.stop();
      }
    });
}

/** Saves the scene and answers its text. */
export async function savedScene(page) {
  const download = page.waitForEvent("download");
  await page.keyboard.press("Control+Shift+s");
  const { readFileSync } = await import("node:fs");
  return readFileSync(await (await download).path(), "utf8");
}
