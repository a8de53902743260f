// Parts of the viewer's page on a mock of its server: names, own looks, planes, touch, banners, the sixth method.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { gzipSync } from "node:zlib";
import { scene, volume } from "./mock.mjs";
import { desktop, phone, savedScene, visits } from "./mocked.mjs";
import { drawn } from "./page.mjs";
import { chooseTool, drag, eventually, faint, final, pixels, settled, state } from "./visit.mjs";

const visit = visits();
const chip = (page, i) => page.locator(".chips .chip").nth(i);

visit("a peak is named by a double click or F2, and its name is saved and loaded", async (page, mock) => {
  await chip(page, 0).dblclick();
  await page.keyboard.type("Leaves");
  await page.mouse.move(500, 400); // resting on a chip is a preview
  await settled(page, () => page.keyboard.press("Enter"));
  assert.equal(await chip(page, 0).textContent(), "Leaves30 to 60");
  assert.deepEqual(mock.last("state").scene.transfer_function.points.map((p) => p.name).filter(Boolean), ["Leaves"]);
  await chip(page, 1).focus();
  await page.keyboard.press("F2");
  await page.keyboard.type("Wood, pot");
  await settled(page, () => page.keyboard.press("Enter"));
  await settled(page, () => drag(page, page.locator(".point").nth(2), 4, 20));
  assert.equal(await page.locator("button[title='Undo: opacity of Leaves']").count(), 1, "undo calls it so");
  const first = await savedScene(page);
  assert.deepEqual(JSON.parse(first).transfer_function.points.filter((p) => p.name).map((p) => [p.value, p.name]), [[30 + (await state(page)).tf.points[1].value - 30, "Leaves"], [96, "Wood, pot"]]);
  await settled(page, () => page.click("[data-look=simulation]"));
  assert.equal(await page.locator(".chip b").count(), 0);
  await settled(page, () => page.evaluate((text) => chiaro.take(new File([text], "scene.json")), first));
  await page.waitForSelector(".chip b:has-text('Leaves')");
  assert.equal(await savedScene(page), first);
});

visit("Esc leaves a peak without a name", async (page) => {
  await chip(page, 0).dblclick();
  await page.keyboard.type("Lea");
  await page.keyboard.press("Escape");
  await page.waitForSelector("button.chip:has-text('30 to 60')");
  assert.ok((await state(page)).tf.points.every((p) => !p.name));
});

visit("a look of one's own is saved under Mine, taken, found after a reload and removed", async (page, mock) => {
  await settled(page, () => drag(page, page.locator(".point").nth(2), 4, 20));
  await page.waitForSelector(".says:has-text('Glass, edited')");
  const own = (await state(page)).tf;
  await page.click(".says");
  await page.fill("[aria-label='Name of this look']", "My leaves");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".says:has-text('My leaves')");
  await settled(page, () => page.click("[data-look=simulation]"));
  await page.reload();
  await final(page);
  await settled(page, () => page.click("[data-look='mine:My leaves']"));
  assert.deepEqual((await state(page)).tf.points, own.points);
  const values = own.points.map((p) => p.value);
  await eventually(() => mock.heard.some((m) => m.type === "look" && values.every((v) => m.scene.transfer_function.points.some((p) => p.value === v))), "its thumbnail was asked for");
  await page.click(".says");
  assert.ok((await page.locator(".popover h2").allTextContents()).includes("Mine"));
  await page.click("[aria-label='Remove: My leaves']");
  assert.equal(await page.locator("[data-look='mine:My leaves']").count(), 0);
});

