// A page far away, behind a relay: order and result. Times are scripts/far_away's.
import assert from "node:assert/strict";
import { test } from "node:test";
import { relay } from "./relay.mjs";
import { servedVisits, skip } from "./served.mjs";
import { drag, final, pixels, settled } from "./visit.mjs";

const all = servedVisits("sample:tubes:48");

test("behind 50 ms and 5 Mbit/s: no older frame after a newer one, and the last is lossless", { skip }, async () => {
  const way = { round_trip_ms: 50, bits_per_ms: 5000, jitter_ms: 20 }, slow = await relay(all.server.port, way), url = new URL(all.server.url);
  url.port = String(slow.port);
  await all.visit(async (page) => {
    await page.evaluate(() => {
      const { shown } = chiaro;
      window.drawn = [];
      chiaro.shown = (header) => (window.drawn.push([header.n, header.stage]), shown(header));
    });
    await settled(page, () => drag(page, page.locator("#stage"), 150, 40, { steps: 40 }));
    const drawn = await page.evaluate(() => window.drawn), ns = drawn.map(([n]) => n);
    assert.deepEqual(ns, [...ns].sort((a, b) => a - b));
    assert.ok(ns.length > 2, "there are pictures on the way");
    assert.equal(drawn.at(-1)[1], "final");
    assert.ok(way.longest_queue_ms < 1000, `${way.longest_queue_ms} ms wait in the way`);
    const seen = await pixels(page), camera = await page.evaluate(() => chiaro.store.state.camera);
    await all.visit(async (near) => {
      await settled(near, () => near.evaluate((c) => chiaro.store.set("camera", () => ({ camera: c }), "camera"), camera));
      assert.equal(await pixels(near), seen);
    });
  }, { url: url.href });
  await slow.close();
});
