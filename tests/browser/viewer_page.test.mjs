// The viewer's page against a mock of its server: what it shows, how it moves, what it sends.
import assert from "node:assert/strict";
import { test } from "node:test";
import { scene, settings, volume } from "./mock.mjs";
import { desktop, phone, savedScene, visits } from "./mocked.mjs";
import { chooseTool, drag, eventually, faint, final, pixels, settled, state } from "./visit.mjs";

const visit = visits();

const point = (page, i) => page.locator(".point").nth(i);
const field = (page, label) => page.locator(`.row[aria-label="${label}"] input`).first();

visit("1440 × 900 shows all seven sections without a scroll bar, 1080 × 852 of it picture", async (page) => {
  await page.click("[data-method=visibility]"); // the tallest of the first sights
  await page.waitForSelector(".ball");
  assert.deepEqual(await page.locator("#stage").evaluate((s) => [s.clientWidth, s.clientHeight]), [1080, 852]);
  assert.deepEqual(await page.locator("#sections > .section").evaluateAll((all) => all.map((s) => s.getBoundingClientRect().bottom <= innerHeight + 1)), Array(7).fill(true));
  assert.ok(await page.evaluate(() => document.documentElement.scrollHeight <= innerHeight && document.querySelector("#panel").scrollHeight <= document.querySelector("#panel").clientHeight + 1));
});

visit("1280 × 720 keeps 952 × 672 for the picture and shows the probes", async (page) => {
  await page.click("[data-method=visibility]");
  await page.waitForSelector(".probes");
  assert.deepEqual(await page.locator("#stage").evaluate((s) => [s.clientWidth, s.clientHeight]), [952, 672]);
  assert.ok(await page.locator(".probes").evaluate((p) => p.getBoundingClientRect().bottom <= innerHeight));
}, { options: { viewport: { width: 1280, height: 720 } } });

visit("a phone has a sheet with five tabs and no sideways scrolling", async (page) => {
  for (const tab of ["Look", "Colour", "Light", "Cut", "More"]) {
    await page.click(`[role=tab]:has-text("${tab}")`);
    assert.ok(await page.locator(".section:visible").count() > 0, tab);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth && [...document.querySelectorAll("#panel, #sections, #bar")].every((e) => e.scrollWidth <= e.clientWidth)), tab);
    const small = await page.locator("button:visible").evaluateAll((all) => all.filter((b) => b.getBoundingClientRect().height < 32 && !b.closest(".float")).map((b) => b.textContent));
    assert.deepEqual(small, [], tab);
  }
}, { options: phone });

visit("a dragged point moves in the next frame, a picture answers, undo restores both bit for bit", async (page) => {
  const [was, before] = [await pixels(page), await state(page)];
  await drag(page, point(page, 2), 14, 20, { release: false });
  const line = await page.evaluate(() => new Promise((done) => {
    const points = chiaro.store.state.tf.points.length && chiaro.store.state.tf.points[2];
    requestAnimationFrame(() => done({ shown: Number(document.querySelectorAll(".point")[2].getAttribute("aria-valuenow")), opacity: points.opacity }));
  }));
  assert.equal(line.shown, line.opacity);
  assert.notEqual(line.opacity, before.tf.points[2].opacity);
  await settled(page, () => page.mouse.up());
  assert.notEqual(await pixels(page), was);
  assert.equal(await page.locator("button[title='Undo: opacity of 30 to 60']").count(), 1, "the step is named");
  await settled(page, () => page.keyboard.press("Control+z"));
  assert.deepEqual((await state(page)).tf, before.tf);
  assert.equal(await pixels(page), was);
  await settled(page, () => page.keyboard.press("Control+Shift+z"));
  assert.notEqual(await pixels(page), was);
});

visit("while dragging the page waits for nothing and sends one state at a time", async (page, mock) => {
  mock.delay = () => 400;
  mock.heard.length = 0;
  // A machine that is busy answers late, and looks far away: there more states may be under way.
  await page.evaluate(() => Object.defineProperty(chiaro.link, "way", { get: () => 0, set: () => {} }));
  const began = Date.now(), box = await point(page, 2).boundingBox();
  await page.mouse.move(box.x + 12, box.y + 12);
  await page.mouse.down();
  for (let i = 1; i <= 10; ++i) {
    await page.mouse.move(box.x + 12 + i, box.y + 12 + i);
    const [shown, is] = await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done([document.querySelectorAll(".point")[2].getAttribute("aria-valuenow"), String(chiaro.store.state.tf.points[2].opacity)])))));
    assert.equal(shown, is);
  }
  const moving = mock.heard.filter((m) => m.type === "state" && m.moving).length;
  assert.ok(moving >= 1 && moving <= 2 + (Date.now() - began) / 400, `${moving} states while each took 400 ms`);
  mock.delay = () => 0;
  await settled(page, () => page.mouse.up());
  assert.equal(mock.last("state").moving, false);
});