visit("thumbnails go on where a drag stopped them", async (page, mock) => {
  await page.waitForFunction(() => chiaro.frame.last?.stage === "final");
  const asked = () => mock.heard.filter((m) => m.type === "look").length;
  await eventually(() => asked() >= 3, "three thumbnails");
  assert.equal(asked(), 3, "one a look");
  let held = null;
  mock.reply = (m) => (m.type === "look" && !held ? ((held = m), null) : undefined);
  await settled(page, () => drag(page, page.locator("#stage"), 60, 0));
  await eventually(() => held, "a thumbnail is being made");
  await drag(page, page.locator(".point").nth(2), 4, 20, { release: false });
  mock.reply = () => undefined;
  for (const peer of mock.sockets) peer.send(JSON.stringify({ type: "answer", re: held.id }));
  await page.waitForTimeout(200);
  const before = asked();
  await settled(page, () => page.mouse.up());
  await eventually(() => asked() >= before + 2, "thumbnails go on");
  assert.equal(asked(), before + 2, "the two that were left");
});

visit("thumbnails do not wait for slow light", async (page, mock) => {
  mock.heard.length = 0;
  mock.stage = "full"; // and no further
  await page.evaluate(() => chiaro.turnTo("+x"));
  await page.waitForFunction(() => chiaro.frame.last?.stage === "full" && chiaro.frame.last.n === chiaro.link.n);
  const turned = () => mock.heard.filter((m) => m.type === "look" && m.scene.camera.azimuth_deg === 0).length;
  await eventually(() => turned() >= 3, "thumbnails of the new view");
  assert.equal(turned(), 3);
});

visit("a plane is pulled by its handle and tilted by its rim, with the pointer and with keys", async (page, mock) => {
  await page.click(".s-cut .head");
  await settled(page, () => page.click("button:has-text('Add a plane')"));
  const plane = () => mock.last("state").scene.clip.planes[0], handle = page.locator(".planes button");
  const [x, y, z, d] = plane(), close = (a, b, why) => assert.ok(Math.abs(a - b) < 1e-3, `${why}: ${a} and ${b}`);
  close(Math.hypot(x, y, z), 1, "normal");
  // It faces the eye: up moves it nearer.
  await settled(page, () => drag(page, handle, 0, -60));
  const pulled = plane();
  assert.ok(pulled[3] > d + 1, `${pulled[3]} > ${d}`);
  close(pulled[0], x, "a pull keeps the normal");
  const rim = await page.locator(".planes path").evaluate((path) => ((b) => [b.x, b.y + b.height / 2 + document.querySelector("#stage").getBoundingClientRect().top])(path.getBBox()));
  await page.mouse.move(...rim);
  await page.mouse.down();
  await page.mouse.move(rim[0] + 80, rim[1], { steps: 5 });
  await settled(page, () => page.mouse.up());
  const turned = plane(), cosine = turned[0] * x + turned[1] * y + turned[2] * z;
  close(Math.hypot(...turned.slice(0, 3)), 1, "normal");
  assert.ok(cosine < 0.95 && cosine > 0.3, `tilted by ${(Math.acos(cosine) * 180) / Math.PI}°`);
  await page.keyboard.press("Control+z");
  await settled(page, () => page.keyboard.press("Control+z"));
  assert.deepEqual(plane(), [x, y, z, d], "each drag is a step");
  await handle.focus();
  await settled(page, () => page.keyboard.press("Shift+ArrowUp"));
  close(plane()[0] * x + plane()[1] * y + plane()[2] * z, Math.cos(Math.PI / 36), "5°");
  await chooseTool(page, "o", "orbit");
  assert.equal(await handle.isVisible(), false, "only while Cut is chosen");
});

visit("a tool's key switches to it; used while it is held, it is only borrowed", async (page) => {
  const tool = () => page.evaluate(() => chiaro.ui.tool);
  await chooseTool(page, "c", "cut");
  assert.equal(await tool(), "cut");
  await chooseTool(page, "o", "orbit");
  await page.keyboard.down("l");
  await settled(page, () => drag(page, page.locator("#stage"), 40, 0));
  await page.keyboard.up("l");
  assert.equal(await tool(), "orbit");
  assert.equal((await state(page)).values["shading.light"][0], 35 + 20);
});

