// What somebody tries who sees the page for the first time: opening by a path, going back, numbers that cannot be.
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { visits } from "./mocked.mjs";
import { drawn } from "./page.mjs";
import { servedVisits, skip } from "./served.mjs";
import { drag, eventually, final, settled, state } from "./visit.mjs";
import { nrrd, onVolume } from "./volume_file.mjs";

const visit = visits(), all = servedVisits("sample:tubes:32");
const nameOf = (page) => page.locator(".file b").textContent(), density = (page) => page.locator(".row[aria-label=Density] input").inputValue();
const openPath = async (page, path) => {
  await page.keyboard.press("Control+o");
  await page.fill("dialog input", path);
  await page.press("dialog input", "Enter");
};

test("a file opens by its path, a sample by its name; a folder is shown; what may not be opened is told there", { skip }, () => all.visit(async (page) => {
  const file = nrrd(all.folder, "path.nrrd");
  await openPath(page, "/etc");
  await page.waitForSelector("dialog .wrong:has-text('/etc: lies outside the folders')");
  await page.fill("dialog input", all.folder);
  await page.press("dialog input", "Enter");
  await page.waitForSelector("dialog .item:has-text('path.nrrd')");
  await page.fill("dialog input", file);
  await page.press("dialog input", "Enter");
  await page.waitForSelector(".file b:has-text('path.nrrd')");
  await final(page);
  await openPath(page, "sample:ball:24");
  await page.waitForSelector(".file b:has-text('sample:ball:24')");
  await final(page);
}));

test("a volume that was left is as it was, with its undo steps, where one goes on from there", { skip }, () => all.visit(async (page) => {
  await settled(page, () => page.keyboard.press("["));
  assert.equal(await density(page), "0.909");
  await openPath(page, "sample:ball:24");
  await page.waitForSelector(".file b:has-text('sample:ball:24')");
  await final(page);
  await openPath(page, "sample:tubes:32");
  await page.waitForSelector(".banner:has-text('You left this volume')");
  assert.equal(await density(page), "1");
  await settled(page, () => page.click(".banner button:has-text('Go on from there')"));
  assert.deepEqual([await nameOf(page), await density(page)], ["sample:tubes:32", "0.909"]);
  await settled(page, () => page.keyboard.press("Control+z"));
  assert.equal(await density(page), "1");
}));

/** 20³ voxels that rise from least to most, few of which are large. */
function ramp(name, type, least, most) {
  const n = 8000, file = join(all.folder, name), data = type === "uchar" ? new Uint8Array(n) : new Int16Array(n);
  for (let i = 0; i < n; ++i) data[i] = Math.round(least + (most - least) * (i / (n - 1)) ** 40);
  writeFileSync(file, Buffer.concat([Buffer.from(`NRRD0004\ntype: ${type}\ndimension: 3\nsizes: 20 20 20\nspace: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nendian: little\nencoding: raw\n\n`), Buffer.from(data.buffer)]));
  return file;
}
test("values are in HU where they begin with air's, not where a volume only seems to be of CT", { skip }, async () => {
  for (const [name, type, least, most, unit] of [["hu.nrrd", "short", -1000, 2000, "HU"], ["bytes.nrrd", "uchar", 0, 255, ""]])
    await onVolume(all, ramp(name, type, least, most), async (page) => {
      await final(page);
      assert.deepEqual(await page.evaluate(() => [chiaro.volume.modality_guess, chiaro.volume.unit]), ["CT", unit]);
    });
});

visit("a number that cannot be is told, and goes with what it was typed for; the nearest that can be stands there at once", async (page) => {
  const points = page.locator(".graph .point"), opacity = page.locator("input[aria-label=Opacity]"), value = page.locator("input[aria-label=Value]");
  const choose = (i) => points.nth(i).click();
  await choose(1);
  await opacity.fill("-5");
  await opacity.press("Enter");
  assert.equal(await page.locator(".wrong:visible").textContent(), "Takes 0 to 1.");
  await choose(2);
  await drawn(page);
  assert.equal(await page.locator(".wrong:visible").count(), 0);
  assert.notEqual(await opacity.inputValue(), "-5");
  // A point stays between its neighbours: that is what the field says, and one step undoes it.
  const before = (await state(page)).tf.points.map((p) => p.value);
  await choose(1);
  await value.fill("9999");
  await value.press("Tab");
  await drawn(page);
  assert.equal(Number(await value.inputValue()), (await state(page)).tf.points[1].value);
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("Control+z");
  assert.deepEqual((await state(page)).tf.points.map((p) => p.value), before);
  const [from] = await page.locator(".row[aria-label=Window] input").all();
  await from.fill("5000");
  await from.press("Enter");
  assert.match(await page.locator(".wrong:visible").textContent(), /^Takes .* to \d/);
});

visit("the start view comes back, as a step of the camera", async (page) => {
  await settled(page, () => drag(page, page.locator("#stage > canvas"), 120, 60));
  await page.click(".s-camera .head");
  assert.ok(await page.locator("button:has-text('Start view')").evaluate((b) => b.getBoundingClientRect().bottom <= innerHeight), "all of the part is in sight");
  await settled(page, () => page.click("button:has-text('Start view')"));
  assert.equal((await state(page)).camera["camera.azimuth_deg"], undefined);
  await settled(page, () => page.keyboard.press("Alt+z"));
  await eventually(async () => (await state(page)).camera["camera.azimuth_deg"] !== undefined);
});
