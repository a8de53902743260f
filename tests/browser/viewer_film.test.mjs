// Keyframes: set, moved, played, and written: the same frames as the tool's.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, readdirSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { desktop, phone, visits } from "./mocked.mjs";
import { chiaro, serve, servedVisits, skip } from "./served.mjs";
import { drag, eventually, faint, final, pixels, reconnected, settled, state } from "./visit.mjs";

const all = servedVisits("sample:ball:24"), visit = visits();
const keys = (page) => page.evaluate(() => (chiaro.store.state.film?.keys ?? []).map((key) => key.at));
const count = (page, n) => page.waitForFunction((c) => (chiaro.store.state.film?.keys ?? []).length === c, n, { polling: 20 });
const menu = async (page, name) => {
  await page.click("button[aria-label=More]");
  await page.click(`.item:has-text("${name}")`);
};
/** Names and contents of a tape archive. */
function untar(data) {
  const files = [];
  for (let at = 0; data[at]; ) {
    const name = data.toString("latin1", at, at + 100).replace(/\0.*/, ""), size = parseInt(data.toString("latin1", at + 124, at + 135), 8);
    files.push([name, data.subarray(at + 512, at + 512 + size)]);
    at += 512 + Math.ceil(size / 512) * 512;
  }
  return files;
}

test("two keys make a film; its frames are those of chiaro render --film, to the last bit", { skip }, () => all.visit(async (page) => {
  await page.keyboard.press("k");
  await count(page, 1);
  await settled(page, () => drag(page, page.locator("#stage"), 80, 30));
  await settled(page, () => page.keyboard.press("]"));
  await page.click("#film button:has-text('Add a key')");
  await count(page, 2);
  assert.deepEqual(await keys(page), [0, 2]);
  // Shorter and smaller, for the test.
  await page.locator(".film-key").nth(1).focus();
  for (let i = 0; i < 17; ++i) await page.keyboard.press("ArrowLeft");
  assert.ok(Math.abs((await keys(page))[1] - 0.3) < 1e-9, `${await keys(page)}`);
  await page.evaluate(() => chiaro.store.set("size", (s) => ({ film: { ...s.film, size: [64, 48] } })));
  let download = page.waitForEvent("download");
  await page.click("#film button:has-text('Save the film')");
  await page.click(".item:has-text('As keyframes')");
  const file = join(all.folder, "film.json");
  writeFileSync(file, readFileSync(await (await download).path()));
  download = page.waitForEvent("download");
  await page.click("#film button:has-text('Save the film')");
  await page.click(".item:has-text('As PNGs')");
  const frames = untar(readFileSync(await (await download).path())), folder = join(all.folder, "frames");
  assert.equal(frames.length, 8);
  mkdirSync(folder, { recursive: true });
  execFileSync(chiaro, ["render", "--film", file, "-o", join(folder, "tool-{frame:05}.png"), "--quiet"]);
  for (const [name, data] of frames) {
    writeFileSync(join(folder, name), data);
    execFileSync(chiaro, ["compare", join(folder, name), join(folder, name.replace("frame-", "tool-")), "--fail-above", "max=0"]);
  }
  assert.notDeepEqual(frames[0][1], frames[7][1]);
  // The file of keyframes is taken again; a wrong one ends in a sentence.
  const text = readFileSync(file, "utf8"), before = await page.evaluate(() => JSON.stringify(chiaro.store.state.film));
  await page.evaluate(() => chiaro.store.set("none", () => ({ film: undefined })));
  await page.evaluate((t) => chiaro.take(new File([t], "film.json")), text);
  await count(page, 2);
  assert.equal(await page.evaluate(() => JSON.stringify(chiaro.store.state.film)), before);
  await page.evaluate((t) => chiaro.take(new File([t.replace('"fps": 25', '"fps": 0')], "film.json")), text);
  await page.waitForSelector(".banner:has-text('film: fps: must be 0.1 to 1000')");
  await page.keyboard.press("Control+z");
  await page.keyboard.press("Control+z");
  // Undo takes back, key by key.
  for (let i = 0; i < 12 && (await keys(page)).length === 2; ++i) await page.keyboard.press("Control+z");
  await count(page, 1);
}));