visit("the numbers of the window are not cut off", async (page) => {
  await page.waitForSelector(".row[aria-label=Window]");
  const cut = await page.locator(".row[aria-label=Window] input").evaluateAll((all) => all.filter((i) => i.scrollWidth > i.clientWidth).map((i) => i.value));
  assert.deepEqual(cut, []);
}, { prepare: (m) => {
  const range = [-1024, 3071], points = [[-1024, 0], [3071, 1]].map(([value, opacity]) => ({ value, opacity, rgb: [1, 1, 1] }));
  m.hello = { volume: { ...volume, range, type: "int16", histogram512: { ...volume.histogram512, min: -1024, max: 3071 } }, scene: { ...scene, transfer_function: { points, opacity_unit_distance: 1 } } };
} });

visit("a face of the box is pulled on the picture while Cut is chosen; elsewhere it turns", async (page, mock) => {
  await chooseTool(page, "c", "cut");
  await page.keyboard.up("c");
  const before = await state(page);
  await settled(page, () => drag(page, page.locator("#stage"), 0, -60));
  const box = mock.last("state").scene.clip.box;
  assert.equal(box.filter((c, i) => c !== i % 2).length, 1, `one face has moved: ${box}`);
  assert.deepEqual((await state(page)).camera, before.camera);
  await page.mouse.move(20, 80);
  await page.mouse.down();
  await page.mouse.move(80, 80, { steps: 4 });
  await settled(page, () => page.mouse.up());
  assert.deepEqual(mock.last("state").scene.clip.box, box);
  assert.notDeepEqual((await state(page)).camera, before.camera);
});

test("a tilted plane keeps its point and turns by the angle asked for", async () => {
  const { frameOf, onSphere, pulled, tilted } = await import("../../viewer/planes.js");
  const box = { centre: [10, 20, 30] }, frame = frameOf([0, 0, 2, 80], box), near = (a, b) => a.forEach((v, i) => assert.ok(Math.abs(v - b[i]) < 1e-12, `${a} ${b}`));
  near(frame.at, [10, 20, 40]);
  const angle = 0.3, to = frame.u.map((c, i) => c * Math.cos(angle) + frame.normal[i] * Math.sin(angle)), plane = tilted(frame, frame.u, to);
  near([plane[0] * 10 + plane[1] * 20 + plane[2] * 40], [plane[3]]);
  near([plane[2]], [Math.cos(angle)]);
  near([plane[0] * to[0] + plane[1] * to[1] + plane[2] * to[2]], [0]);
  near(onSphere({ from: [0, 0, 50], along: [0, 0, -2] }, [0, 0, 0], 5, [0, 0, -1]), [0, 0, -1]);
  near(onSphere({ from: [9, 0, 50], along: [0, 0, -2] }, [0, 0, 0], 5, [0, 0, -1]), [1, 0, 0]);
  const view = { perspective: false, half: 100, right: [1, 0, 0], up: [0, 1, 0], forward: [0, 0, -1], eye: [0, 0, 9] };
  near([pulled(view, [1, 0, 0], [0, 0, 0], 30, 7, 200), pulled(view, [0, 0, 1], [0, 0, 0], 30, -7, 200)], [30, 7]);
});

visit("a finger that rests reads the value; dragged on it changes the opacity", async (page) => {
  const touch = await page.context().newCDPSession(page), box = await page.locator("#stage").boundingBox(), r = 0.4 * Math.min(box.width, box.height);
  const [x, y] = [box.x + box.width / 2 + 0.2 * r, box.y + box.height / 2], before = await state(page);
  const send = (type, points) => touch.send("Input.dispatchTouchEvent", { type, touchPoints: points });
  await send("touchStart", [{ x, y }]);
  await page.waitForSelector(".seen div:visible");
  assert.match(await page.locator(".seen").textContent(), /^5[01]/);
  await send("touchEnd", []);
  assert.deepEqual(await state(page), before, "reading changes nothing");
  await send("touchStart", [{ x, y }]);
  await page.waitForTimeout(600);
  for (let i = 1; i <= 5; ++i) await send("touchMove", [{ x, y: y - 20 * i }]);
  await send("touchEnd", []);
  const now = await state(page), added = now.tf.points.find((p) => !before.tf.points.some((q) => q.value === p.value));
  assert.ok(added && Math.abs(added.value - 51) < 1, "a point for what was seen");
  assert.deepEqual(now.camera, before.camera, "the picture did not turn");
  await send("touchStart", [{ x, y }]);
  for (let i = 1; i <= 5; ++i) await send("touchMove", [{ x: x + 10 * i, y }]);
  await send("touchEnd", []);
  assert.notDeepEqual((await state(page)).camera, before.camera, "a quick drag turns");
}, { options: phone });

