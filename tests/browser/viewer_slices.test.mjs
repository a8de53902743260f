// Slices beside the volume: on the program, what they show and say; on the mock, what the page makes of it.
import assert from "node:assert/strict";
import { test } from "node:test";
import { desktop, phone, savedScene, visits } from "./mocked.mjs";
import { drawn } from "./page.mjs";
import { servedVisits, skip } from "./served.mjs";
import { drag, eventually, faint, final } from "./visit.mjs";
import { dimensions, fileValue, onFile as fileVisit, place, shown, slices } from "./volume_file.mjs";

const n = dimensions, all = servedVisits(), visit = visits();
const onFile = (name, act, more) => fileVisit(all, name, act, more);
const at = (page) => page.evaluate(() => chiaro.slices.at());
const voxel = (page) => page.evaluate(async () => (await import("./slice-geometry.js")).voxelOf(chiaro.volume, chiaro.slices.at()));
const near = (a, b, by = 1e-6) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) <= by, `${a} and ${b}`));

test("a nearest slice shows and tells the file's own numbers", { skip }, () => onFile("numbers.nrrd", async (page) => {
  await page.keyboard.press("s");
  await shown(page);
  await page.evaluate(() => chiaro.store.set("nearest", (s) => ({ values: { ...s.values, "slices.sampling": "nearest", "slices.window": [32767.5, 65535] } })));
  // One voxel a pixel, centre on centre.
  await page.evaluate(() => {
    const { s, w, h } = chiaro.slices.panes[0].view();
    chiaro.store.set("one", (state) => ({ camera: { ...state.camera, "slices.zoom": s * (state.camera["slices.zoom"] ?? 1), "slices.centre": [-20 + 20 + (w % 2 ? 0 : 0.5), -15 + 15 + (h % 2 ? 0 : 0.5), 30] } }), "camera");
  });
  await shown(page);
  const k = Math.round((await voxel(page))[2]), [x0, y0] = await place(page, 0, [0, 0, k]), box = await page.locator(".slice-picture").first().boundingBox();
  const grey = await page.evaluate(([x, y, w, h]) => [...document.querySelector(".pane .slice-picture > canvas").getContext("2d").getImageData(x, y, w, h).data].filter((_, i) => i % 4 === 0), [Math.floor(x0 - box.x), Math.floor(y0 - box.y), n[0], n[1]]);
  // numpy: np.floor(np.clip((v - 0) / (65535 - 0), 0, 1) * 255 + 0.5)
  const expected = Array.from({ length: n[0] * n[1] }, (_, at) => Math.floor((fileValue(at % n[0], Math.floor(at / n[0]), k) / 65535) * 255 + 0.5));
  assert.deepEqual(grey, expected);
  await page.evaluate(() => chiaro.store.set("all", (state) => ({ camera: { ...state.camera, "slices.zoom": 1, "slices.centre": null } }), "camera"));
  for (const [i, j] of [[3, 4], [39, 29], [20, 0]]) {
    await page.mouse.move(...(await place(page, 0, [i, j, k])));
    await page.waitForSelector(`.read b:text-is("${fileValue(i, j, k)}")`);
    assert.equal(await page.locator(".read").first().textContent(), `${fileValue(i, j, k)}${[i - 20, j - 15, 10 + 2 * k].map((c) => c.toFixed(1).replace("-", "−")).join(", ")} mm LPSvoxel ${i}, ${j}, ${k}`);
  }
  await page.mouse.move(box.x + 5, box.y + 150);
  await page.waitForSelector('.read b:text-is("outside")');
}));

