// Measuring: distances, angles, regions, profiles and notes, on slices and on the volume.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { desktop, phone, savedScene, visits } from "./mocked.mjs";
import { drawn } from "./page.mjs";
import { servedVisits, skip } from "./served.mjs";
import { chooseTool, drag, eventually, faint } from "./visit.mjs";
import { fileValue, onFile, onVolume, place, shown, slices } from "./volume_file.mjs";

const all = servedVisits(), visit = visits();
const marks = (page) => page.evaluate(() => structuredClone(chiaro.store.state.marks));
const close = (a, b, by, why = "") => assert.ok(Math.abs(a - b) <= by, `${why} ${a} and ${b}`);
const near = (a, b, by = 1e-9) => a.forEach((x, i) => close(x, b[i], by, `${a} and ${b}`));
const length = ([a, b]) => Math.hypot(...a.map((c, i) => c - b[i]));
async function measuring(page, kind = "distance") {
  await page.evaluate(() => chiaro.gestures.choose("measure"));
  await page.click(`[data-kind=${kind}]`);
}
const count = (page, n) => page.waitForFunction((c) => chiaro.store.state.marks.length === c, n, { polling: 20 });
const value = (page, i) => page.locator(".mark-value").nth(i);

test("distances between edges are right to a tenth of a voxel: ball and slab, in slices and on the volume", { skip }, async () => {
  await onVolume(all, "sample:ball:64", async (page) => {
    await slices(page);
    await measuring(page);
    // Two pixels off the rim, at the left and at the right of the slice through the middle.
    const [x0, y] = await place(page, 0, [31.5 - 24, 31.5, 32]), [x1] = await place(page, 0, [31.5 + 24, 31.5, 32]);
    await page.mouse.click(x0 + 2, y);
    await page.mouse.click(x1 - 2, y);
    await count(page, 1);
    close(length((await marks(page))[0].points), 2 * Math.sqrt(24 ** 2 - 0.5 ** 2), 0.1, "the ball's width");
    // From where the volume is seen to the same place again: a click on it lies on the surface.
    const stage = await page.locator("#stage").boundingBox();
    await page.mouse.click(stage.x + stage.width / 2, stage.y + stage.height / 2);
    await page.waitForFunction(() => chiaro.marks.draft?.points.length === 1);
    await page.mouse.click(stage.x + stage.width / 2 + 40, stage.y + stage.height / 2 + 10);
    await count(page, 2);
    for (const p of (await marks(page))[1].points) close(length([p, [31.5, 31.5, 31.5]]), 24, 0.1, "on the ball");
  });
  await onVolume(all, "sample:slab:64", async (page) => {
    await slices(page);
    await measuring(page);
    const [x, y0] = await place(page, 1, [20, 32, 15.5]), [, y1] = await place(page, 1, [20, 32, 47.5]);
    await page.mouse.click(x, y0 - 2);
    await page.mouse.click(x, y1 + 1);
    await count(page, 1);
    const [[a, b]] = (await marks(page)).map((m) => m.points);
    close(Math.abs(a[2] - b[2]), 32, 0.1, "the slab's thickness");
    // An angle between its face and its normal.
    await page.click("[data-kind=angle]");
    const [xr] = await place(page, 1, [50, 32, 15.5]), [, ym] = await place(page, 1, [20, 32, 30]);
    for (const p of [[xr, y0 + 2], [x, y0 - 1], [x, ym]]) await page.mouse.click(...p);
    await count(page, 2);
    await eventually(async () => /°$/.test(await value(page, 1).textContent()), "degrees");
    close(parseFloat(await value(page, 1).textContent()), 90, 0.2, "a right angle");
  });
});

test("without snapping a click is within a pixel, in mm of a tilted, anisotropic volume", { skip }, () => onFile(all, "tilted.nrrd", async (page) => {
  await slices(page);
  await measuring(page);
  await page.evaluate(() => (chiaro.marks.reach = 0));
  await page.mouse.click(...(await place(page, 0, [5, 6, 10])));
  await page.mouse.click(...(await place(page, 0, [33, 21, 10])));
  await count(page, 1);
  const s = await page.evaluate(() => chiaro.slices.panes[0].view().s), d = [28 * 0.8 - 15 * 0.9, 28 * 0.6 + 15 * 1.2];
  close(length((await marks(page))[0].points), Math.hypot(...d), 2 * s, "mm");
  assert.equal(await value(page, 0).textContent(), `${Number(length((await marks(page))[0].points).toPrecision(4))} mm`);
}, { directions: "(0.8,0.6,0) (-0.9,1.2,0) (0,0,2)" }));