visit("a phone's menu has what its bar has no room for; banners show all they say", async (page, mock) => {
  const menu = (item) => page.click("button[aria-label=More]").then(() => page.click(`.item:has-text("${item}")`));
  await settled(page, () => menu("Maximum"));
  assert.equal(mock.last("state").scene.mode, "mip");
  await settled(page, () => page.click("button[aria-label=Undo]"));
  await settled(page, () => menu("Redo"));
  assert.equal(mock.last("state").scene.mode, "mip");
  await menu("Compare");
  await page.waitForSelector(".figures:has-text('SSIM')");
  const boxes = await page.locator(".label-float").evaluateAll((all) => all.map((e) => e.getBoundingClientRect().toJSON()));
  assert.ok(boxes[0].right <= boxes[1].left && boxes[2].right <= 390, JSON.stringify(boxes));
  await page.keyboard.press("Escape");
  await mock.stop();
  await page.waitForSelector(".banner:has-text('Connection lost')");
  const banner = await page.locator(".banner").evaluate((b) => ({ cut: b.querySelector("span").scrollWidth > b.querySelector("span").clientWidth, right: b.getBoundingClientRect().right, try: b.querySelector("button").getBoundingClientRect().right }));
  assert.ok(!banner.cut && banner.try <= banner.right && banner.right <= 390, JSON.stringify(banner));
}, { options: phone, allowed: /WebSocket|ERR_CONNECTION/ });

visit("out of memory: the sentence and the two things that would help", async (page, mock) => {
  await settled(page, () => page.click("[data-method=visibility]"));
  const refused = { type: "error", code: "memory", field: null, sentence: "Needs 6.2 GB, 3.9 GB are free." };
  const refuse = () => { for (const peer of mock.sockets) peer.send(JSON.stringify({ ...refused, re: null, n: mock.last("state").n })); };
  refuse();
  await page.waitForSelector(".banner[role=alert]:has-text('Needs 6.2 GB, 3.9 GB are free.')");
  await settled(page, () => page.click(".banner button:has-text('Coarser light')"));
  assert.equal(mock.last("state").scene.lighting.subsample, 4);
  assert.equal(await page.locator(".banner").count(), 0);
  refuse();
  await settled(page, () => page.click(".banner button:has-text('Half size')"));
  assert.equal(mock.last("open").half, true);
  assert.equal(mock.last("state").scene.lighting.subsample, 4, "all settings are kept");
  await settled(page, () => page.click("[data-method=none]"));
  refuse();
  assert.equal(await page.locator(".banner button:has-text('Coarser light')").count(), 0, "not what would not help");
});

visit("a volume that was reduced: told once over the picture, then a dot and a line in About", async (page) => {
  const sentence = "Shown at half size (1024³ of 2048³) to fit 4.0 GB. Saved pictures use the same.";
  assert.equal(await page.locator(".banner span").textContent(), sentence);
  await page.click(".banner button:has-text('Details')");
  await page.waitForSelector(`.popover dd:has-text("${sentence}")`);
  await page.keyboard.press("Escape");
  await page.click(".banner button[aria-label=Close]");
  assert.equal(await page.locator(".file .dot").getAttribute("title"), sentence);
}, { prepare: (m) => (m.hello = { volume: { ...volume, reduced: { from: [2048, 2048, 2048], to: [1024, 1024, 1024], bytes: 4e9 } } }) });