visit("no older frame is shown after a newer one", async (page, mock) => {
  // Each answer is held back less than the one before: they arrive in the wrong order.
  mock.delay = (header) => (header.kind === "state" ? Math.max(0, 500 - 40 * (header.n % 12)) : 0);
  await page.evaluate(() => {
    window.seen = [];
    new MutationObserver(() => seen.push(Number(document.querySelector("#stage canvas").dataset.n))).observe(document.querySelector("#stage canvas"), { attributes: true, attributeFilter: ["data-n"] });
  });
  for (let i = 0; i < 12; ++i) {
    await page.keyboard.press("]");
    await page.waitForTimeout(25);
  }
  await final(page);
  const seen = await page.evaluate(() => window.seen);
  assert.deepEqual(seen, [...seen].sort((a, b) => a - b));
  assert.equal(seen.at(-1), mock.last("state").n);
});

visit("points: new by a click, several by a rectangle, gone by Delete, snapped with Ctrl", async (page) => {
  const plot = await page.locator(".plot").boundingBox(), count = () => page.locator(".point").count();
  const before = await count();
  await page.mouse.click(plot.x + 130, plot.y + 30);
  assert.equal(await count(), before + 1);
  await page.keyboard.press("Control+z");
  await page.mouse.move(plot.x + 40, plot.y + 14);
  await page.mouse.down();
  await page.mouse.move(plot.x + 125, plot.y + 110, { steps: 4 });
  await page.mouse.up();
  assert.ok((await page.locator(".point.chosen").count()) >= 3);
  await page.locator(".point").nth(2).focus();
  await page.keyboard.press("Delete");
  assert.ok((await count()) < before);
  await page.keyboard.press("Control+z");
  assert.equal(await count(), before);
});

visit("a threshold of shutters, a shape, a look and a chip reach the scene", async (page, mock) => {
  await page.locator(".shutter").first().focus();
  await page.keyboard.press("ArrowRight");
  assert.ok((await state(page)).threshold[0] > 0);
  await page.click("button[aria-label='Add a shape']");
  await page.click(".item:has-text('Box')");
  const tf = (await state(page)).tf;
  assert.ok(tf.points.some((p, i) => i && p.value === tf.points[i - 1].value && p.opacity !== tf.points[i - 1].opacity), "a box has steps");
  await settled(page, () => page.click("[data-look=simulation]"));
  assert.equal((await state(page)).look, "simulation");
  assert.equal(mock.last("state").preview, false);
  const chip = page.locator(".chip").first();
  await chip.hover();
  await page.waitForFunction(() => chiaro.store.preview !== null);
  await eventually(() => mock.last("state").preview === true, "a look at the chip is asked for");
  await page.mouse.move(700, 400);
  await page.waitForFunction(() => chiaro.store.preview === null);
});

visit("surfaces and the ends of what glows are lines in the graph to drag", async (page, mock) => {
  await settled(page, () => page.keyboard.press("2"));
  const surface = page.locator(".shutter.value"), first = (await state(page)).iso[0].value;
  assert.equal(await surface.count(), 1);
  await settled(page, () => drag(page, surface, 30, 0));
  const moved = (await state(page)).iso[0].value;
  assert.ok(moved > first, `${moved}`);
  assert.equal(mock.last("state").scene.iso[0].value, moved);
  await page.keyboard.press("Control+z");
  assert.equal((await state(page)).iso[0].value, first);
  await settled(page, () => page.keyboard.press("1"));
  assert.equal(await surface.count(), 0);
  await page.click("[data-method=histogram]");
  await page.click("[data-effect=glow]");
  assert.equal(await surface.count(), 2);
  const range = () => page.evaluate(() => chiaro.glowNow());
  const was = await range();
  await surface.first().focus();
  await page.keyboard.press("Shift+ArrowLeft");
  const now = await range();
  assert.ok(now[0] < was[0] && now[1] === was[1], `${was} ${now}`);
});