test("a ball and a box hold the voxels whose centres lie in them; their numbers are numpy's", { skip }, () => onFile(all, "region.nrrd", async (page) => {
  await slices(page);
  await measuring(page, "box");
  const from = await place(page, 0, [5.4, 6.6, 10]), to = await place(page, 0, [12.3, 10.2, 10]);
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(...to, { steps: 5 });
  await page.mouse.up();
  await count(page, 1);
  await page.waitForSelector(".mark-details dd");
  const numbers = (voxels) => {
    const v = voxels.sort((a, b) => a - b), mean = v.reduce((a, b) => a + b) / v.length, q = (p) => { const at = p * (v.length - 1), i = Math.floor(at); return v[i] + (at - i) * ((v[i + 1] ?? v[i]) - v[i]); };
    return { count: v.length, mean, deviation: Math.sqrt(v.reduce((s, x) => s + (x - mean) ** 2, 0) / (v.length - 1)), min: v[0], max: v.at(-1), p25: q(0.25), p50: q(0.5), p95: q(0.95) };
  };
  const seen = (i) => page.evaluate((k) => chiaro.marks.region(chiaro.store.state.marks[k]), i);
  const check = async (i, expected) => {
    const r = await seen(i), by = (a, b) => close(a, b, 1e-9 * Math.max(1, Math.abs(b)));
    assert.equal(r.count, expected.count);
    for (const key of ["mean", "deviation", "min", "max"]) by(r[key], expected[key]);
    for (const p of ["25", "50", "95"]) by(r.percentiles[p], expected[`p${p}`]);
    by(r.volume_mm3, 2 * r.count);
  };
  const inside = (test_) => [...Array(40 * 30 * 20).keys()].map((at) => [at % 40, Math.floor(at / 40) % 30, Math.floor(at / 1200)]).filter(test_).map((v) => fileValue(...v));
  await check(0, numbers(inside(([i, j, k]) => i >= 6 && i <= 12 && j >= 7 && j <= 10 && k === 10)));
  assert.match(await page.locator(".mark-details").textContent(), /Voxels28Mean.*Volume of the voxels56 mm³/);
  // A ball by numbers.
  await page.evaluate(() => chiaro.store.set("ball", (s) => ({ marks: [...s.marks, { kind: "ball", points: [[0, 0, 30], [4.2, 0, 30]] }] })));
  await value(page, 1).click();
  await page.waitForFunction(() => chiaro.marks.region(chiaro.store.state.marks[1])?.count);
  await check(1, numbers(inside(([i, j, k]) => Math.hypot(i - 20, j - 15, 10 + 2 * k - 30) <= 4.2)));
  close((await seen(1)).exact_mm3, (4 / 3) * Math.PI * 4.2 ** 3, 1e-6);
  for (const [n, x] of [[1, 500], [2, 501]]) {
    const field = page.locator(`[aria-label='Ball 1, point ${n} x']`);
    await field.fill(String(x));
    await field.press("Enter");
  }
  await page.waitForSelector(".mark-details:has-text(\"No voxel's centre lies in it.\")");
}));

test("a profile has the values along its line, and saves them", { skip }, () => onFile(all, "profile.nrrd", async (page) => {
  await page.evaluate(() => chiaro.store.set("profile", () => ({ marks: [{ kind: "profile", points: [[-15, -10, 30], [10, -10, 30]] }] })));
  await value(page, 0).click();
  await page.waitForSelector(".mark-plot svg[aria-label^='Values along the line, 30']");
  const { values, step } = await page.evaluate(() => chiaro.marks.profile(chiaro.store.state.marks[0]));
  assert.equal(values.length, 51);
  values.forEach((v, i) => close(v, fileValue(5 + i * step, 5, 10), 1e-9));
  const download = page.waitForEvent("download");
  await page.click("button:has-text('Save the profile')");
  const lines = readFileSync(await (await download).path(), "utf8").trim().split("\r\n");
  assert.deepEqual([lines[0], lines[1], lines.length], ["distance_mm,value", "0,30505", 52]);
}));