test("one crosshair: a click in a slice or on the volume moves it everywhere; wheel, slider and keys scroll", { skip }, () => onFile("cross.nrrd", async (page) => {
  await slices(page);
  near(await voxel(page), [20, 15, 10]);
  await page.mouse.click(...(await place(page, 0, [31, 8, 10])));
  near(await voxel(page), [31, 8, 10], 0.3);
  await shown(page);
  await page.mouse.click(...(await place(page, 1, [12, 8, 4])));
  near(await voxel(page), [12, 8, 4], 0.3);
  const before = await voxel(page);
  await page.mouse.wheel(0, 100); // over the coronal one
  await eventually(async () => Math.abs((await voxel(page))[1] - 9) < 1e-9, "one slice on, at a voxel's centre");
  near([(await voxel(page))[0]], [before[0]]);
  await page.locator(".slice-slider").nth(2).focus(); // sagittal
  await page.keyboard.press("ArrowRight");
  near([(await voxel(page))[0]], [Math.round(before[0]) + 1]);
  await page.locator(".pane").nth(0).focus();
  await page.keyboard.press("PageUp");
  near([(await voxel(page))[2]], [Math.round(before[2]) + 1]);
  await page.keyboard.press("End");
  near([(await voxel(page))[2]], [19]);
  await page.keyboard.press("ArrowLeft");
  near(await voxel(page), [Math.round(before[0]), 9, 19]);
  assert.equal(await page.locator(".slice-head span").first().textContent(), "20 of 20");
  // The camera's undo takes it back, the design's does not.
  const now = await at(page);
  await page.keyboard.press("Alt+z");
  assert.notDeepEqual(await at(page), now);
  await page.keyboard.press("Alt+Shift+z");
  near(await at(page), now);
  // A click on what is seen in the volume.
  const stage = await page.locator("#stage").boundingBox();
  await page.mouse.click(stage.x + stage.width / 2, stage.y + stage.height / 2);
  await eventually(async () => (await at(page)).some((c, i) => Math.abs(c - now[i]) > 0.5), "the crosshair is on the surface");
  const seen = await page.evaluate(([x, y]) => chiaro.link.ask("pick", { x, y }), [Math.round(stage.width / 2), Math.round(stage.height / 2)]);
  near(await at(page), seen.world_mm, 1e-6);
}));

test("right drag, shift drag and Ctrl with the wheel: window, pan, zoom; slices cost no picture of the volume", { skip }, () => onFile("drags.nrrd", async (page) => {
  await slices(page);
  await final(page);
  const sent = await page.evaluate(() => chiaro.link.n), pane = page.locator(".slice-picture").first(), [low, high] = await page.evaluate(() => chiaro.slices.window());
  await drag(page, pane, 100, -40, { button: "right" });
  const [a, b] = await page.evaluate(() => chiaro.slices.window());
  near([(b - a) / (high - low), ((a + b - low - high) / 2 / (high - low))], [1.25, 0.1]);
  await page.keyboard.down("Shift");
  await drag(page, pane, 30, 10);
  await page.keyboard.up("Shift");
  const view = () => page.evaluate(() => chiaro.slices.panes[0].view());
  const before = await view();
  near([before.middle[0], before.middle[1]], [-0.5 - 30 * before.s, -0.5 - 10 * before.s]);
  const box = await pane.boundingBox(), [px, py] = [box.x + 60, box.y + 50];
  await page.mouse.move(px, py);
  await page.keyboard.down("Control");
  await page.mouse.wheel(0, -200);
  await page.keyboard.up("Control");
  await eventually(async () => (await view()).s < before.s * 0.8, "nearer");
  const { s, w, h, middle } = await view(), world = (v) => [v.middle[0] + (60 - w / 2) * v.s, v.middle[1] + (50 - h / 2) * v.s];
  near(world({ s, middle }), world(before));
  await page.waitForTimeout(400);
  assert.equal(await page.evaluate(() => chiaro.link.n), sent, "the volume was not drawn again");
}));

