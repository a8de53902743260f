// Nothing is lost: a killed server, a reloaded page, a closed page; state, steps and what was sent.
import assert from "node:assert/strict";
import { readdirSync, readFileSync, statSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { openPage } from "./page.mjs";
import { options, serve, servedVisits, skip } from "./served.mjs";
import { drag, eventually, final, pixels, reconnected, settled, state } from "./visit.mjs";
import { nrrd } from "./volume_file.mjs";

const all = servedVisits();
const kept = () => {
  try {
    return readdirSync(join(all.folder, "chiaro", "views")).map((name) => join(all.folder, "chiaro", "views", name));
  } catch {
    return [];
  }
};
/** Waits until what is on disk is the page's state. */
const written = (page) => eventually(async () => {
  const { view, scale, n, turns } = await page.evaluate(() => ({ view: chiaro.link.view, scale: chiaro.store.state.tf.scale, n: chiaro.store.history().undo.design.length, turns: chiaro.store.history().undo.camera.length }));
  return kept().filter((file) => file.includes(view)).some((file) => {
    const { scene, undo } = JSON.parse(readFileSync(file, "utf8"));
    return (scene.transfer_function.opacity_scale ?? 1) === scale && undo?.undo?.design?.length === n && undo.undo.camera.length === turns;
  });
}, "the state is on disk");
const lost = { allowed: /WebSocket|ERR_CONNECTION|failed/ };

test("killed with -9 in the middle of an edit and started again: page, reload and steps go on where they were", { skip }, async () => {
  let own = await serve(all.folder, "sample:ball:48");
  await all.visit(async (page) => {
    await settled(page, () => page.keyboard.press("]"));
    await settled(page, () => page.keyboard.press("3"));
    await settled(page, () => drag(page, page.locator("#stage"), 50, 20));
    await written(page);
    const was = await state(page), seen = await pixels(page);
    assert.equal(statSync(kept()[0]).mode & 0o777, 0o600);
    assert.equal(statSync(join(all.folder, "chiaro", "views")).mode & 0o777, 0o700);
    // A drag is under way.
    await drag(page, page.locator("#stage"), 30, 0, { button: "right", release: false });
    await own.end("SIGKILL");
    own = await serve(all.folder, "sample:ball:48", own.port);
    await page.mouse.up({ button: "right" });
    await page.keyboard.press("Control+z");
    await reconnected(page);
    await final(page);
    assert.deepEqual((await state(page)).values, was.values);
    // And again, reloaded before it comes back: another browser's tab would have no more than the server has.
    await written(page);
    await own.end("SIGKILL");
    own = await serve(all.folder, "sample:ball:48", own.port);
    await page.evaluate(() => addEventListener("pagehide", () => sessionStorage.removeItem("state")));
    await page.reload();
    await final(page);
    const now = await state(page);
    assert.deepEqual([now.values.mode, now.tf.scale, now.camera["camera.azimuth_deg"]], ["mip", was.tf.scale, was.camera["camera.azimuth_deg"]]);
    assert.equal(await pixels(page), seen);
    await settled(page, () => page.keyboard.press("Control+z"));
    assert.equal((await state(page)).values.mode ?? "dvr", "dvr");
    await settled(page, () => page.keyboard.press("Control+z"));
    assert.equal((await state(page)).tf.scale, 1);
    await settled(page, () => page.keyboard.press("Control+Shift+z"));
    assert.equal((await state(page)).tf.scale, was.tf.scale);
    await settled(page, () => page.keyboard.press("Alt+z"));
    assert.notEqual((await state(page)).camera["camera.azimuth_deg"], was.camera["camera.azimuth_deg"]);
  }, { url: own.url, ...lost });
  await own.end("SIGINT");
});

test("what was sent is there again after a kill, and gone after a clean end", { skip }, async () => {
  const bytes = readFileSync(nrrd(all.folder, "sent.nrrd")).toString("base64");
  const sent = () => readdirSync(join(all.folder, "chiaro"), { recursive: true }).filter((name) => name.endsWith("sent.nrrd"));
  let own = await serve(all.folder, "");
  const { page, faults } = await openPage(all.browser, own.url, options);
  try {
    await page.waitForSelector("h1:has-text('Open a volume')");
    await page.evaluate((data) => chiaro.sendVolume([{ file: new File([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], "sent.nrrd"), name: "sent.nrrd" }]), bytes);
    await final(page);
    await settled(page, () => page.keyboard.press("]"));
    await written(page);
    const was = await state(page);
    await own.end("SIGKILL");
    own = await serve(all.folder, "", own.port);
    await page.evaluate(() => addEventListener("pagehide", () => sessionStorage.removeItem("state")));
    await page.reload();
    await final(page);
    assert.equal(await page.locator(".file b").textContent(), "sent.nrrd");
    assert.equal((await state(page)).tf.scale, was.tf.scale);
    await settled(page, () => page.keyboard.press("Control+z"));
    assert.equal((await state(page)).tf.scale, 1);
    assert.deepEqual(faults.filter((fault) => !lost.allowed.test(fault)), []);
  } finally {
    await page.close();
    await own.end("SIGINT");
  }
  assert.deepEqual(sent(), []);
  assert.ok(kept().every((file) => !readFileSync(file, "utf8").includes("sent.nrrd")));
});

test("a page that was closed by mistake: the next one of the volume may go on from there", { skip }, async () => {
  const own = await serve(all.folder, "sample:slab:32");
  try {
    await all.visit(async (page) => {
      await settled(page, () => page.keyboard.press("3"));
      await written(page);
    }, { url: own.url });
    await all.visit(async (page) => {
      await page.waitForSelector(".banner[role=alert]:has-text('This volume was open 1 min ago')");
      assert.equal((await state(page)).values.mode ?? "dvr", "dvr");
      await settled(page, () => page.click(".banner button:has-text('Go on from there')"));
      assert.equal((await state(page)).values.mode, "mip");
      await settled(page, () => page.keyboard.press("Control+z"));
      assert.equal((await state(page)).values.mode ?? "dvr", "dvr");
    }, { url: own.url });
  } finally {
    await own.end("SIGINT");
  }
});
