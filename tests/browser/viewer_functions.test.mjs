// Functions of value and gradient: the plane of both, shapes over it, the curve over the gradient, by mouse, keys and fingers.
import assert from "node:assert/strict";
import { join } from "node:path";
import { test } from "node:test";
import { scene } from "./mock.mjs";
import { desktop, phone, savedScene, visits } from "./mocked.mjs";
import { drawn } from "./page.mjs";
import { servedVisits, skip } from "./served.mjs";
import { drag, eventually, faint, final, pixels, settled, state, tapped } from "./visit.mjs";

const visit = visits(), all = servedVisits("sample:tubes:32");
const rest = async (page) => (await state(page)).tf.rest, shapes = async (page) => (await rest(page)).widgets ?? [], curve = async (page) => (await rest(page)).gradient_opacity ?? [];
const open = async (page) => {
  await page.click("button[aria-label='More for colour and opacity']");
  await page.click(".item:has-text('Value and gradient')");
  await page.waitForSelector(".gradient-plot:visible");
  await page.waitForSelector(".gradient-waiting", { state: "hidden" });
  await drawn(page);
};
const shape = (page, i = 0) => page.locator(".shape").nth(i), grip = (page, name) => page.locator(`.grip[aria-label$="${name}"]`);
/** Where a value and a magnitude lie on the screen. The mock's values are 0 to 255, its steepest gradient 40. */
const place = (page, value, magnitude, steepest = 40) => page.locator(".gradient-plot .ground").first().evaluate((ground, [v, q]) => {
  const box = ground.getBoundingClientRect(), [low, high] = chiaro.graph.axis.view;
  return [box.left + (box.width * (v - low)) / (high - low), box.bottom - box.height * q];
}, [value, Math.sqrt(magnitude / steepest)]);
const near = (a, b, by, why) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) <= by * Math.max(1, Math.abs(b[i])), `${why}: ${a} and ${b}`));
const pull = async (page, from, to, steps = 6) => {
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(...to, { steps });
};
const shot = async (page, name) => process.env.CHIARO_SHOTS && (await page.screenshot({ path: join(process.env.CHIARO_SHOTS, `functions-${name}.png`) }));

visit("the plane of value and gradient comes when it is first asked for, and its counts once", async (page, mock) => {
  const loaded = () => page.evaluate(() => performance.getEntriesByType("resource").filter((e) => /gradient/.test(e.name)).length);
  assert.equal(await loaded(), 0);
  const before = await state(page);
  await open(page);
  assert.ok((await loaded()) > 3);
  await eventually(() => page.evaluate(() => {
    const canvas = document.querySelector(".gradient-plot canvas"), g = canvas.getContext("2d"), k = devicePixelRatio, ground = canvas.nextSibling.getBoundingClientRect(), at = canvas.getBoundingClientRect();
    const seen = (value, share) => g.getImageData(Math.round((ground.left - at.left + (ground.width * value) / 255) * k), Math.round((ground.bottom - at.top - ground.height * share) * k), 1, 1).data[3];
    return seen(100, 0.02) > 2 * seen(55, 0.6) && seen(55, 0.985) > 2 * seen(55, 0.6);
  }), "flat matter below, the top of an arch above");
  await page.click("[aria-label='Close: Value and gradient']");
  assert.equal(await page.locator(".gradients:visible").count(), 0, "nothing is shown by it");
  await open(page);
  assert.equal(mock.heard.filter((m) => m.type === "gradients").length, 1);
  assert.deepEqual(await state(page), before);
  assert.equal(await page.evaluate(() => chiaro.store.next("undo")), undefined);
});