visit("what could not be measured says why, and what was is told in per cent", async (page, mock) => {
  await page.waitForSelector(".pill:has-text('1.8 % from reference')");
  assert.deepEqual(mock.last("measure").size, mock.last("state").canvas);
  await page.click(".pill");
  await page.waitForSelector(".popover dd:has-text('1.8 % at 1024 points, 95 %: 1.6 to 2.0 %; at most 22 %')");
  await page.keyboard.press("Escape");
  mock.reply = (m) => (m.type === "measure" ? { type: "answer", percent: 7.2, points: 1024, interval: [6, 8], largest: 40 } : undefined);
  await settled(page, () => page.keyboard.press("["));
  await page.waitForSelector(".pill:has-text('△ 7.2 % from reference')");
  await page.click(".pill");
  await page.waitForSelector(".popover dd:has-text('Natural or Global light.')");
  await page.keyboard.press("Escape");
  mock.reply = (m) => (m.type === "measure" ? { type: "answer", percent: null, sentence: "not measured: nothing is seen." } : undefined);
  await settled(page, () => page.keyboard.press("]"));
  await eventually(() => mock.heard.filter((m) => m.type === "measure").length === 3, "a third measurement");
  await drawn(page);
  assert.match(await page.locator(".pill").textContent(), /not measured/);
  await page.click(".pill");
  await page.waitForSelector(".popover dd:has-text('not measured: nothing is seen.')");
});

visit("reach is told in voxels and in millimetres, where the file states them", async (page) => {
  const row = page.locator(".row[aria-label=Reach]");
  assert.equal(await row.locator("input").inputValue(), "64");
  assert.equal(await row.locator("small").textContent(), "32 mm");
  await row.locator(".thumb").focus();
  await settled(page, () => page.keyboard.press("ArrowRight"));
  assert.equal(await row.locator("small").textContent(), "64 mm");
}, { prepare: (m) => (m.hello = { volume: { ...volume, spacing_mm: [0.5, 0.5, 2], spacing_stated: true } }) });

visit("Global has its ball, its rows and its folded accuracy, and the buttons wrap to 3 + 3", async (page, mock) => {
  await settled(page, () => page.click("[data-method=transport]"));
  assert.equal(mock.last("state").scene.lighting.method, "transport");
  const tops = await page.locator(".methods button").evaluateAll((all) => all.map((b) => Math.round(b.getBoundingClientRect().top)));
  assert.equal(new Set(tops.slice(0, 3)).size, 1);
  assert.ok(tops[3] > tops[0] && tops[3] === tops[5]);
  assert.equal(await page.locator(".ball").count(), 1);
  assert.ok(await page.locator("#sections > .section").last().evaluate((s) => s.getBoundingClientRect().bottom <= innerHeight + 1), "all seven sections are seen");
  const labels = (where) => page.locator(where).evaluateAll((all) => all.map((row) => row.querySelector(".label").firstChild.textContent));
  assert.deepEqual(await labels(".s-light .row:visible"), ["Turn", "Exposure", "Strength", "Bounces"]);
  await page.click(".accuracy");
  assert.deepEqual((await labels(".s-light .row:visible")).slice(4), ["Surfaces", "Albedo limit", "Grid", "Directions", "First directions", "Seed"]);
});

for (const width of [1280, 700, 390])
  visit(`Compare's labels stay within a picture of a window ${width} wide`, async (page) => {
    await page.evaluate(() => chiaro.compare.start());
    await page.waitForSelector(".figures:has-text('SSIM')");
    for (const key of ["Shift+ArrowRight", "Shift+ArrowRight", "Shift+ArrowRight"]) await page.keyboard.press(key);
    const out = await page.locator(".label-float").evaluateAll((all) => all.filter((e) => e.getBoundingClientRect().left < 0 || e.getBoundingClientRect().right > document.querySelector("#stage").clientWidth).map((e) => e.textContent));
    assert.deepEqual(out, []);
  }, { options: { viewport: { width, height: 720 } } });

