// A page far away, behind a relay: order and result. Times are scripts/far_away's.
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { relay } from "./relay.mjs";
import { serve, servedVisits, skip } from "./served.mjs";
import { drag, pixels, settled } from "./visit.mjs";
import { shown } from "./volume_file.mjs";

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

/** In the page: what is asked of slices, and in which order pictures and answers come. */
const watchSlices = () => {
  const { link } = chiaro, ask = link.ask.bind(link);
  Object.assign(window, { asked: [], came: [] });
  link.ask = (type, fields, heard) => {
    if (type !== "slice" || fields.values) return ask(type, fields, heard);
    const what = { number: window.asked.length, pane: fields.pane, lossless: fields.lossless };
    window.asked.push(what);
    const job = ask(type, fields, (message, data) => (data && window.came.push({ ...what, picture: true }), heard?.(message, data)));
    job.then(() => window.came.push({ ...what, picture: false }), () => {});
    return job;
  };
};

test("a draft of a slice overtakes lossless slices that are half sent, and ends the one of its own pane", { skip }, async () => {
  const n = 96, voxels = Buffer.alloc(n ** 3);
  for (let i = 0, x = 1; i < voxels.length; ++i) voxels[i] = (x = (Math.imul(x, 1664525) + 1013904223) >>> 0) >>> 24;
  writeFileSync(join(all.folder, "noise.nrrd"), Buffer.concat([Buffer.from(`NRRD0005\ntype: uint8\ndimension: 3\nencoding: raw\nsizes: ${n} ${n} ${n}\nspacings: 1 1 1\n\n`), voxels]));
  const own = await serve(all.folder, "noise.nrrd"), way = { round_trip_ms: 50, bits_per_ms: 1000 }, slow = await relay(own.port, way), url = new URL(own.url);
  url.port = String(slow.port);
  await all.visit(async (page) => {
    await page.evaluate(watchSlices);
    await page.keyboard.press("s");
    await shown(page);
    // Three panes come to rest, then the last one moves on. A busy machine makes its draft when they are sent already: then the way is to be slower.
    for (const last = 2; ; way.bits_per_ms /= 2) {
      const begun = await page.evaluate(() => ((window.begun = window.asked.length), chiaro.slices.setWindow(0, 200 + Math.random()), window.begun));
      await page.waitForFunction(() => window.asked.slice(window.begun).filter((one) => one.lossless).length === 3, null, { polling: 10 });
      const next = await page.evaluate(() => (window.next = window.asked.length));
      await page.locator(".pane").nth(last).focus();
      await page.keyboard.press("PageUp");
      await page.waitForFunction((pane) => window.came.some((one) => one.number >= window.next && one.pane === pane && one.picture), last, { polling: 10 });
      const rested = (await page.evaluate(() => window.came)).filter((one) => one.number >= begun && one.number < next && one.lossless && one.picture);
      await shown(page); // at rest it is lossless all the same, in every pane
      await page.waitForFunction(() => window.came.filter((one) => !one.picture).length === window.asked.length); // and each was answered
      if (rested.length === 3) {
        assert.ok(way.bits_per_ms > 30, "the draft always came last");
        continue;
      }
      const ended = (await page.evaluate(() => window.came)).filter((one) => one.picture && one.lossless && one.pane === last && one.number >= begun);
      assert.ok(ended.length === 1 && ended[0].number >= next, "the old lossless one was not sent to its end");
      return;
    }
  }, { url: url.href }).finally(() => Promise.all([slow.close(), own.end("SIGINT")]));
});
