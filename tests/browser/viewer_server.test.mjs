// The page and the program: `chiaro view` with a small sample, from loading to a saved picture.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { openPage } from "./page.mjs";
import { chiaro, options, serve as serveIn, servedVisits, skip, token } from "./served.mjs";
import { chooseTool, drag, final, pixels, reconnected, settled, state } from "./visit.mjs";

const all = servedVisits(), { folder, visit } = all, serve = (volume, port) => serveIn(folder, volume, port);

test("what the camera fits is found once, and anew when it is asked for", { skip }, () => visit(async (page) => {
  const found = async () => { const { camera } = await state(page); return [...camera["camera.fit_centre"], camera["camera.fit_radius"]]; };
  const first = await found(), was = await pixels(page);
  await page.evaluate(() => chiaro.store.set("cut", (s) => ({ values: { ...s.values, "clip.box": [0, 0.5, 0, 1, 0, 1] } })));
  await final(page);
  assert.deepEqual(await found(), first);
  await page.keyboard.press("f");
  await final(page);
  const cut = await found();
  assert.notDeepEqual(cut, first);
  await page.keyboard.press("Control+z");
  await page.keyboard.press("Alt+z");
  await final(page);
  assert.deepEqual(await found(), first);
  assert.deepEqual(await pixels(page), was);
}));

test("a dragged point changes the pixels and undo brings them back", { skip }, () => visit(async (page) => {
  const was = await pixels(page), points = page.locator(".point");
  const index = await page.evaluate(() => chiaro.store.state.tf.points.findIndex((p) => p.opacity > 0));
  await settled(page, () => drag(page, points.nth(index), 0, 60));
  assert.notEqual(await pixels(page), was);
  await settled(page, () => page.keyboard.press("Control+z"));
  assert.equal(await pixels(page), was);
}));

test("the final picture has the pixels that the tool computes", { skip }, () => visit(async (page) => {
  const scene = join(folder, "scene.json"), picture = join(folder, "tool.png");
  writeFileSync(scene, JSON.stringify(await page.evaluate(() => ({ ...chiaro.scene(), image: { size: chiaro.frame.size() } }))));
  execFileSync(chiaro, ["render", "--scene", scene, "-o", picture, "--quiet"]);
  const same = await page.evaluate(async (bytes) => {
    const bitmap = await createImageBitmap(new Blob([Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0))]), { colorSpaceConversion: "none" });
    const shown = document.querySelector("#stage canvas"), other = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    other.drawImage(bitmap, 0, 0);
    const a = shown.getContext("2d").getImageData(0, 0, shown.width, shown.height).data, b = other.getImageData(0, 0, bitmap.width, bitmap.height).data;
    return a.length === b.length && a.every((byte, i) => byte === b[i]);
  }, readFileSync(picture, "base64"));
  assert.equal(same, true);
}));

test("each method gives another picture, and so does a turned probe", { skip }, () => visit(async (page) => {
  const seen = new Map();
  await page.evaluate(() => chiaro.store.set("near", (s) => ({ values: { ...s.values, "histogram:lighting.radius": 3 } }))); // which is found quickly
  for (const method of ["none", "spao", "visibility", "histogram"]) {
    if ((await page.locator(`[data-method=${method}]`).getAttribute("aria-checked")) === "false") await settled(page, () => page.click(`[data-method=${method}]`));
    seen.set(await pixels(page), method);
  }
  assert.equal(seen.size, 4, [...seen.values()].join(", "));
  await settled(page, () => page.click("[data-method=visibility]"));
  await settled(page, () => page.click("[role=radio][aria-label=Windows]"));
  const was = await pixels(page);
  await settled(page, () => drag(page, page.locator(".ball"), 30, 0));
  assert.notEqual(await pixels(page), was);
}));

test("a saved scene gives the same pixels again, and so does the saved picture", { skip }, () => visit(async (page) => {
  await settled(page, () => page.keyboard.press("]"));
  await settled(page, () => drag(page, page.locator("#stage"), 60, 20));
  await page.locator(".chip").first().dblclick();
  await page.keyboard.type("Wände");
  await page.mouse.move(300, 300);
  await settled(page, () => page.keyboard.press("Enter"));
  const was = await pixels(page);
  let download = page.waitForEvent("download");
  await page.keyboard.press("Control+Shift+s");
  const scene = readFileSync(await (await download).path(), "utf8");
  download = page.waitForEvent("download");
  await page.click("button.primary");
  await page.click(".popover button.primary");
  const picture = readFileSync(await (await download).path());
  await page.keyboard.press("Escape");
  for (const [name, data] of [["scene.json", Buffer.from(scene)], ["saved.png", picture]]) {
    await settled(page, () => page.keyboard.press("]"));
    assert.notEqual(await pixels(page), was);
    await settled(page, () => page.evaluate(() => chiaro.store.set("no names", (s) => ({ tf: { ...s.tf, points: s.tf.points.map(({ name, ...p }) => p) } }))));
    await settled(page, () => page.evaluate(([bytes, file]) => chiaro.take(new File([Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0))], file)), [data.toString("base64"), name]));
    assert.equal(await pixels(page), was, name);
    assert.match(await page.locator(".chip").first().textContent(), /^Wände/, name);
  }
}));