visit("Adjust picks the value that is seen and drags its opacity", async (page) => {
  await chooseTool(page, "a", "adjust");
  await page.keyboard.up("a");
  const box = await page.locator("#stage").boundingBox(), r = 0.4 * Math.min(box.width, box.height);
  await page.mouse.move(box.x + box.width / 2 + 0.2 * r, box.y + box.height / 2);
  await page.mouse.down();
  await page.waitForFunction(() => chiaro.ui.points.length === 1);
  const chosen = await page.evaluate(() => chiaro.store.state.tf.points[chiaro.ui.points[0]].value);
  assert.ok(Math.abs(chosen - 51) < 1, `0.2 of the radius is 51, not ${chosen}`);
  const before = await page.evaluate(() => chiaro.store.state.tf.points[chiaro.ui.points[0]].opacity);
  await page.mouse.move(box.x + box.width / 2 + 0.2 * r, box.y + box.height / 2 + 100, { steps: 4 });
  await page.mouse.up();
  const now = await page.evaluate(() => chiaro.store.state.tf.points[chiaro.ui.points[0]].opacity);
  assert.ok(Math.abs(now / before - 10 ** -0.5) < 0.01, "100 pixels are half a factor of ten");
});

visit("right drag: window; wheel: zoom to the pointer; the camera has undo steps of its own", async (page) => {
  const before = await state(page);
  await drag(page, page.locator("#stage"), 100, -40, { button: "right" });
  const values = (await state(page)).tf.points.map((p) => p.value);
  assert.ok(Math.abs((values.at(-1) - values[0]) / 255 - 1.25) < 1e-6, "100 pixels to the right: a quarter wider");
  assert.ok(Math.abs((values.at(-1) + values[0]) / 2 - 127.5 - 25.5) < 1e-6, "40 up: the centre a tenth higher");
  await page.mouse.move(700, 300);
  await page.mouse.wheel(0, -400);
  await eventually(async () => (await state(page)).camera["camera.fit_scale"] < 0.7, "nearer");
  await page.keyboard.press("Alt+z");
  assert.deepEqual((await state(page)).camera, before.camera);
  assert.notDeepEqual((await state(page)).tf, before.tf);
});

visit("each method is sent, keeps its settings, and brings its own rows", async (page, mock) => {
  for (const method of ["none", "visibility", "histogram", "reference", "spao"]) {
    await settled(page, () => page.click(`[data-method=${method}]`));
    assert.equal(mock.last("state").scene.lighting.method, method);
  }
  const reach = page.locator(".row[aria-label=Reach] .thumb");
  await reach.focus();
  await settled(page, () => page.keyboard.press("ArrowRight"));
  assert.equal(mock.last("state").scene.lighting.levels, 8);
  await settled(page, () => page.click("[data-method=none]"));
  assert.equal(mock.last("state").scene.lighting.levels, undefined);
  await settled(page, () => page.click("[data-method=spao]"));
  assert.equal(mock.last("state").scene.lighting.levels, 8);
});

visit("the ball turns the probe; glow appears with its switch", async (page, mock) => {
  await settled(page, () => page.click("[data-method=visibility]"));
  await settled(page, () => drag(page, page.locator(".ball"), 30, 0));
  assert.equal(mock.last("state").scene.probe.rotation, 60);
  await settled(page, () => page.click("[role=radio][aria-label=Studio]"));
  assert.equal(mock.last("state").scene.probe.preset, "studio");
  await settled(page, () => page.click("[data-method=histogram]"));
  await settled(page, () => page.click("[data-effect=glow]"));
  assert.equal(mock.last("state").scene.lighting.effects, "ao,bleeding,glow");
  assert.match(mock.last("state").scene.lighting.glow, /^220:255=2$/);
});

visit("an error in a setting: the text stays, the range is told, the last good value holds", async (page, mock) => {
  await page.click(".s-surface .head");
  const shine = field(page, "Shine");
  await shine.fill("99");
  await shine.press("Enter");
  assert.equal(await shine.inputValue(), "99");
  assert.equal(await page.locator(".row[aria-label=Shine] .wrong").textContent(), "Takes 0 to 10.");
  assert.equal((await state(page)).values["shading.specular"], undefined);
  await shine.fill("0,5");
  await settled(page, () => shine.press("Enter"));
  assert.equal(mock.last("state").scene.shading.specular, 0.5);
});