const states = {
  empty: { prepare: (m) => (m.hello = { volume: null, scene: null }), until: "h1:has-text('Open a volume')" },
  reading: { prepare: (m) => (m.hello = { volume: null, scene: null, reading: "head.nii.gz" }), until: "h1:has-text('Reading head.nii.gz')" },
  failed: { prepare: (m) => (m.hello = { volume: null, scene: null, error: '"scan.nrrd" ends after 41 of 63 MB.' }), until: "h1:has-text('could not be read')" },
  lost: { act: (_, m) => m.stop(), until: ".banner:has-text('Connection lost')", allowed: /WebSocket|ERR_CONNECTION/ },
  refused: { act: (page) => page.evaluate(() => chiaro.states.say("Needs 6.2 GB.", { role: "alert", acts: [["Half size", () => {}]] })), until: ".banner[role=alert]" },
};
for (const [name, { prepare, act = () => {}, until, allowed }] of Object.entries(states))
  for (const colorScheme of ["dark", "light"])
    visit(`${name} in the ${colorScheme} theme: legible, without scroll bars, buttons stand out`, async (page, mock) => {
      await act(page, mock);
      await page.waitForSelector(until);
      assert.deepEqual(await faint(page), []);
      assert.ok(await page.evaluate(() => document.documentElement.scrollHeight <= innerHeight && document.documentElement.scrollWidth <= innerWidth));
      const plain = await page.locator(".state .plain").evaluateAll((all) => all.map((b) => getComputedStyle(b).backgroundColor === getComputedStyle(b.closest(".state")).backgroundColor));
      assert.ok(plain.every((same) => !same));
    }, { options: { ...desktop, colorScheme }, prepare, ready: !prepare, allowed });

visit("what local histograms take on disk is told and cleared", async (page) => {
  await page.click("[data-method=histogram]");
  await page.locator(".s-light button", { hasText: "Accuracy" }).click();
  await page.getByText("12 MB kept in /home/me/.cache/chiaro").waitFor();
  await page.locator(".s-light").getByRole("button", { name: "Clear", exact: true }).click();
  await page.getByText("0 kB kept in /home/me/.cache/chiaro").waitFor();
});

visit("the picker has the colours of the peaks and those that were picked", async (page) => {
  const colours = () => page.locator("#palette option").evaluateAll((all) => all.map((o) => o.value));
  const peaks = await page.evaluate(() => chiaro.graph.peaks().length);
  assert.equal((await colours()).length, peaks);
  const swatch = page.locator(".three input[type=color]");
  assert.equal(await swatch.getAttribute("list"), "palette");
  await swatch.fill("#123456");
  await swatch.dispatchEvent("change");
  assert.ok((await colours()).includes("#123456"));
});

visit("the opacity's tip tells it over a millimetre", async (page) => {
  await page.evaluate(() => (chiaro.ui.points = [1], chiaro.store.redraw()));
  await drawn(page);
  assert.match(await page.getByLabel("Opacity", { exact: true }).getAttribute("title"), /^0\.\d+ over 1 mm$|^1 over 1 mm$|^0 over 1 mm$/);
}, { prepare: (m) => (m.hello = { volume: { ...volume, spacing_mm: [0.5, 0.5, 2], spacing_stated: true } }) });

visit("reduced motion: nothing of the page has an animation or a transition", async (page) => {
  for (const open of [() => page.click("button[aria-label=More]"), () => page.click("button.primary"), () => page.click(".says"), () => page.click(".pill")]) {
    await open();
    await page.waitForSelector(".popover");
    const moving = await page.evaluate(() => [...document.querySelectorAll("*")].filter((e) => getComputedStyle(e).animationName !== "none" || parseFloat(getComputedStyle(e).transitionDuration) > 0).map((e) => e.className));
    assert.deepEqual(moving, []);
    await page.keyboard.press("Escape");
  }
}, { options: { ...desktop, reducedMotion: "reduce" } });