test("marks are kept in the scene, in undo and over a reload; the tool reads them and refuses wrong ones", { skip }, () => onFile(all, "kept-marks.nrrd", async (page) => {
  await slices(page);
  await measuring(page, "polyline");
  for (const p of [[5, 5, 10], [20, 8, 10], [22, 20, 10]]) await page.mouse.click(...(await place(page, 0, p)));
  await page.mouse.dblclick(...(await place(page, 0, [30, 22, 10])));
  await count(page, 1);
  assert.equal((await marks(page))[0].points.length, 4, "the double click's second press is no point");
  await page.click("[data-kind=text]");
  await page.mouse.click(...(await place(page, 0, [8, 20, 10])));
  await count(page, 2);
  await page.waitForFunction(() => document.activeElement?.closest(".mark-row"));
  await page.keyboard.type("=SUM(1), \"here\"");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => chiaro.store.state.marks[1].text);
  const kept = await marks(page), scene = await savedScene(page);
  assert.deepEqual(JSON.parse(scene).marks, kept);
  await page.evaluate(() => document.activeElement.blur());
  for (const n of [2, 1, 0]) await page.keyboard.press("Control+z"), await page.waitForFunction((c) => chiaro.store.state.marks.length === c, n);
  await page.evaluate((text) => chiaro.take(new File([text], "scene.json")), scene);
  await count(page, 2);
  assert.equal(await savedScene(page), scene, "the same bytes");
  await page.reload();
  await count(page, 2);
  await page.waitForSelector(".mark-row");
  assert.deepEqual(await marks(page), kept);
  await page.evaluate((text) => chiaro.take(new File([text.replace('"kind": "text"', '"kind": "ruler"')], "scene.json")), scene);
  await page.waitForSelector(".banner[role=alert]:has-text('marks[1]: kind: must be one of distance, polyline')");
  // The table, for a spreadsheet.
  const download = page.waitForEvent("download");
  await page.click("button:has-text('Save as CSV')");
  const csv = readFileSync(await (await download).path(), "utf8").split("\r\n");
  assert.match(csv[0], /^name,kind,length_or_radius_mm,angle_degrees,voxels,mean,.*,unit_of_values,frame,points_mm$/);
  const total = kept[0].points.slice(1).reduce((sum, p, i) => sum + length([p, kept[0].points[i]]), 0);
  assert.equal(csv[1].split(",").slice(0, 3).join(), `Path 1,polyline,${total}`);
  assert.match(csv[2], /^"'=SUM\(1\), ""here""",text,/);
  assert.match(csv[1], /,LPS,/);
}, {}, { allowed: /422/ }));

test("a saved figure carries what was measured, where it is", { skip }, () => onFile(all, "figure.nrrd", async (page) => {
  const saved = async (tick) => {
    await page.click("button.primary");
    const box = page.locator(".popover").getByLabel("Measurements");
    await box.waitFor();
    assert.equal(await box.count(), 1);
    await box.setChecked(tick);
    const download = page.waitForEvent("download");
    await page.click(".popover button.primary");
    return [...readFileSync(await (await download).path())];
  };
  await page.evaluate(() => chiaro.store.set("d", () => ({ marks: [{ kind: "distance", points: [[-15, -10, 20], [10, 10, 40]], text: "across" }] })));
  await page.waitForSelector(".mark-row");
  const middle = await page.evaluate(async () => {
    const { project } = await import("./camera.js"), [w, h] = chiaro.frame.size();
    return project(chiaro.view(), [-2.5, 0, 30], w, h).map(Math.round);
  });
  const colour = (bytes) => page.evaluate(async ([data, [x, y]]) => {
    const image = await createImageBitmap(new Blob([Uint8Array.from(data)])), g = new OffscreenCanvas(image.width, image.height).getContext("2d");
    g.drawImage(image, 0, 0);
    return [...g.getImageData(x - 1, y - 1, 3, 3).data];
  }, [bytes, middle]);
  const accent = (data) => [...Array(9).keys()].some((i) => data[4 * i] > 215 && data[4 * i + 1] > 160 && data[4 * i + 1] < 200 && data[4 * i + 2] < 110);
  assert.equal(accent(await colour(await saved(true))), true);
  assert.equal(accent(await colour(await saved(false))), false);
}));

