// Labels in the viewer: a list that is searched, eye, colour, tint and opacity, a click in the picture, labels over slices.
import assert from "node:assert/strict";
import { test } from "node:test";
import { serve, servedVisits, skip } from "./served.mjs";
import { nrrd } from "./volume_file.mjs";
import { changed, withChange } from "../../viewer/labels.js";
import { drag, eventually, faint, final, pixels, settled, state, tapped } from "./visit.mjs";

const all = servedVisits();
let own;
const labelled = (act) => async () => {
  own ??= await serve(all.folder, "sample:torso:48", 0, ["--labels", "sample:organs:48"]);
  await all.visit(async (page) => {
    await page.waitForSelector(".label-row");
    await act(page);
  }, { url: own.url });
};
const rows = (page) => page.locator(".label-row");
const names = (page) => page.$$eval(".label-row .channel-name", (all) => all.map((one) => one.textContent));
const changes = async (page) => (await state(page)).rest.labels?.changes ?? [];

test("changes: merged where they may be, in order where they must be", () => {
  const labels = [0, 1, 2].map((value) => ({ value, show: true, tint: 1, opacity: 1, rgb: [1, 1, 1] }));
  const shown = (list) => changed(labels, list).map((one) => one.show);
  let list = withChange([], { value: 1, show: false });
  list = withChange(list, { value: 1, tint: 0.5 });
  assert.deepEqual(list, [{ value: 1, show: false, tint: 0.5 }]);
  list = withChange(list, { show: false });
  assert.deepEqual(list, [{ value: 1, tint: 0.5 }, { show: false }], "what is said of all makes what was said of one needless");
  assert.deepEqual(shown(list), [true, false, false], "0 is no label");
  list = withChange(list, { value: 2, show: true });
  assert.deepEqual(shown(list), [true, false, true]);
  assert.deepEqual(withChange(list, { show: true }), [{ value: 1, tint: 0.5 }, { show: true }]);
});

test("labels: listed with their share, hidden and shown by the eye, undone", { skip }, labelled(async (page) => {
  const listed = await names(page);
  assert.ok(listed.length >= 4 && listed.every((name) => name), String(listed));
  const before = await pixels(page);
  await settled(page, () => rows(page).nth(1).locator(".tool").click());
  assert.equal((await changes(page)).length, 1);
  assert.equal((await changes(page))[0].show, false);
  assert.equal(await rows(page).nth(1).locator(".tool").getAttribute("aria-pressed"), "false");
  assert.notEqual(await pixels(page), before);
  await settled(page, () => page.keyboard.press("Control+z"));
  assert.equal(await pixels(page), before);
}));

test("labels: one alone by Alt and click, or Alt and Enter; all again; hide all, show all, as in the table", { skip }, labelled(async (page) => {
  const shown = () => page.$$eval(".label-row .tool", (all) => all.map((one) => one.getAttribute("aria-pressed") === "true"));
  const first = await shown();
  await settled(page, () => rows(page).nth(2).locator(".tool").click({ modifiers: ["Alt"] }));
  assert.deepEqual(await shown(), first.map((_, i) => i === 2 || i === 0), "0 is what no structure has: it stays as it was");
  await settled(page, async () => {
    await rows(page).nth(2).locator(".tool").focus();
    await page.keyboard.press("Alt+Enter");
  });
  assert.deepEqual(await shown(), first.map(() => true));
  await settled(page, () => page.click(".s-labels button:has-text('Hide all')"));
  assert.deepEqual(await shown(), first.map((_, i) => i === 0));
  await settled(page, () => page.click(".s-labels button:has-text('As in the table')"));
  assert.deepEqual(await shown(), first);
}));

test("labels: found by a part of the name; only these are shown", { skip }, labelled(async (page) => {
  const listed = await names(page), name = listed.at(-1);
  await page.fill(".s-labels input[type=search]", name.slice(0, 4));
  await eventually(async () => (await names(page)).length < listed.length, "fewer rows");
  const left = await names(page);
  assert.ok(left.includes(name) && left.every((one) => one.toLowerCase().includes(name.slice(0, 4).toLowerCase())));
  await settled(page, () => page.click(".s-labels button:has-text('Only these')"));
  await page.fill(".s-labels input[type=search]", "no such thing");
  await page.waitForSelector(".s-labels .sentence:has-text('No label of this name')");
  await page.locator(".s-labels input[type=search]").press("Escape");
  await eventually(async () => (await names(page)).length === listed.length, "all rows again");
  const shown = await page.$$eval(".label-row .tool", (all) => all.map((one) => one.getAttribute("aria-pressed") === "true"));
  assert.deepEqual(shown, listed.map((one, i) => i === 0 || left.includes(one)));
}));

