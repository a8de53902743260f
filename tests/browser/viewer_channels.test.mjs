// Channels in the viewer: a row each, with eye, colour, name, gain and window; the graph is of the one that is edited.
import assert from "node:assert/strict";
import { test } from "node:test";
import { serve, servedVisits, skip } from "./served.mjs";
import { drag, eventually, faint, final, pixels, settled, state, tapped } from "./visit.mjs";

const all = servedVisits();
let own;
const mixed = (act, page = undefined) => async () => {
  own ??= await serve(all.folder, "sample:tubes:48", 0, ["--channel", "sample:shells:48"]);
  await all.visit(async (at) => {
    await at.waitForSelector(".channel");
    await act(at);
  }, { url: own.url, ...(page ? { page } : {}) });
};
const row = (page, i) => page.locator(".channel").nth(i);
const scene = (page) => page.evaluate(() => chiaro.scene());

test("channels: a row each; the eye hides one, Alt shows it alone, and all again; undone", { skip }, mixed(async (page) => {
  assert.equal(await page.locator(".channel").count(), 2);
  const before = await pixels(page);
  await settled(page, () => row(page, 1).locator(".tool").click());
  assert.deepEqual((await scene(page)).channels.map((one) => one.show !== false), [true, false]);
  assert.notEqual(await pixels(page), before);
  await settled(page, () => page.keyboard.press("Control+z"));
  assert.equal(await pixels(page), before);
  await settled(page, () => row(page, 1).locator(".tool").click({ modifiers: ["Alt"] }));
  assert.deepEqual((await scene(page)).channels.map((one) => one.show !== false), [false, true]);
  await settled(page, async () => {
    await row(page, 1).locator(".tool").focus();
    await page.keyboard.press("Alt+Enter");
  });
  assert.deepEqual((await scene(page)).channels.map((one) => one.show !== false), [true, true]);
}));

test("channels: colour, gain by number and keys, window by drag: each is of its own channel", { skip }, mixed(async (page) => {
  const was = (await scene(page)).channels;
  await settled(page, () => row(page, 1).locator(".swatch").fill("#ff00ff"));
  await settled(page, async () => {
    await row(page, 1).locator(".channel-row input.number").fill("0.5");
    await page.keyboard.press("Enter");
  });
  await settled(page, () => drag(page, row(page, 1).locator(".thumb").nth(1), -30, 0));
  const now = (await scene(page)).channels;
  assert.deepEqual(now[0], was[0]);
  assert.equal(now[1].gain, 0.5);
  assert.ok(now[1].transfer_function.points.every(({ rgb }) => rgb[0] === 1 && rgb[1] === 0 && rgb[2] === 1));
  assert.ok(now[1].transfer_function.points.at(-1).value < was[1].transfer_function.points.at(-1).value);
  await row(page, 1).locator(".channel-row input.number").fill("-1");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".channel .wrong:has-text('Takes 0')");
}));

test("channels: the graph is of the edited one, its range too; undo goes back to the one that was edited", { skip }, mixed(async (page) => {
  const range = () => page.evaluate(() => chiaro.graph.axis.range), first = await range(), sent = await page.evaluate(() => chiaro.link.n);
  await row(page, 1).locator(".channel-name").click();
  await eventually(async () => (await row(page, 1).locator(".channel-name").getAttribute("aria-pressed")) === "true", "the second is edited");
  assert.deepEqual(await range(), await page.evaluate(() => chiaro.volume.channels[1].range));
  assert.equal(await page.evaluate(() => chiaro.link.n), sent, "the picture stays");
  const was = (await scene(page)).channels;
  await settled(page, () => page.keyboard.press("w"));
  const now = (await scene(page)).channels;
  assert.deepEqual(now[0], was[0]);
  assert.notDeepEqual(now[1], was[1]);
  await row(page, 0).locator(".channel-name").click();
  assert.deepEqual(await range(), first);
  await settled(page, () => page.keyboard.press("Control+z"));
  await eventually(async () => (await row(page, 1).locator(".channel-name").getAttribute("aria-pressed")) === "true", "the second again");
  assert.deepEqual((await scene(page)).channels, was);
  // Density is of all.
  await settled(page, () => page.keyboard.press("]"));
  const dense = await scene(page);
  assert.ok(dense.transfer_function.opacity_scale > 1);
  assert.ok(dense.channels.every((one) => one.transfer_function.opacity_scale === undefined));
}));

test("channels: a reload, and a scene that is loaded, give them back; slices add them up", { skip }, mixed(async (page) => {
  await settled(page, () => row(page, 0).locator(".swatch").fill("#00ff00"));
  await settled(page, () => row(page, 1).locator(".tool").click());
  const was = await scene(page);
  await page.reload();
  await final(page);
  await page.waitForSelector(".channel");
  assert.deepEqual((await scene(page)).channels, was.channels);
  await page.keyboard.press("s");
  await page.waitForSelector(".pane:not([hidden]) canvas[data-drawn=final]");
  const sum = () => page.evaluate(() => {
    const canvas = document.querySelector(".pane:not([hidden]) canvas"), { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height), total = [0, 0, 0];
    data.forEach((byte, i) => i % 4 < 3 && (total[i % 4] += byte));
    return total;
  });
  const green = await sum();
  assert.ok(green[1] > 0 && green[0] === 0 && green[2] === 0, String(green));
}));

test("channels: legible in both themes, and with fingers", { skip }, async () => {
  for (const colorScheme of ["dark", "light"]) await mixed(async (page) => assert.deepEqual(await faint(page), []), { viewport: { width: 1280, height: 800 }, colorScheme })();
  await mixed(async (page) => {
    await tapped(page, row(page, 1).locator(".tool"));
    assert.equal((await scene(page)).channels[1].show, false);
    for (const box of await page.$$eval(".channel-row button", (all) => all.map((one) => one.getBoundingClientRect().height))) assert.ok(box >= 40, `${box} pixels`);
  }, { viewport: { width: 400, height: 800 }, hasTouch: true, isMobile: true })();
  await own.end("SIGINT");
});