test("a slice is saved as a figure: twice as fine, with its name, ruler and what was measured", { skip }, () => onFile(all, "slice-figure.nrrd", async (page) => {
  await slices(page);
  await page.evaluate(() => chiaro.store.set("d", () => ({ marks: [{ kind: "distance", points: [[-15, 0, 30], [15, 0, 30]] }] })));
  await page.waitForSelector(".mark-row");
  await page.click(".s-slices .head");
  const download = page.waitForEvent("download");
  await page.click("[aria-label='Save as a picture'] button:has-text('Axial')");
  const saved = await download, bytes = [...readFileSync(await saved.path())];
  assert.equal(saved.suggestedFilename(), "axial.png");
  const [x, y] = await page.evaluate(async () => (await import("./slice-geometry.js")).worldToPixel(chiaro.slices.panes[0].view(), [0, 0, 30]));
  const { size, line, corner } = await page.evaluate(async ([data, px, py]) => {
    const image = await createImageBitmap(new Blob([Uint8Array.from(data)])), g = new OffscreenCanvas(image.width, image.height).getContext("2d");
    g.drawImage(image, 0, 0);
    return { size: [image.width, image.height], line: [...g.getImageData(Math.round(2 * px), Math.round(2 * py), 1, 1).data], corner: [...g.getImageData(20, 10, 100, 40).data].some((v) => v > 240) };
  }, [bytes, x, y]);
  assert.deepEqual(size, await page.evaluate(() => { const { w, h } = chiaro.slices.panes[0].view(); return [2 * w, 2 * h]; }));
  assert.ok(line[0] > 215 && line[2] < 110, `${line}`);
  assert.ok(corner, "the name");
}));

visit("what measuring needs is loaded when it is first used; Escape and Backspace take back", async (page) => {
  const loaded = () => page.evaluate(() => performance.getEntriesByType("resource").map((e) => e.name.split("/").at(-1)).filter((name) => /^mark/.test(name) && name !== "markers.js"));
  assert.deepEqual(await loaded(), []);
  await slices(page);
  await chooseTool(page, "m", "measure");
  await page.keyboard.up("m");
  await page.waitForSelector(".mark-kinds");
  assert.ok((await loaded()).includes("marks.js"));
  const pane = await page.locator(".slice-picture").first().boundingBox();
  await page.mouse.click(pane.x + 60, pane.y + 60);
  await page.waitForFunction(() => chiaro.marks.draft?.points.length === 1);
  await page.keyboard.press("Escape");
  assert.equal(await page.evaluate(() => chiaro.marks.draft), null);
  await page.mouse.click(pane.x + 60, pane.y + 60);
  await page.waitForFunction(() => chiaro.marks.draft?.points.length === 1);
  await page.keyboard.press("Backspace");
  await page.waitForFunction(() => !chiaro.marks.draft);
  await page.mouse.move(pane.x + 60, pane.y + 60);
  await page.mouse.down();
  await page.mouse.move(pane.x + 160, pane.y + 60, { steps: 4 });
  await page.mouse.up();
  await count(page, 1);
});

visit("by keys alone: kinds by arrows, points at the crosshair, points moved, a mark removed", async (page) => {
  await slices(page);
  await chooseTool(page, "m", "measure");
  await page.keyboard.up("m");
  await page.waitForSelector(".mark-kinds");
  await page.locator("[data-kind=distance]").focus();
  await page.keyboard.press("ArrowRight");
  assert.equal(await page.evaluate(() => chiaro.marks.kind), "polyline");
  await page.keyboard.press("ArrowLeft");
  const pane = page.locator(".pane").first();
  await pane.focus();
  await page.keyboard.press(" ");
  await page.waitForFunction(() => chiaro.marks.draft?.points.length === 1);
  for (let i = 0; i < 3; ++i) await page.keyboard.press("ArrowRight");
  for (let i = 0; i < 4; ++i) await page.keyboard.press("ArrowDown");
  await page.keyboard.press(" ");
  await count(page, 1);
  close(length((await marks(page))[0].points), 5, 1e-6);
  const handle = pane.locator(".mark-point").nth(1);
  assert.equal(await handle.getAttribute("aria-label"), "Distance 1, point 2");
  const before = (await marks(page))[0].points[1];
  await handle.focus();
  await page.keyboard.press("ArrowRight");
  near((await marks(page))[0].points[1], [before[0] + 1, before[1], before[2]], 1e-6);
  const field = page.locator("[aria-label='Distance 1, point 1 y']");
  await field.fill("12.5");
  await field.press("Enter");
  assert.equal((await marks(page))[0].points[0][1], 12.5);
  await page.locator("[data-kind=polyline]").click();
  await pane.focus();
  for (const key of [" ", "ArrowUp", " ", "ArrowUp", "ArrowUp", " ", "Enter"]) await page.keyboard.press(key);
  await count(page, 2);
  assert.equal((await marks(page))[1].points.length, 3);
  await page.keyboard.press("Control+z");
  await count(page, 1);
  await value(page, 0).click();
  await drawn(page);
  await handle.focus();
  await page.keyboard.press("Delete");
  await count(page, 0);
  await page.keyboard.press("Control+z");
  await count(page, 1);
});