test("layouts, letters and sides: what stands in the picture follows the file's frame", { skip }, async () => {
  const letters = (page) => page.locator(".pane:not([hidden])").evaluateAll((panes) => panes.map((p) => [...p.querySelectorAll(".letter")].map((l) => l.textContent).join("") + (p.querySelector(".side").textContent ? " " + p.querySelector(".side").textContent[0] : "")));
  const frames = [["lps.nrrd", {}], ["ras.nrrd", { space: "right-anterior-superior", directions: "(0,2,0) (0,0,-1) (1,0,0)" }], ["flipped.nrrd", { directions: "(-1,0,0) (0,0,1) (0,-2,0)" }]];
  for (const [name, more] of frames) await onFile(name, async (page) => {
    await slices(page);
    assert.deepEqual(await letters(page), ["RALP R", "RSLI R", "ASPI"], name);
    await page.evaluate(() => chiaro.slices.put("Side", "side", "neurological"));
    await drawn(page);
    assert.deepEqual(await letters(page), ["LARP N", "LSRI N", "ASPI"], name);
    await page.locator(".pane").nth(1).focus();
    await page.keyboard.press("Enter");
    await drawn(page);
    assert.equal(await page.evaluate(() => chiaro.store.state.values["slices.layout"]), "coronal");
    const boxes = await page.locator(".pane:not([hidden]), #stage").evaluateAll((all) => all.map((e) => e.getBoundingClientRect()).map((b) => b.width * b.height));
    assert.ok(Math.max(...boxes) > 2.5 * boxes.sort((p, q) => q - p)[1], "one is large");
    await page.keyboard.press("s");
    assert.equal(await page.locator(".pane:visible").count(), 0);
  }, more);
  await onFile("none.nrrd", async (page) => {
    await slices(page);
    assert.deepEqual(await letters(page), ["", "", ""]);
    assert.deepEqual(await page.locator(".slice-head b").allTextContents().then((t) => t.slice(0, 3)), ["Across z", "Across y", "Across x"]);
  }, { space: "" });
});

test("an oblique slice follows the clip plane, and scrolling moves it", { skip }, () => onFile("oblique.nrrd", async (page) => {
  await page.evaluate(() => chiaro.store.set("plane", (s) => ({ values: { ...s.values, "clip.planes": [[0, 0.6, 0.8, 24]], "slices.layout": "oblique" } })));
  await shown(page, 4);
  assert.equal(await page.locator(".pane.large b").textContent(), "Along the plane");
  assert.deepEqual(await page.locator(".pane.large .letter").allTextContents(), ["R", "AS", "L", "PI"], "two letters where it is tilted");
  const pane = page.locator(".pane.large .slice-picture"), was = await pane.locator("canvas").getAttribute("data-key");
  await pane.hover();
  await page.mouse.wheel(0, 100);
  await eventually(async () => Math.abs((await page.evaluate(() => chiaro.store.state.values["clip.planes"][0][3])) - 25) < 1e-9, "a voxel on");
  await eventually(async () => (await pane.locator("canvas").getAttribute("data-key")) !== was, "another picture");
}));

test("slices come back with a scene and after a reload, in the colours of the volume too", { skip }, () => onFile("kept.nrrd", async (page) => {
  await slices(page);
  await page.mouse.click(...(await place(page, 0, [31, 8, 10])));
  await page.evaluate(() => chiaro.slices.put("Colours", "colors", "transfer"));
  const grey = () => page.evaluate(() => [...document.querySelector(".pane .slice-picture > canvas").getContext("2d").getImageData(0, 0, 400, 200).data].every((v, i, all) => i % 4 || (v === all[i + 1] && v === all[i + 2])));
  await shown(page);
  assert.equal(await grey(), false);
  const where = await at(page), scene = JSON.parse(await savedScene(page));
  near(scene.slices.at, where);
  assert.equal(scene.slices.colors, "transfer");
  assert.deepEqual([scene.slices.layout, scene.marks], ["linked", undefined]);
  await page.reload();
  await shown(page);
  near(await at(page), where);
  await page.keyboard.press("s");
  await page.evaluate((text) => chiaro.take(new File([text], "scene.json")), JSON.stringify(scene));
  await shown(page);
  near(await at(page), where);
}));

visit("the parts that slices need are loaded when they are first shown", async (page) => {
  const loaded = () => page.evaluate(() => performance.getEntriesByType("resource").map((e) => e.name.split("/").at(-1)).filter((name) => /slice/.test(name)));
  assert.deepEqual(await loaded(), []);
  await page.click("button[aria-label^='Slices']");
  await shown(page);
  assert.ok((await loaded()).includes("slices.js"));
});