test("labels: colour, tint and opacity of the chosen one, by pointer and by keys; kept in the scene", { skip }, labelled(async (page) => {
  await rows(page).nth(1).locator(".channel-name").click();
  await settled(page, () => rows(page).nth(1).locator(".swatch").fill("#00ff00"));
  await settled(page, () => drag(page, page.locator(".s-labels .row .thumb").nth(0), -60, 0));
  await settled(page, async () => {
    await page.locator(".s-labels .row .thumb").nth(1).focus();
    await page.keyboard.press("Shift+ArrowLeft");
  });
  const [change, ...others] = await changes(page);
  assert.equal(others.length, 0);
  assert.deepEqual(change.rgb, [0, 1, 0]);
  assert.ok(change.tint < 1 && Math.abs(change.opacity - 0.9) < 1e-9, JSON.stringify(change));
  const scene = await page.evaluate(() => chiaro.scene());
  assert.deepEqual(scene.labels.changes, [change]);
  assert.ok(scene.labels.file.endsWith("organs:48"));
}));

test("labels: a click in the picture chooses; slices have them over the grey, and tell their name", { skip }, labelled(async (page) => {
  await page.locator("#stage canvas").first().click({ position: { x: 250, y: 250 } });
  await page.waitForSelector(".label-row .channel-name[aria-pressed=true]");
  await page.keyboard.press("s");
  const slice = page.locator(".pane:not([hidden]) canvas").first();
  await page.waitForSelector(".pane:not([hidden]) canvas[data-drawn=final]");
  const coloured = () => page.evaluate(() => {
    const canvas = document.querySelector(".pane:not([hidden]) canvas"), { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let count = 0;
    for (let i = 0; i < data.length; i += 4) count += Math.abs(data[i] - data[i + 1]) + Math.abs(data[i + 1] - data[i + 2]) > 20;
    return count;
  });
  assert.ok((await coloured()) > 300, "labels are seen");
  const { x, y, width, height } = await slice.boundingBox();
  await page.mouse.move(x + width / 2, y + height / 2);
  await eventually(async () => (await names(page)).includes(await page.locator(".pane .read span").last().textContent()), "the label's name");
  await page.locator(".s-slices .head").click();
  const before = await coloured();
  await page.evaluate(() => chiaro.slices.put("Labels", "labels", 0));
  await eventually(async () => { const now = await coloured(); return now < before / 2 && now > 20; }, "borders alone");
}));

test("labels: opened from the server's folders, a step that can be undone", { skip }, async () => {
  nrrd(all.folder, "organs.nrrd");
  const plain = await serve(all.folder, "sample:ball:32");
  await all.visit(async (page) => {
    await page.click("#bar [aria-label=More]");
    await page.click(".menu button:has-text('Labels on the server'), [role=menuitem]:has-text('Labels on the server')");
    await page.click(`dialog .item:has-text('${all.folder}')`);
    await page.click("dialog .item:has-text('organs.nrrd')");
    await page.waitForSelector(".label-row");
    await eventually(async () => (await page.evaluate(() => chiaro.scene())).labels?.file?.endsWith("organs.nrrd"), "in the scene");
    await page.keyboard.press("Control+z");
    await page.waitForSelector(".s-labels", { state: "hidden" });
    assert.equal((await page.evaluate(() => chiaro.scene())).labels, undefined);
  }, { url: plain.url });
  await plain.end("SIGINT");
});

test("labels: legible in both themes, and with fingers", { skip }, async () => {
  own ??= await serve(all.folder, "sample:torso:48", 0, ["--labels", "sample:organs:48"]);
  for (const colorScheme of ["dark", "light"]) await all.visit(async (page) => {
    await page.waitForSelector(".label-row");
    assert.deepEqual(await faint(page), []);
  }, { url: own.url, page: { viewport: { width: 1280, height: 800 }, colorScheme } });
  await all.visit(async (page) => {
    await page.waitForSelector(".label-row");
    await tapped(page, rows(page).nth(1).locator(".tool"));
    assert.equal((await changes(page)).length, 1);
    for (const box of await page.$$eval(".label-row button", (all) => all.map((one) => one.getBoundingClientRect().height))) assert.ok(box >= 40, `${box} pixels`);
  }, { url: own.url, page: { viewport: { width: 400, height: 800 }, hasTouch: true, isMobile: true } });
  await own.end("SIGINT");
});