visit("by mouse: a shape is drawn, moved, pulled by its sides and removed, each a step; Esc goes back", async (page, mock) => {
  await open(page);
  await pull(page, await place(page, 60, 4), await place(page, 120, 30));
  await settled(page, () => page.mouse.up());
  const [made] = await shapes(page);
  assert.equal(made.shape, "rectangle");
  near([...made.value, ...made.magnitude], [60, 120, 4, 30], 0.03, "drawn");
  assert.deepEqual(mock.last("state").scene.transfer_function.widgets, [made], "the picture is of it");
  assert.equal(await page.evaluate(() => chiaro.store.next("undo")), "New rectangle");
  await settled(page, () => drag(page, shape(page), 30, 0));
  const [aside] = await shapes(page), dv = 30 * (await page.evaluate(() => chiaro.graph.axis.pixel));
  near(aside.value, made.value.map((v) => v + dv), 1e-3, "moved");
  assert.deepEqual(aside.magnitude, made.magnitude);
  await settled(page, () => drag(page, grip(page, "to gradient"), 0, 20));
  const [lower] = await shapes(page);
  assert.ok(lower.magnitude[1] < made.magnitude[1] - 4 && lower.magnitude[0] === made.magnitude[0], `${lower.magnitude}`);
  await settled(page, () => drag(page, grip(page, "from value"), -20, 0));
  near((await shapes(page))[0].value, [aside.value[0] - (20 * dv) / 30, aside.value[1]], 1e-2, "wider");
  // Beyond the other side a side stops.
  await settled(page, () => drag(page, grip(page, "to value"), -250, 0));
  const [narrow] = await shapes(page);
  assert.ok(narrow.value[1] > narrow.value[0]);
  await page.keyboard.press("Control+z");
  const held = await shapes(page);
  await drag(page, shape(page), 15, 15, { release: false });
  assert.notDeepEqual(await shapes(page), held);
  await page.keyboard.press("Escape");
  await page.mouse.up();
  assert.deepEqual(await shapes(page), held, "as it was");
  await pull(page, await place(page, 200, 4), await place(page, 240, 30));
  await page.keyboard.press("Escape");
  await page.mouse.up();
  assert.deepEqual(await shapes(page), held, "and no new one");
  for (const expected of [[lower], [aside], [made], []]) {
    await page.keyboard.press("Control+z");
    assert.deepEqual(await shapes(page), expected);
  }
  assert.equal((await rest(page)).widgets, undefined);
  await page.keyboard.press("Control+Shift+z");
  await shape(page).hover();
  await page.mouse.down();
  await drawn(page); // a click lasts for longer than a frame
  await page.mouse.up();
  await settled(page, () => page.click("text=Remove: Rectangle 1"));
  assert.deepEqual(await shapes(page), []);
});

visit("by keys: shapes are added, reached by Tab, moved, resized, made another kind, removed", async (page) => {
  await open(page);
  await page.focus("[aria-label='Add: Triangle']");
  await settled(page, () => page.keyboard.press("Enter"));
  await page.keyboard.press("Shift+Tab");
  await page.keyboard.press("Shift+Tab");
  const [made] = await shapes(page), focused = () => page.evaluate(() => [document.activeElement.getAttribute("aria-label"), document.activeElement.getAttribute("aria-valuetext")]);
  assert.equal(made.magnitude[0], 0, "it stands on its tip");
  for (let i = 0; i < 12 && (await focused())[0] !== "Triangle 1"; ++i) await page.keyboard.press("Shift+Tab");
  assert.match((await focused())[1], /^values \S+ to \S+, gradients 0 to 20 per voxel, opacity 1$/);
  await settled(page, () => page.keyboard.press("ArrowRight"));
  await settled(page, () => page.keyboard.press("Shift+ArrowRight"));
  near((await shapes(page))[0].value, made.value.map((v) => v), 0.2, "a little");
  const dv = await page.evaluate(() => chiaro.graph.axis.pixel);
  near((await shapes(page))[0].value, made.value.map((v) => v + 11 * dv), 1e-3, "eleven steps");
  await page.keyboard.press("Tab");
  for (let i = 0; i < 6 && (await focused())[0] !== "Triangle 1, to gradient"; ++i) await page.keyboard.press("Tab");
  assert.equal((await focused())[1], "20 per voxel");
  await settled(page, () => page.keyboard.press("Shift+ArrowDown"));
  assert.ok((await shapes(page))[0].magnitude[1] < 18);
  await page.focus("label:has-text('Shape') + select");
  await settled(page, () => page.keyboard.press("e"));
  assert.equal((await shapes(page))[0].shape, "ellipse");
  const opacity = page.locator(".gradient-body [role=slider][aria-label=Opacity]");
  await opacity.focus();
  await settled(page, () => page.keyboard.press("PageDown"));
  assert.equal((await shapes(page))[0].opacity, 0.9);
  await page.fill(".gradient-body input[aria-label='Value, from']", "12,5");
  await settled(page, () => page.keyboard.press("Enter"));
  assert.equal((await shapes(page))[0].value[0], 12.5);
  await page.fill(".gradient-body input[aria-label='Gradient, to']", "-4");
  await page.keyboard.press("Enter");
  await page.waitForSelector(".gradient-body .wrong:visible");
  await shape(page).focus();
  await settled(page, () => page.keyboard.press("Delete"));
  assert.deepEqual(await shapes(page), []);
});