visit("the section of the slices: place by number, window, side only where there is one", async (page) => {
  await slices(page);
  await page.click(".s-slices .head");
  const z = page.locator("[aria-label='Crosshair z']");
  await z.fill("12");
  await z.press("Enter");
  near(await at(page), [32, 32, 12]);
  await z.fill("900");
  await z.press("Enter");
  near(await at(page), [32, 32, 63]);
  assert.equal(await page.locator(".s-slices select").count(), 4, "layout, colours, voxels, outlines");
  await page.locator(".s-slices .row[aria-label='Grey levels'] .thumb").first().focus();
  await page.keyboard.press("ArrowRight");
  near(await page.evaluate(() => chiaro.slices.window()), [1, 250]);
  await page.keyboard.press("Control+z");
  near(await page.evaluate(() => chiaro.slices.window()), [0, 250]);
});

for (const colorScheme of ["dark", "light"])
  visit(`slices in the ${colorScheme} theme: legible, named, reached by keys, and nothing overlaps`, async (page) => {
    await slices(page);
    await page.click(".s-slices .head");
    assert.deepEqual(await faint(page), []);
    const nameless = await page.locator(".pane:visible, .pane:visible button, .pane:visible input").evaluateAll((all) => all.filter((e) => !e.getAttribute("aria-label")).map((e) => e.className));
    assert.deepEqual(nameless, []);
    const over = await page.evaluate(() => [...document.querySelectorAll(".pane:not([hidden])")].flatMap((pane) => {
      const boxes = [...pane.querySelectorAll(".slice-head, .tool, .side, .ruler, .letter, .read")].filter((e) => e.textContent || e.matches(".tool")).map((e) => [e.className, e.getBoundingClientRect()]);
      return boxes.flatMap(([a, p], i) => boxes.slice(i + 1).filter(([, q]) => p.left < q.right && q.left < p.right && p.top < q.bottom && q.top < p.bottom).map(([b]) => `${a} over ${b}`));
    }));
    assert.deepEqual(over, []);
    assert.ok(await page.evaluate(() => document.documentElement.scrollHeight <= innerHeight && document.documentElement.scrollWidth <= innerWidth));
  }, { options: { ...desktop, colorScheme } });

visit("with fingers: a tap places the crosshair, two move and pinch, the slider scrolls", async (page) => {
  await page.evaluate(() => chiaro.toggleSlices());
  await shown(page);
  await page.waitForTimeout(100);
  const box = await page.locator(".slice-picture").first().boundingBox(), before = await at(page);
  await page.touchscreen.tap(box.x + box.width * 0.6, box.y + box.height * 0.6);
  await eventually(async () => (await at(page))[0] > before[0] && (await at(page))[1] > before[1], "it went there");
  const wire = await page.context().newCDPSession(page), touch = (type, ...points) => wire.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2], zoom = () => page.evaluate(() => chiaro.slices.get("zoom"));
  await touch("touchStart", [x - 20, y]);
  await touch("touchStart", [x - 20, y], [x + 20, y]);
  for (const gap of [24, 30, 40]) await touch("touchMove", [x - gap, y], [x + gap, y]);
  await touch("touchEnd");
  await eventually(async () => Math.abs((await zoom()) - 2) < 0.2, "twice as near");
  assert.ok(await page.locator(".slice-slider").first().evaluate((e) => e.getBoundingClientRect().height >= 40));
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth && document.querySelector("#bar").scrollWidth <= document.querySelector("#bar").clientWidth));
}, { options: phone });

test("letters name the side in either frame, two where a plane is tilted", async () => {
  const { letterOf } = await import("../../viewer/slice-geometry.js");
  for (const [world, side] of [["LPS", 1], ["RAS", -1]])
    for (const [axis, to, from] of [[0, "L", "R"], [1, "P", "A"], [2, "S", "I"]])
      for (const sign of [1, -1]) {
        const d = [0, 0, 0];
        d[axis] = sign * (axis < 2 ? side : 1);
        assert.equal(letterOf(d, world), sign > 0 ? to : from);
        assert.equal(letterOf(d, "unknown"), "");
      }
  assert.equal(letterOf([1, 0.3, 0], "LPS"), "L");
  assert.equal(letterOf([1, -0.6, 0], "LPS"), "LA");
});