for (const [name, options] of Object.entries({ desktop, phone }))
  visit(`every button, field and slider of every part is named, in reach of Tab and large enough, ${name}`, async (page) => {
    await page.keyboard.press("s");
    await page.keyboard.press("k");
    await page.evaluate(() => chiaro.gestures.choose("measure"));
    for (const part of [".pane:visible", "#film:visible"]) await page.waitForSelector(part);
    for (const tab of ["look", "colour", "light", "cut", "more"]) {
      await page.evaluate((shown) => (chiaro.showTab(shown), document.querySelectorAll(".head[aria-expanded=false]").forEach((head) => head.click())), tab);
      await drawn(page);
      const faults = await page.evaluate(() => {
        const found = [];
        for (const e of document.querySelectorAll("button, input, select, [role=slider], [tabindex]")) {
          if (!e.checkVisibility({ visibilityProperty: true }) || e.disabled) continue;
          const { width, height } = (e.closest("label, .field") ?? e).getBoundingClientRect(), says = (e.getAttribute("aria-label") || e.labels?.[0]?.textContent || e.textContent || e.title).trim(), who = `${e.tagName}.${e.className} ${says}`;
          if (!says) found.push(`no name: ${who}`);
          // Of a group that arrows move in one is reached; points of the graph are as large as a finger takes them for.
          if (e.tabIndex < 0 && !e.closest("[role=radiogroup], [role=tablist], [role=toolbar], .layer")?.querySelector("[tabindex='0'], button:not([tabindex='-1'])")) found.push(`no Tab: ${who}`);
          if (!e.closest(".layer, .shutter") && Math.min(width, height) < 23.9) found.push(`${width} x ${height}: ${who}`);
        }
        return found;
      });
      assert.deepEqual(faults, []);
    }
  }, { options });

visit("the volume by keys and by fingers: arrows turn, Shift and arrows move, + comes nearer; one finger turns, two move and pinch", async (page) => {
  const camera = () => page.evaluate(() => chiaro.store.state.camera), stage = page.locator("#stage");
  const changes = async (act, key) => {
    const before = JSON.stringify((await camera())[key] ?? null);
    await act();
    await eventually(async () => JSON.stringify((await camera())[key] ?? null) !== before, key);
  };
  await stage.focus();
  await changes(() => page.keyboard.press("ArrowLeft"), "camera.azimuth_deg");
  await changes(() => page.keyboard.press("ArrowUp"), "camera.elevation_deg");
  await changes(() => page.keyboard.press("Shift+ArrowLeft"), "camera.target");
  await changes(() => page.keyboard.press("+"), "camera.fit_scale");
  const wire = await page.context().newCDPSession(page), touch = (type, ...points) => wire.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
  const box = await stage.boundingBox(), [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await changes(async () => {
    await touch("touchStart", [x, y]);
    for (const dx of [10, 25, 50]) await touch("touchMove", [x + dx, y]);
    await touch("touchEnd");
  }, "camera.azimuth_deg");
  const turned = (await camera())["camera.azimuth_deg"];
  await changes(async () => {
    await touch("touchStart", [x - 30, y]);
    await touch("touchStart", [x - 30, y], [x + 30, y]);
    for (const gap of [36, 45, 60]) await touch("touchMove", [x - gap, y + 10], [x + gap, y + 10]);
    await touch("touchEnd");
  }, "camera.fit_scale");
  assert.equal((await camera())["camera.azimuth_deg"], turned, "two fingers do not turn");
  await page.evaluate(() => chiaro.store.step("undo", "camera"));
  assert.equal((await camera())["camera.azimuth_deg"], turned);
}, { options: phone });

test("the page weighs 160 kB gzipped at most, and what comes first 86", () => {
  const folder = new URL("../../viewer/", import.meta.url), text = (name) => readFileSync(new URL(name, folder), "utf8"), weight = (names) => names.reduce((sum, name) => sum + gzipSync(text(name)).length, 0);
  const first = new Set(["index.html", "style.css", "main.js"]);
  for (const name of first) for (const [, found] of text(name).matchAll(/^import .* from "\.\/(.+)";$/gm)) first.add(found);
  const all = readdirSync(folder);
  assert.ok(all.filter((name) => name.endsWith(".js")).length > first.size, "some come later");
  assert.ok(weight(all) <= 160_000, `${weight(all)} bytes in all`);
  assert.ok(weight([...first]) <= 86_000, `${weight([...first])} bytes at first`);
});