visit("save, load, save: the same bytes", async (page) => {
  await drag(page, point(page, 2), 14, 20);
  await settled(page, () => page.click("[data-method=histogram]"));
  await page.click(".s-cut .head");
  await page.locator(".row[aria-label=x] .thumb").first().focus();
  await page.keyboard.press("ArrowRight");
  const first = await savedScene(page);
  assert.ok(JSON.parse(first).clip.box[0] > 0);
  await settled(page, () => page.click("[data-look=simulation]"));
  await settled(page, () => page.evaluate((text) => chiaro.take(new File([text], "scene.json")), first));
  assert.equal(await savedScene(page), first);
});

visit("the picture is saved in the wanted size, without highlights", async (page, mock) => {
  await page.click("button.primary");
  await page.locator(".popover select").nth(1).selectOption({ index: 2 });
  const download = page.waitForEvent("download");
  await page.click(".popover button.primary");
  await download;
  const { size, format, metadata, overlays } = mock.last("save");
  assert.deepEqual([size, format, metadata, overlays], [[3840, 2160], "png", true, []]);
});

visit("a saved picture carries scale bar and legend, as large in it as on the page", async (page, mock) => {
  const [w, h] = await page.evaluate(() => chiaro.frame.size());
  for (const [index, factor] of [[0, 1], [1, 2]]) {
    await page.click("button.primary");
    await page.locator(".popover select").nth(1).selectOption({ index });
    await page.getByLabel("Scale bar").check();
    await page.getByLabel("Colour legend").check();
    const download = page.waitForEvent("download");
    await page.click(".popover button.primary");
    await download;
    const { overlays } = mock.last("save"), seen = [];
    assert.equal(overlays.length, 2);
    for (const { at, png } of overlays) {
      const data = Buffer.from(png, "base64"), size = [data.readUInt32BE(16), data.readUInt32BE(20)];
      assert.equal(data.toString("latin1", 1, 4), "PNG");
      assert.ok(at[0] >= 0 && at[1] >= 0 && at[0] + size[0] <= factor * w && at[1] + size[1] <= factor * h, `${at} ${size}`);
      seen.push(await page.evaluate(async ([url, k]) => {
        const image = await createImageBitmap(await (await fetch(url)).blob()), g = new OffscreenCanvas(image.width, image.height).getContext("2d");
        g.drawImage(image, 0, 0);
        const { data } = g.getImageData(0, 0, image.width, image.height), rows = [];
        for (let y = 0; y < image.height; ++y) rows.push([...Array(image.width).keys()].filter((x) => data[4 * (y * image.width + x) + 3] > 200 && data[4 * (y * image.width + x)] > 250).length);
        return { longest: Math.max(...rows) / k, colours: new Set(Array.from({ length: image.width }, (_, x) => data.slice(4 * (Math.round(10 * k) * image.width + x), 4 * (Math.round(10 * k) * image.width + x) + 4).join())).size };
      }, [`data:image/png;base64,${png}`, factor]));
    }
    const shown = await page.evaluate(() => document.querySelector(".scale").getBoundingClientRect().width);
    assert.ok(Math.abs(seen[0].longest - shown) < 3, `bar of ${seen[0].longest} pixels where the page has ${shown}`);
    assert.ok(seen[1].colours > 10, `${seen[1].colours} colours in the legend`);
  }
});

visit("what floats over the picture keeps apart at every width", async (page) => {
  for (const width of [1440, 1301, 1280, 1279, 1180, 1001, 900, 780]) {
    await page.setViewportSize({ width, height: 700 });
    const near = await page.evaluate(() => {
      const [what, more, far] = document.querySelectorAll(".pill b, .pill span");
      [what.textContent, more.textContent, far.textContent] = ["Final", "88.8 s", "\u25B3 88.8 % from reference"];
      const boxes = [...document.querySelectorAll(".pill, .tools, .scale, .cross")].map((e) => [e.className, e.getBoundingClientRect()]);
      return boxes.flatMap(([a, p], i) => boxes.slice(i + 1).filter(([, q]) => p.left < q.right && q.left < p.right && p.top < q.bottom && q.top < p.bottom).map(([b]) => `${a} over ${b}`));
    });
    assert.deepEqual(near, [], `at ${width}`);
  }
});