visit("a point is dragged, in a slice and on the volume; each drag is a step", async (page) => {
  await slices(page);
  await page.evaluate(() => chiaro.store.set("d", () => ({ marks: [{ kind: "distance", points: [[20, 20, 32], [44, 30, 32]] }] })));
  await page.waitForSelector(".mark-row");
  await value(page, 0).click();
  await drawn(page);
  const { s } = await page.evaluate(() => chiaro.slices.panes[0].view());
  await drag(page, page.locator(".pane").first().locator(".mark-point").nth(0), 30, -20);
  near((await marks(page))[0].points[0], [20 + 30 * s, 20 - 20 * s, 32], 1e-6);
  await drag(page, page.locator("#stage .mark-point").nth(1), 25, 0);
  const moved = await page.evaluate(async () => {
    const { project } = await import("./camera.js"), at = (p) => project(chiaro.view(), p, document.querySelector("#stage").clientWidth, document.querySelector("#stage").clientHeight);
    return at(chiaro.store.state.marks[0].points[1])[0] - at([44, 30, 32])[0];
  });
  close(moved, 25, 0.01, "pixels");
  await page.keyboard.press("Control+z");
  near((await marks(page))[0].points[1], [44, 30, 32]);
  await page.keyboard.press("Control+z");
  near((await marks(page))[0].points[0], [20, 20, 32]);
});

visit("with fingers: two taps measure, and the points can be dragged", async (page) => {
  await slices(page);
  await page.evaluate(() => chiaro.gestures.choose("measure"));
  await page.waitForSelector(".mark-kinds");
  assert.equal(await page.locator(".s-marks").isVisible(), true, "its tab is shown");
  const box = await page.locator(".slice-picture").first().boundingBox();
  await page.touchscreen.tap(box.x + 60, box.y + 50);
  await page.touchscreen.tap(box.x + 120, box.y + 70);
  await count(page, 1);
  await page.click("[data-kind=polyline]");
  for (const [x, y] of [[30, 30], [80, 60], [100, 90], [100, 90]]) await page.touchscreen.tap(box.x + x, box.y + y);
  await count(page, 2);
  assert.equal((await marks(page))[1].points.length, 3, "a double tap ends a path");
  await page.evaluate(() => chiaro.store.step("undo"));
  await value(page, 0).click();
  const size = await page.locator(".slice-picture .mark-point").first().boundingBox();
  assert.ok(size.width >= 44 && size.height >= 44);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth && document.querySelector("#sections").scrollWidth <= document.querySelector("#sections").clientWidth));
}, { options: phone });

for (const colorScheme of ["dark", "light"])
  visit(`measurements in the ${colorScheme} theme: legible and named`, async (page) => {
    await slices(page);
    await page.evaluate(() => chiaro.store.set("d", () => ({ marks: [{ kind: "ball", points: [[20, 20, 32], [24, 20, 32]] }, { kind: "profile", points: [[20, 20, 32], [44, 30, 32]] }, { kind: "arrow", points: [[20, 20, 32], [44, 30, 32]], text: "here" }] })));
    await page.evaluate(() => chiaro.gestures.choose("measure"));
    for (const i of [1, 0]) await value(page, i).click(), await drawn(page);
    await page.waitForSelector(".mark-details dd");
    assert.deepEqual(await faint(page), []);
    const nameless = await page.locator(".s-marks :is(button, input):visible, .mark-point:visible").evaluateAll((all) => all.filter((e) => !(e.getAttribute("aria-label") || e.textContent.trim())).map((e) => e.outerHTML));
    assert.deepEqual(nameless, []);
    await page.keyboard.press("i");
    await page.waitForSelector(".popover dd:has-text('Not for diagnosis.')");
  }, { options: { ...desktop, colorScheme } });
