// What a test does on the viewer's page.
import assert from "node:assert/strict";
import { drawn, patience } from "./page.mjs";

/** Waits until the picture is final and answers the page's newest state. */
export const final = (page) =>
  page.waitForFunction(() => {
    const { stage, n } = document.querySelector("#stage canvas").dataset;
    return stage === "final" && Number(n) === chiaro.link.n && !chiaro.store.dragging;
  }, null, { polling: 30 });

/** Lets `act` happen and waits for the final picture of a newer state. */
export async function settled(page, act) {
  const before = await page.evaluate(() => chiaro.link.n);
  await act();
  await page.waitForFunction((n) => chiaro.link.n > n, before, { polling: 20 });
  await drawn(page); // what follows by itself is sent in the next frame
  await final(page);
}

/** Taps and waits as `settled` does; taps once more where nothing comes of it, since the browser may take a tap for the end of the gesture before. */
export const tapped = (page, locator) =>
  settled(page, async () => {
    const before = await page.evaluate(() => chiaro.link.n);
    await locator.tap();
    await page.waitForFunction((n) => chiaro.link.n > n, before, { polling: 20, timeout: 15000 }).catch(() => locator.tap());
  });

/** Waits until `holds` answers true: for what comes when it comes. */
export async function eventually(holds, says) {
  const end = Date.now() + patience;
  while (!(await holds())) {
    assert.ok(Date.now() < end, says);
    await new Promise((go) => setTimeout(go, 30));
  }
}

/** Chooses a tool by its key. A key that is down for long, as one is where the machine is busy, only borrows its tool: then once more. */
export const chooseTool = (page, key, tool) =>
  eventually(async () => (await page.keyboard.press(key), (await page.evaluate(() => chiaro.ui.tool)) === tool), `${key} chooses ${tool}`);

/** Waits until the page has its server again, and asks for that. */
export const reconnected = (page) =>
  page.waitForFunction(() => chiaro.link.open || (document.querySelector(".banner button")?.click(), false), null, { polling: 300 });

/** A number that tells pictures apart: of every pixel of the canvas. */
export const pixels = (page) =>
  page.evaluate(() => {
    const canvas = document.querySelector("#stage canvas");
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let sum = 0x811c9dc5;
    for (const byte of data) sum = Math.imul(sum ^ byte, 0x01000193) >>> 0;
    return `${canvas.width}x${canvas.height}:${sum.toString(16)}`;
  });

export const state = (page) => page.evaluate(() => structuredClone(chiaro.store.state));

/** Presses the middle of an element and drags. */
export async function drag(page, locator, dx, dy, { button = "left", steps = 6, release = true } = {}) {
  const box = await locator.boundingBox();
  assert.ok(box, "there is something to drag");
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down({ button });
  await page.mouse.move(box.x + box.width / 2 + dx, box.y + box.height / 2 + dy, { steps });
  if (release) await page.mouse.up({ button });
}

/** Texts whose contrast with what lies behind them is below 4.5, with their ratio. */
export const faint = (page) =>
  page.evaluate(() => {
    const parse = (text) => (text.match(/[\d.]+/g) ?? []).map(Number);
    const channel = (c) => ((c /= 255) <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
    const luminance = ([r, g, b]) => 0.2126 * channel(r) + 0.7152 * channel(g) + 0.0722 * channel(b);
    const behind = (element) => {
      for (let at = element; at; at = at.parentElement) {
        const [r, g, b, a = 1] = parse(getComputedStyle(at).backgroundColor);
        if (a > 0.99) return [r, g, b];
      }
      return [255, 255, 255];
    };
    const found = [];
    for (const element of document.querySelectorAll("body *")) {
      const words = [...element.childNodes].filter((node) => node.nodeType === 3 && node.textContent.trim()).map((node) => node.textContent.trim()).join(" ") || (element.tagName === "INPUT" && /text|search|number/.test(element.type) ? element.value : "");
      if (!words || element.closest(":disabled, .cross, .scale, noscript, script, style") || !element.checkVisibility({ visibilityProperty: true, opacityProperty: true })) continue;
      const text = luminance(parse(getComputedStyle(element).color)), ground = luminance(behind(element));
      const ratio = (Math.max(text, ground) + 0.05) / (Math.min(text, ground) + 0.05);
      if (ratio < 4.5) found.push(`${words.slice(0, 30)}: ${ratio.toFixed(2)}`);
    }
    return found;
  });