visit("a malformed file: the library's sentence, and the picture stays", async (page) => {
  const was = await pixels(page);
  await page.evaluate(() => chiaro.take(new File(["{ no"], "scan.json")));
  assert.match(await page.locator("[role=alert]:visible").first().textContent(), /"scan.json" is no JSON: it ends after 3 of 9 bytes\./);
  assert.equal(await pixels(page), was);
});

visit("a killed server: banner, settings kept; restarted: the same picture", async (page, mock) => {
  await settled(page, () => page.click("[data-method=visibility]"));
  const was = await pixels(page), { port } = mock;
  await mock.stop();
  await page.waitForSelector(".banner:has-text('Connection lost. Your settings are kept.')");
  await page.keyboard.press("]");
  await mock.start(port);
  await page.evaluate(() => chiaro.link.open || document.querySelector(".banner button")?.click());
  await page.waitForSelector(".banner:has-text('Chiaro was restarted; everything is as you left it.')");
  await final(page);
  await eventually(async () => (await pixels(page)) !== was, "what was changed meanwhile was sent");
  await settled(page, () => page.keyboard.press("Control+z"));
  assert.equal(await pixels(page), was);
}, { allowed: /WebSocket connection/ });

visit("the same view elsewhere offers to take over", async (page, mock) => {
  for (const peer of mock.sockets) peer.close(4001);
  await page.click(".banner button:has-text('Take over')");
  await page.waitForFunction(() => chiaro.link.open);
});

visit("no volume: what can be opened; the panel appears with the picture", async (page, mock) => {
  await page.waitForSelector("h1:has-text('Open a volume')");
  assert.equal(await page.locator("#panel").isVisible(), false);
  await page.click("button:has-text('On the server')");
  await page.click("dialog .item:has-text('ball.nrrd')");
  await final(page);
  assert.equal(await page.locator("#panel").isVisible(), true);
  assert.equal(mock.last("open").volume, "/data/ball.nrrd");
}, { prepare: (m) => (m.hello = { volume: null, scene: null }), ready: false });

visit("a file that cannot be read: one heading and the sentence", async (page) => {
  await page.waitForSelector("h1:has-text('This file could not be read')");
  assert.equal(await page.locator(".state p").textContent(), '"scan.nrrd" ends after 41 of 63 MB.');
}, { prepare: (m) => (m.hello = { volume: null, scene: null, error: '"scan.nrrd" ends after 41 of 63 MB.' }), ready: false });

visit("Compare shows the reference at the right of a line that keys move", async (page, mock) => {
  await page.keyboard.press("r");
  await page.waitForSelector(".figures:has-text('SSIM 0.972')");
  const line = page.locator(".wipe");
  assert.equal(await line.getAttribute("aria-valuenow"), "50");
  await page.keyboard.press("Shift+ArrowLeft");
  assert.equal(await line.getAttribute("aria-valuenow"), "40");
  await page.keyboard.press("Escape");
  assert.equal(await line.count(), 0);
  await eventually(() => mock.heard.some((m) => m.type === "cancel"), "the comparison is given up");
});

for (const colorScheme of ["dark", "light"]) {
  visit(`every text has a contrast of 4.5 in the ${colorScheme} theme`, async (page) => {
    for (const head of await page.locator("button.head:visible").all()) await head.click();
    await page.click("[data-method=histogram]");
    assert.deepEqual(await faint(page), []);
    await page.click("button.primary");
    await page.waitForSelector(".popover");
    assert.deepEqual(await faint(page), []);
  }, { options: { viewport: { width: 1440, height: 900 }, colorScheme } });
}