visit("with fingers: a shape is drawn, moved, pulled by a side and removed", async (page) => {
  await open(page);
  const wire = await page.context().newCDPSession(page), touch = (type, ...points) => wire.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y]) => ({ x, y })) });
  const swipe = async ([x0, y0], [x1, y1]) => {
    await touch("touchStart", [x0, y0]);
    for (let i = 1; i <= 5; ++i) await touch("touchMove", [x0 + ((x1 - x0) * i) / 5, y0 + ((y1 - y0) * i) / 5]);
    await touch("touchEnd");
  };
  const middle = async (part) => ((b) => [b.x + b.width / 2, b.y + b.height / 2])(await part.boundingBox());
  await page.locator(".gradient-plot").scrollIntoViewIfNeeded();
  const [x0, y0] = await place(page, 60, 4), [x1, y1] = await place(page, 160, 30);
  await settled(page, () => swipe([x0, y0], [x1, y1]));
  const [made] = await shapes(page);
  near([...made.value, ...made.magnitude], [60, 160, 4, 30], 0.03, "drawn");
  const [mx, my] = await middle(shape(page));
  await settled(page, () => swipe([mx, my], [mx + 40, my]));
  assert.ok((await shapes(page))[0].value[0] > made.value[0] + 20);
  const [gx, gy] = await middle(grip(page, "from gradient"));
  await settled(page, () => swipe([gx, gy], [gx, gy - 30]));
  assert.ok((await shapes(page))[0].magnitude[0] > made.magnitude[0] + 1);
  await page.waitForTimeout(400); // longer than what the browser takes for a double tap with the finger before
  await tapped(page, page.locator("[aria-label='Add: Ellipse']"));
  assert.equal((await shapes(page)).length, 2);
  await page.waitForTimeout(400);
  await tapped(page, page.locator("[aria-label='Add: Curve']"));
  assert.equal((await curve(page)).length, 2);
  await page.locator(".gradient-plot").scrollIntoViewIfNeeded();
  const [px, py] = await middle(page.locator(".gradient-plot .point").nth(1)), [, before] = await curve(page);
  await settled(page, () => swipe([px, py], [px - 10, py - 20]));
  const [, bent] = await curve(page);
  assert.ok(bent.magnitude > before.magnitude && bent.opacity < before.opacity, JSON.stringify(bent));
  await tapped(page, page.locator("text=Remove: Curve"));
  assert.deepEqual(await curve(page), []);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no sideways scrolling");
  await shot(page, "phone");
}, { options: phone });

visit("the curve over the gradient: points are added, dragged, moved by keys and removed", async (page, mock) => {
  await open(page);
  await settled(page, () => page.click("[aria-label='Add: Curve']"));
  assert.deepEqual(mock.last("state").scene.transfer_function.gradient_opacity, [{ magnitude: 0, opacity: 0 }, { magnitude: 10, opacity: 1 }]);
  const points = page.locator(".gradient-plot .point"), side = await page.locator(".gradient-plot .ground").nth(1).boundingBox();
  await settled(page, () => page.mouse.click(side.x + side.width / 2, side.y + side.height * (1 - Math.sqrt(20 / 40))));
  const [, , added] = await curve(page);
  near([added.magnitude, added.opacity], [20, 0.5], 0.06, "where it was clicked");
  await settled(page, () => drag(page, points.nth(1), -8, 12));
  const [, pulled] = await curve(page);
  assert.ok(pulled.opacity < 0.9 && pulled.magnitude < 9, JSON.stringify(pulled));
  await settled(page, () => drag(page, points.nth(1), 0, -300));
  assert.equal((await curve(page))[1].magnitude, (await curve(page))[2].magnitude, "it stops at its neighbour");
  await page.keyboard.press("Control+z");
  assert.deepEqual((await curve(page))[1], pulled);
  await points.nth(1).focus();
  await settled(page, () => page.keyboard.press("ArrowUp"));
  assert.ok((await curve(page))[1].magnitude > pulled.magnitude);
  await settled(page, () => page.keyboard.press("Shift+ArrowLeft"));
  assert.ok((await curve(page))[1].opacity < pulled.opacity);
  await settled(page, () => page.keyboard.press("Delete"));
  assert.equal((await curve(page)).length, 2);
  await points.nth(1).focus();
  await settled(page, () => page.keyboard.press("Delete"));
  assert.equal((await rest(page)).gradient_opacity, undefined, "one point is no curve");
});

