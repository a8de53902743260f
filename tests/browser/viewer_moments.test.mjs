// What changes with time: the slider, its step, and play.
import assert from "node:assert/strict";
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { before, test } from "node:test";
import { serve, servedVisits, skip } from "./served.mjs";
import { eventually, settled } from "./visit.mjs";

const all = servedVisits("sample:ball:16"), count = 4, size = 24;
let server = null;
before(async () => {
  if (skip) return;
  const voxels = Buffer.alloc(count * size ** 3);
  let at = 0;
  for (let t = 0; t < count; ++t) for (let z = 0; z < size; ++z) for (let y = 0; y < size; ++y) for (let x = 0; x < size; ++x)
    voxels[at++] = Math.round((90 + 30 * t) * Math.min(1, Math.max(0, 5 + t - Math.hypot(x - 11.5, y - 11.5, z - 11.5))));
  mkdirSync(all.folder, { recursive: true });
  const header = `NRRD0005\ntype: uint8\ndimension: 4\nencoding: raw\nsizes: ${size} ${size} ${size} ${count}\nkinds: domain domain domain time\nspacings: 1 1 1 40\nunits: "mm" "mm" "mm" "ms"\n\n`;
  writeFileSync(join(all.folder, "beat.nrrd"), Buffer.concat([Buffer.from(header), voxels]));
  server = await serve(all.folder, "beat.nrrd");
});

const shown = (page) => page.evaluate(() => [chiaro.frame.last.moment?.voxels, chiaro.frame.last.moment?.light, chiaro.frame.last.stage]);

test("a slider shows other moments, and play goes through all, each in its own light", { skip }, () => all.visit(async (page) => {
  await page.waitForSelector(".moments");
  assert.equal(await page.textContent(".moments span"), "1 of 4, 0 ms");
  await settled(page, () => page.locator(".moments input").focus().then(() => page.keyboard.press("ArrowRight")));
  assert.deepEqual(await shown(page), [1, 1, "final"]);
  assert.equal(await page.textContent(".moments span"), "2 of 4, 40 ms");
  await settled(page, () => page.click("button[aria-label=Undo]"));
  assert.deepEqual(await shown(page), [0, 0, "final"]);
  const seen = await page.evaluate(() => new Promise((done) => {
    const seen = [], before = chiaro.shown;
    chiaro.shown = (header) => {
      before(header);
      if (header.stage !== "draft") seen.push([header.moment.voxels, header.moment.light]);
      if (seen.length === 9) (chiaro.shown = before), chiaro.moments.toggle(), done(seen);
    };
    chiaro.moments.toggle();
  }));
  assert.ok(seen.every(([voxels, light]) => voxels === light), JSON.stringify(seen));
  assert.deepEqual([...new Set(seen.map(([voxels]) => voxels))].sort(), [0, 1, 2, 3]);
  await eventually(async () => (await shown(page))[2] === "final");
  assert.equal(await page.evaluate(() => chiaro.frame.last.moment.voxels), await page.evaluate(() => chiaro.store.state.rest.volume.time ?? 0));
  if (process.env.CHIARO_SHOTS) await page.screenshot({ path: join(process.env.CHIARO_SHOTS, "moments.png") });
}, { url: server.url }).finally(() => server.end("SIGINT")));