test("play shows what is between; leaving it shows the page's own state; a key is gone to", { skip }, () => all.visit(async (page) => {
  await settled(page, () => page.keyboard.press("k")); // the strip takes its place
  await count(page, 1);
  const first = await pixels(page), was = await state(page);
  await settled(page, () => drag(page, page.locator("#stage"), 120, 0));
  const own = await pixels(page);
  await page.keyboard.press("k");
  await count(page, 2);
  await page.evaluate(() => {
    window.seen = { times: new Set(), pills: new Set() };
    (function look() {
      seen.times.add(chiaro.film.now.toFixed(1)), seen.pills.add(document.querySelector(".pill").textContent);
      requestAnimationFrame(look);
    })();
  });
  await page.click("#film button:has-text('Play')");
  await page.waitForFunction(() => seen.times.size > 4 && !chiaro.film.playing);
  assert.ok(await page.evaluate(() => [...seen.pills].some((text) => /preview/.test(text))), "it is a preview");
  // Half way between, by keys on the time's own handle.
  await page.locator(".film-head").focus();
  await page.keyboard.press("Home");
  await page.waitForFunction(() => chiaro.film.now === 0);
  await settled(page, () => page.click("#film button[aria-label=Close]"));
  await settled(page, () => menu(page, "Film"));
  assert.equal(await pixels(page), own, "the page's own state");
  await page.locator(".film-key").first().focus();
  await settled(page, () => page.keyboard.press("Enter"));
  assert.equal(await pixels(page), first);
  assert.equal((await state(page)).camera["camera.azimuth_deg"], was.camera["camera.azimuth_deg"]);
  assert.deepEqual(await keys(page), [0, 2]);
  // It is there after a reload.
  await page.reload();
  await final(page);
  assert.deepEqual(await keys(page), [0, 2]);
}));

test("a turntable in one click is written as a film, with progress and cancel", { skip }, () => all.visit(async (page) => {
  const formats = await page.evaluate(() => chiaro.hello.films);
  assert.ok(formats.includes("png"));
  await menu(page, "Film");
  await page.click("#film button:has-text('Turntable')");
  await count(page, 4);
  assert.equal((await keys(page)).at(-1), 8);
  await page.click("#film button:has-text('Save the film')");
  await page.click(".item:has-text('As PNGs')");
  await page.waitForFunction(() => /[1-9]/.test(document.querySelector(".film-writing:not([hidden]) small")?.textContent ?? ""));
  // The page stays usable meanwhile.
  await page.keyboard.press("]");
  await page.click(".film-writing button:has-text('Cancel')");
  await page.waitForSelector("#film button:has-text('Save the film')");
  if (!formats.includes("mp4")) return;
  await page.evaluate(() => chiaro.store.set("size", (s) => ({ film: { ...s.film, size: [64, 48], keys: s.film.keys.map((k, i) => ({ ...k, at: i / 4 })) } })));
  const download = page.waitForEvent("download");
  await page.click("#film button:has-text('Save the film')");
  await page.click(".item:has-text('As MP4')");
  const data = readFileSync(await (await download).path());
  assert.equal(data.toString("latin1", 4, 8), "ftyp");
}));

visit("keys are dragged and removed, each a step; what a film needs is loaded when it is first used", async (page) => {
  const loaded = () => page.evaluate(() => performance.getEntriesByType("resource").some((e) => /film\.js$/.test(e.name)));
  assert.equal(await loaded(), false);
  await menu(page, "Film");
  await page.waitForSelector("#film:visible");
  assert.equal(await loaded(), true);
  await page.click("#film button:has-text('Turntable')");
  await count(page, 4);
  const before = await keys(page);
  await drag(page, page.locator(".film-key").nth(1), 40, 0);
  const moved = await keys(page);
  assert.ok(moved[1] > before[1] && moved[1] < before[2], `${moved}`);
  await page.keyboard.press("Control+z");
  assert.deepEqual(await keys(page), before);
  await page.locator(".film-key").nth(2).focus();
  await page.keyboard.press("Delete");
  await count(page, 3);
  await page.keyboard.press("Control+z");
  await count(page, 4);
  assert.ok(await page.evaluate(() => document.documentElement.scrollHeight <= innerHeight && document.documentElement.scrollWidth <= innerWidth));
});