test("Adjust picks the value of a known sample and makes it denser", { skip }, async () => {
  const own = await serve("sample:slab:32");
  try {
    await visit(async (page) => {
      const was = await pixels(page);
      await chooseTool(page, "a", "adjust");
      await page.keyboard.up("a");
      await drag(page, page.locator("#stage"), 0, 0, { release: false });
      await page.waitForFunction(() => chiaro.ui.points.length === 1);
      const value = await page.evaluate(() => chiaro.store.state.tf.points[chiaro.ui.points[0]].value);
      assert.ok(Math.abs(value - 200) <= 2, `the slab is 200, not ${value}`);
      const box = await page.locator("#stage").boundingBox();
      await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2 - 100, { steps: 4 });
      await settled(page, () => page.mouse.up());
      assert.notEqual(await pixels(page), was);
    }, { url: own.url });
  } finally {
    await own.end("SIGINT");
  }
});

test("a second viewer has a state of its own", { skip }, () => visit(async (first) => {
  const was = await pixels(first);
  await visit(async (second) => {
    await settled(second, () => second.keyboard.press("3"));
    assert.notEqual(await pixels(second), was);
  });
  assert.equal(await pixels(first), was);
  assert.equal((await state(first)).values.mode ?? "dvr", "dvr");
}));

test("killed and started again, it shows the same picture", { skip }, async () => {
  let own = await serve();
  try {
    await visit(async (page) => {
      await settled(page, () => page.keyboard.press("]"));
      const was = await pixels(page);
      await own.end();
      await page.waitForSelector(".banner:has-text('Connection lost')");
      own = await serve("sample:cornell:48", own.port);
      await reconnected(page);
      await page.waitForTimeout(300);
      await final(page);
      assert.equal(await pixels(page), was);
    }, { url: own.url, allowed: /WebSocket|ERR_CONNECTION/ });
  } finally {
    await own.end();
  }
});

test("a wrong token and a foreign page are refused", { skip }, async () => {
  const wrong = all.server.url.replace(token, "0".repeat(32));
  assert.equal((await fetch(wrong)).status, 403);
  assert.equal((await fetch(all.server.url)).status, 200);
  const page = await all.browser.newPage();
  const refused = await page.evaluate((url) => new Promise((done) => {
    const socket = new WebSocket(url);
    socket.onopen = () => done("open");
    socket.onerror = () => done("refused");
  }), all.server.url.replace("http", "ws").replace("/?", "/socket?view=abcdefgh12&"));
  assert.equal(refused, "refused", "a page of another origin");
  await page.close();
});

test("a walk: start empty, open, edit, light, clip, save", { skip }, async () => {
  const own = await serve("");
  const { page, faults } = await openPage(all.browser, own.url, options);
  try {
    await page.click("button:has-text('Try a sample')");
    await page.click(".item:has-text('shells')");
    await page.mouse.move(200, 200); // resting on a chip or look would be a preview
    await final(page);
    const seen = [await pixels(page)];
    const step = async (act) => {
      await settled(page, act);
      seen.push(await pixels(page));
    };
    await step(() => drag(page, page.locator("#stage"), 80, 30)); // orbit
    await step(() => drag(page, page.locator("#stage"), 40, 0, { button: "right" })); // window
    await step(async () => {
      await page.click("button[aria-label='Add a shape']");
      await page.click(".item:has-text('Peak')");
    });
    await step(() => page.click("[data-method=none]"));
    await step(() => page.click("[data-method=spao]"));
    await page.click(".s-cut .head");
    await page.locator(".row[aria-label=x] .thumb").first().focus();
    await step(async () => {
      for (let i = 0; i < 4; ++i) await page.keyboard.press("PageUp"); // the outermost tenths are empty
    });
    await step(() => page.keyboard.press("3"));
    await step(() => page.keyboard.press("1"));
    const steps = ["open", "orbit", "window", "shape", "none", "spao", "cut", "maximum", "volume"];
    const first = seen.map((picture) => steps[seen.indexOf(picture)]); // the step that first gave the picture
    assert.deepEqual(first, ["open", "orbit", "window", "shape", "none", "shape", "cut", "maximum", "cut"]);
    const download = page.waitForEvent("download");
    await page.click("button.primary");
    await page.click(".popover button.primary");
    const saved = join(folder, "walk.png"), again = join(folder, "again.png");
    await (await download).saveAs(saved);
    execFileSync(chiaro, ["render", "--scene", saved, "-o", again, "--quiet"]);
    execFileSync(chiaro, ["compare", saved, again, "--fail-above", "max=0"]);
    assert.deepEqual(faults, []);
  } finally {
    await page.close();
    await own.end("SIGINT");
  }
});