visit("every control is reached by Tab and every slider changed by arrows", async (page) => {
  for (const head of await page.locator("button.head:visible").all()) await head.click();
  const wanted = await page.evaluate(() => {
    let number = 0;
    const able = [...document.querySelectorAll("button, input, select, [role=slider]")].filter((e) => e.checkVisibility({ checkVisibilityCSS: true }) && !e.disabled && e.tabIndex >= 0);
    for (const e of able) e.dataset.tabbed = String(number++);
    return number;
  });
  await page.evaluate(() => {
    window.reached = new Set();
    addEventListener("focusin", ({ target }) => window.reached.add(target.dataset.tabbed));
    document.activeElement.blur();
  });
  for (let i = 0; i < wanted + 8; ++i) await page.keyboard.down("Tab");
  await page.keyboard.up("Tab");
  const reached = await page.evaluate(() => (window.reached.delete(undefined), window.reached.size));
  assert.equal(reached, wanted);
  const sliders = page.locator("[role=slider]:visible");
  const deaf = [];
  for (let i = 0; i < (await sliders.count()); ++i) {
    const slider = sliders.nth(i), value = () => slider.evaluate((e) => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(e.getAttribute("aria-valuenow") + e.getAttribute("aria-valuetext"))))));
    await slider.evaluate((e) => e.focus());
    const before = await value();
    let now = before;
    for (const key of ["ArrowLeft", "ArrowRight", "ArrowRight", "ArrowUp"]) {
      await page.keyboard.down(key);
      await page.keyboard.up(key);
      if ((now = await value()) !== before) break;
    }
    if (now === before) deaf.push(await slider.getAttribute("aria-label"));
    assert.ok(await slider.getAttribute("aria-valuetext"));
  }
  assert.deepEqual(deaf, []);
});

visit("with reduced motion nothing is animated", async (page) => {
  await page.click("button[aria-label=More]");
  assert.deepEqual(await page.evaluate(() => document.getAnimations().length), 0);
  await page.keyboard.press("Escape");
  await page.click(".cross button[aria-label='+x']");
  assert.equal((await state(page)).camera["camera.azimuth_deg"], 0, "there at once");
}, { options: { ...desktop, reducedMotion: "reduce" } });

test("the page has a place for every setting of the library, and the library for every entry", async () => {
  const { table } = await import("../../viewer/table.js");
  const known = settings().flatMap((group) => group.settings.map((s) => s.flag ?? s.key));
  assert.deepEqual(known.filter((flag) => !(flag in table)), []);
  assert.deepEqual(Object.keys(table).filter((flag) => !known.includes(flag)), []);
});

test("points and stops of a file join again to the same function", async () => {
  const { at, joined, split } = await import("../../viewer/scene.js");
  const { transfer_function } = scene, tf = split(transfer_function);
  assert.ok(tf.points.length <= transfer_function.points.length);
  for (const { value, rgb, opacity } of transfer_function.points) {
    assert.ok(Math.abs(at(tf.points, value, "opacity") - opacity) < 1e-5);
    at(tf.stops, value, "rgb").forEach((c, i) => assert.ok(Math.abs(c - rgb[i]) < 1e-5));
  }
  assert.deepEqual(split({ ...transfer_function, points: joined(tf) }).points, tf.points);
  const step = { points: [{ value: 0, rgb: [1, 0, 0], opacity: 0 }, { value: 5, rgb: [1, 0, 0], opacity: 0 }, { value: 5, rgb: [0, 0, 1], opacity: 1 }, { value: 9, rgb: [0, 0, 1], opacity: 1 }] };
  assert.deepEqual(joined(split(step)), step.points);
});

test("the page's camera is the scene's: an orbit, and eye and target where it was panned", async () => {
  const { boxOf, fromScene, project, toScene, viewOf } = await import("../../viewer/camera.js");
  const box = boxOf(volume), orbit = { "camera.azimuth_deg": 20, "camera.elevation_deg": -30, "camera.fit_scale": 0.7 };
  assert.deepEqual(toScene(orbit, box), orbit);
  const panned = { ...orbit, "camera.target": [10, 20, 30] }, written = toScene(panned, box), again = fromScene(written, box, "unknown");
  for (const key of Object.keys(orbit)) assert.ok(Math.abs(again[key] - orbit[key]) < 1e-9, key);
  assert.deepEqual(project(viewOf(panned, box), [10, 20, 30], 400, 300).map(Math.round), [200, 150]);
  // What is visible takes the place of the box, once it was found.
  const found = { ...orbit, "camera.fit": "visible", "camera.fit_centre": [3, 4, 5], "camera.fit_radius": 2 }, whole = { ...found, "camera.fit": "volume" };
  assert.deepEqual(viewOf(found, box).target, [3, 4, 5]);
  assert.ok(Math.abs(viewOf(found, box).distance - (0.7 * 2) / Math.sin((15 * Math.PI) / 180)) < 1e-9);
  assert.deepEqual(viewOf(whole, box), viewOf(orbit, box));
  const moved = { ...found, "camera.target": [1, 1, 1] }, back = fromScene(toScene(moved, box), box, "unknown");
  for (const key of Object.keys(orbit)) assert.ok(Math.abs(back[key] - moved[key]) < 1e-9, key);
});