visit("with fingers: the strip stands over the sheet's tabs, keys are large enough", async (page) => {
  await menu(page, "Film");
  await page.waitForSelector("#film:visible");
  await page.locator("#film button:has-text('Turntable')").tap();
  await count(page, 4);
  const size = await page.locator(".film-key").first().boundingBox();
  assert.ok(size.width >= 44 && size.height >= 40);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
}, { options: phone });

for (const colorScheme of ["dark", "light"])
  visit(`the film's strip in the ${colorScheme} theme: legible and named`, async (page) => {
    await menu(page, "Film");
    await page.waitForSelector("#film:visible");
    await page.click("#film button:has-text('Turntable')");
    await count(page, 4);
    await page.locator(".film-key").nth(1).focus();
    assert.deepEqual(await faint(page), []);
    const nameless = await page.locator("#film :is(button, select, [role=slider]):visible").evaluateAll((all) => all.filter((e) => !(e.getAttribute("aria-label") || e.textContent.trim())).map((e) => e.outerHTML));
    assert.deepEqual(nameless, []);
  }, { options: { ...desktop, colorScheme } });

test("writing goes on after a reload and after kill -9 where it was", { skip }, async () => {
  let own = await serve(all.folder, "sample:ball:24");
  const below = join(all.folder, "chiaro", "films"), frames = () => {
    try {
      return readdirSync(below).flatMap((film) => readdirSync(join(below, film)).filter((name) => name.endsWith(".png")).map((name) => join(below, film, name))).sort();
    } catch {
      return [];
    }
  };
  await all.visit(async (page) => {
    await page.keyboard.press("k");
    await count(page, 1);
    await page.click("#film button:has-text('Turntable')");
    await count(page, 4);
    await page.evaluate(() => chiaro.store.set("smaller", (s) => ({ film: { ...s.film, size: [320, 180] } }))); // for the test
    await page.waitForTimeout(800); // the server has the film
    await page.click("#film button:has-text('Save the film')");
    await page.click(".item:has-text('As PNGs')");
    await eventually(() => frames().length > 2, "frames are made");
    const [first] = frames(), bytes = readFileSync(first), made = statSync(first).mtimeMs;
    assert.equal(statSync(join(first, "..")).mode & 0o777, 0o700);
    await page.reload();
    await page.waitForSelector("#film .film-writing:not([hidden])");
    const soFar = frames().length;
    await eventually(() => frames().length > soFar, "it goes on");
    await own.end("SIGKILL");
    assert.equal(statSync(first).mtimeMs, made);
    const download = page.waitForEvent("download");
    own = await serve(all.folder, "sample:ball:24", own.port);
    await reconnected(page);
    const files = untar(readFileSync(await (await download).path()));
    assert.deepEqual(files.map(([name]) => name), Array.from({ length: 201 }, (_, i) => `frame-${String(i).padStart(5, "0")}.png`));
    assert.ok(files[0][1].equals(bytes), "the first frame is the one made first");
    await eventually(() => frames().length === 0, "what was written is gone with the download");
    assert.equal(await page.evaluate(() => sessionStorage.getItem("film")), null);
    // Given up, it leaves nothing.
    await page.click("#film button:has-text('Save the film')");
    await page.click(".item:has-text('As PNGs')");
    await eventually(() => frames().length > 2, "frames are made");
    await page.click("#film .film-writing button");
    await eventually(() => frames().length === 0, "they go");
  }, { url: own.url, allowed: /WebSocket|ERR_CONNECTION|failed/ });
  await own.end("SIGINT");
});