visit("shapes and curve come with a scene, are saved with it, and are stretched and mirrored as values are", async (page, mock) => {
  await page.waitForSelector(".gradient-plot:visible"); // what is shown by them is told
  const loaded = await rest(page), saved = JSON.parse(await savedScene(page)).transfer_function;
  assert.deepEqual([saved.widgets, saved.gradient_opacity], [loaded.widgets, loaded.gradient_opacity]);
  await page.click("[aria-label='Close: Value and gradient']");
  assert.equal(await page.locator(".gradient-head span").textContent(), "2 shapes, a curve");
  await settled(page, () => page.evaluate(() => chiaro.store.set("window", (s) => ({ values: s.values }))).then(() => page.fill("input[aria-label='Window, to']", "510")).then(() => page.keyboard.press("Enter")));
  const wide = await rest(page);
  near(wide.widgets[0].value, [160, 320], 1e-9, "as far apart as the window is wider");
  near([...wide.widgets[0].magnitude, wide.gradient_opacity[1].magnitude], [6, 80, 24], 1e-9, "and as much steeper");
  await page.keyboard.press("Control+z");
  await page.click("button[aria-label='More for colour and opacity']");
  await settled(page, () => page.click(".item:has-text('Reverse')"));
  near((await shapes(page))[0].value, [255 - 160, 255 - 80], 1e-9, "mirrored");
  near((await shapes(page))[0].magnitude, [3, 40], 1e-9, "as steep as before");
  await settled(page, () => page.click("[data-look=simulation]"));
  assert.deepEqual(await shapes(page), [], "a look has its own");
  assert.equal(await page.locator(".gradients:visible").count(), 0);
  await page.keyboard.press("Control+z");
  await page.waitForSelector(".gradients:visible");
}, { prepare: (m) => (m.hello = { scene: { ...scene, transfer_function: { ...scene.transfer_function, gradient_opacity: [{ magnitude: 2, opacity: 0 }, { magnitude: 12, opacity: 1 }],
  widgets: [{ shape: "triangle", value: [80, 160], magnitude: [3, 40], opacity: 0.8 }, { shape: "rectangle", value: [180, 255], magnitude: [0, 10], opacity: 1 }] } } }) });

for (const colorScheme of ["dark", "light"])
  visit(`the plane of value and gradient in the ${colorScheme} theme: legible and named`, async (page) => {
    await open(page);
    assert.deepEqual(await faint(page), []);
    for (const name of ["Triangle", "Ellipse", "Rectangle", "Curve"]) {
      await settled(page, () => page.click(`[aria-label='Add: ${name}']`));
      assert.deepEqual(await faint(page), [], name);
    }
    await shape(page).focus();
    await drawn(page);
    const nameless = await page.locator(".gradients :is(button, select, input, [role=slider]):visible").evaluateAll((all) => all.filter((e) => !(e.getAttribute("aria-label") || e.labels?.length || e.textContent.trim())).map((e) => e.outerHTML));
    assert.deepEqual(nameless, []);
    const small = await page.locator(".gradients :is(button, [role=slider]):visible").evaluateAll((all) => all.filter((e) => Math.min(e.offsetWidth, e.offsetHeight) < 24).map((e) => e.outerHTML));
    assert.deepEqual(small, []);
    await shot(page, colorScheme);
  }, { options: { ...desktop, colorScheme } });

test("the program's counts are drawn, and a shape shows what it is over", { skip }, () => all.visit(async (page) => {
  await open(page);
  const before = await pixels(page);
  await settled(page, () => page.click("[aria-label='Add: Rectangle']"));
  const first = await pixels(page);
  assert.notEqual(first, before);
  await settled(page, () => drag(page, grip(page, "to gradient"), 0, 30));
  const second = await pixels(page);
  assert.notEqual(second, first);
  const text = await savedScene(page), kept = await shapes(page);
  assert.deepEqual(JSON.parse(text).transfer_function.widgets, kept, "the program writes the same numbers");
  await settled(page, () => page.keyboard.press("Control+z"));
  assert.equal(await pixels(page), first);
  await settled(page, () => page.evaluate((file) => chiaro.take(new File([file], "scene.json")), text));
  assert.deepEqual(await shapes(page), kept);
  assert.equal(await pixels(page), second);
  await shot(page, "served");
}));

test("what the program does not draw with shapes is told in its own sentence", { skip }, () => all.visit(async (page) => {
  await open(page);
  await settled(page, () => page.click("[aria-label='Add: Rectangle']"));
  for (const [key, value] of [["sampling.classification", "pre"], ["lighting.method", "histogram"]]) {
    const old = await page.evaluate((k) => chiaro.store.state.values[k] ?? null, key), put = (v) => page.evaluate(([k, to]) => chiaro.store.set(k, (s) => ({ values: { ...s.values, "histogram:lighting.radius": 1, [k]: to } })), [key, v]); // a small one is found quickly
    await put(value);
    await page.waitForSelector(".banner[role=alert]:has-text('opacity by gradient')");
    await page.evaluate(() => chiaro.states.hush());
    await settled(page, () => put(old));
  }
}));
