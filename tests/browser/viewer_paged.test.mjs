// A volume that does not fit: read where it is seen, level by level.
import assert from "node:assert/strict";
import { before, test } from "node:test";
import { serve, servedVisits, skip } from "./served.mjs";
import { settled } from "./visit.mjs";

const all = servedVisits("sample:ball:16");
let server = null;
before(async () => {
  if (!skip) server = await serve(all.folder, "sample:shells:1024", 0, ["--memory", "200M", "--lighting", "none", "--interpolation", "linear"]);
});

test("who comes nearer sees finer levels, and is told of them", { skip }, () => all.visit(async (page) => {
  const level = () => page.evaluate(() => Number(/level (\d+) of 0 to 5 is drawn/.exec(chiaro.frame.last.notes.join(" "))?.[1] ?? -1));
  const far = await level();
  assert.ok(far > 0, `level ${far}`);
  await page.evaluate(() => {
    window.stages = [];
    const before = chiaro.shown;
    chiaro.shown = (header) => (before(header), window.stages.push(header.stage));
  });
  const box = await page.locator("canvas").first().boundingBox();
  await settled(page, async () => {
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    for (let i = 0; i < 12; ++i) await page.mouse.wheel(0, -240);
  });
  assert.equal(await level(), 0);
  const stages = await page.evaluate(() => window.stages);
  assert.equal(stages.at(-1), "final");
  assert.ok(stages.includes("full"), `coarser levels on the way: ${stages}`);
  await page.click(".pill");
  assert.match(await page.textContent(".popover"), /level 0 of 0 to 5 is drawn, 1024x1024x1024 voxels/);
  await page.keyboard.press("Escape");
  await page.keyboard.press("i");
  await page.waitForSelector(".popover dt:has-text('Seems to be')");
  const about = await page.textContent(".popover");
  assert.match(about, /Read where it is seen6 levels, 1024³ to 32³/);
  assert.match(about, /\(of a coarse level\)/);
}, { url: server.url }).finally(() => server.end("SIGINT")));
