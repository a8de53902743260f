// The viewer within another page, and links to a state: who may frame, read and drive it, and where the token goes.
import assert from "node:assert/strict";
import { createServer } from "node:http";
import { after, before, test } from "node:test";
import { serve, servedVisits, skip, token } from "./served.mjs";
import { drag, eventually, final, settled, state } from "./visit.mjs";

const all = servedVisits("sample:ball:32");

/** A page around the viewer that keeps what it hears; what the server is asked for with, too. */
const around = (inner) => `<!doctype html><title>around</title><iframe name="inner" width="600" height="400" src="${inner}"></iframe><script>
  window.heard = [];
  addEventListener("message", ({ data, origin }) => heard.push({ ...data, origin }));
  window.say = (message, to = "*") => frames[0].postMessage({ chiaro: 1, ...message }, to);
  window.answered = (id) => heard.find((m) => m.id === id);
</script>`;

const outer = { asked: [] };
before(async () => {
  if (skip) return;
  outer.page = createServer((request, response) => (outer.asked.push(request), response.setHeader("content-type", "text/html"), response.end(around(outer.inner))));
  await new Promise((done) => outer.page.listen(0, "127.0.0.1", done));
  outer.port = outer.page.address().port;
  outer.friend = `http://localhost:${outer.port}`, outer.stranger = `http://127.0.0.1:${outer.port}`; // one server, two origins
  outer.viewer = await serve(all.folder, "sample:ball:32", 0, ["--embed-from", outer.friend]);
  outer.inner = `${outer.viewer.url}&embed`;
});
after(async () => {
  if (skip) return;
  await outer.viewer.end("SIGINT");
  outer.page.closeAllConnections();
  outer.page.close();
});
async function open(address, act) {
  const page = await all.browser.newPage();
  try {
    await page.goto(address);
    await act(page);
  } finally {
    await page.close();
  }
}
const heard = (page, type) => page.waitForFunction((t) => window.heard.find((m) => m.type === t), type, { polling: 30 }).then((found) => found.jsonValue());
const ask = async (page, message) => {
  await page.evaluate((m) => window.say(m), message);
  return page.waitForFunction((id) => window.answered(id), message.id, { polling: 30 }).then((found) => found.jsonValue());
};

test("within a page of an origin that was named: ready, scene, picture, picked; bad messages get a sentence", { skip }, () => open(outer.friend, async (page) => {
  const ready = await heard(page, "ready"), inner = page.frame("inner");
  assert.deepEqual([ready.volume.name, ready.volume.dimensions, ready.origin], ["sample:ball:32", [32, 32, 32], new URL(outer.viewer.url).origin]);
  await final(inner);
  assert.deepEqual(await inner.evaluate(() => ["#bar", "#panel", ".tools"].map((one) => document.querySelector(one).checkVisibility())), [false, false, false]);
  assert.deepEqual(await inner.evaluate(() => chiaro.frame.size()), [600, 400]);
  // The page around drives it: what it leaves out stays, and it is a step.
  const before = await state(inner), given = await ask(page, { type: "scene", id: 1, scene: { mode: "mip", camera: { azimuth_deg: -20 } } });
  assert.deepEqual([given.scene.mode, given.scene.camera.azimuth_deg, given.scene.lighting.method], ["mip", -20, "spao"]);
  assert.deepEqual((await state(inner)).tf, before.tf);
  await final(inner);
  assert.equal(await inner.evaluate(() => chiaro.store.next("undo") !== undefined), true);
  // The picture is what is shown.
  await page.evaluate(() => window.say({ type: "picture", id: "p" }));
  await page.waitForFunction(() => window.answered("p"));
  assert.deepEqual(await page.evaluate(async () => {
    const { png, stage, size } = window.answered("p"), bitmap = await createImageBitmap(png);
    return [stage, png.type, bitmap.width === size[0] && bitmap.height === size[1]];
  }), ["final", "image/png", true]);
  // What is done within is told: a turn when its picture is final, a click at once.
  const scenes = () => page.evaluate(() => window.heard.filter((m) => m.type === "scene" && m.id === null).length), told = await scenes(), frame = await page.locator("iframe").boundingBox();
  await page.mouse.move(frame.x + 300, frame.y + 200);
  await page.mouse.down();
  await page.mouse.move(frame.x + 340, frame.y + 200, { steps: 5 });
  await page.mouse.up();
  await eventually(async () => (await scenes()) > told, "the turn is told");
  assert.notEqual((await page.evaluate(() => window.heard.filter((m) => m.type === "scene").at(-1))).scene.camera.azimuth_deg, -20);
  await page.mouse.click(frame.x + 300, frame.y + 200);
  const picked = await heard(page, "picked");
  assert.ok(picked.value > 0 && picked.world_mm.length === 3 && picked.voxel.length === 3);
  for (const [message, sentence] of [[{ type: "scene", id: 11, scene: { mode: "no such" } }, /mode/], [{ type: "open", id: 12, volume: "/etc/passwd" }, /no such message/], [{ type: "__proto__", id: 13 }, /no such message/], [{ type: "scene", id: 14, scene: 7 }, /no scene/],
    [{ type: "scene", id: 15, scene: { volume: { file: "sample:tubes" } } }, /another volume/], [{ type: "scene", id: 16, scene: { note: "x".repeat(600000) } }, /too large/]])
    assert.match((await ask(page, message)).sentence, sentence);
  // A second one beside it is a view of its own.
  await page.evaluate((src) => document.body.append(Object.assign(document.createElement("iframe"), { name: "second", src, width: 300, height: 200 })), outer.inner);
  await page.waitForFunction(() => window.heard.filter((m) => m.type === "ready").length === 2);
  const second = page.frame("second");
  await final(second);
  assert.notEqual(await second.evaluate(() => chiaro.link.view), await inner.evaluate(() => chiaro.link.view));
  assert.equal(await inner.evaluate(() => chiaro.link.open), true);
  // The token is in no message and no address that the page around was asked for with.
  assert.ok(!JSON.stringify(await page.evaluate(() => window.heard.map(({ png, ...rest }) => rest))).includes(token));
  assert.ok(outer.asked.every((request) => !request.headers.referer?.includes(token)));
}));

test("a page of another origin can neither frame, read nor drive it", { skip }, () => open(outer.stranger, async (page) => {
  // Framed: refused by the browser, whatever the address knows.
  await page.waitForTimeout(500);
  await page.evaluate(() => window.say({ type: "scene", id: 1 }));
  for (const frame of page.frames()) assert.equal(await frame.evaluate(() => Boolean(window.chiaro)).catch(() => false), false);
  assert.deepEqual(await page.evaluate(() => window.heard), []);
  // Read, or asked through a socket, even with the token.
  const { url } = outer.viewer, got = await page.evaluate(async (address) => {
    const socket = new WebSocket(address.replace("http", "ws").replace("/?", "/socket?view=stranger-view&"));
    const opened = new Promise((done) => (socket.onopen = () => done(true), socket.onclose = () => done(false)));
    return [await fetch(address).then((answer) => answer.text(), () => "refused"), await opened];
  }, url);
  assert.deepEqual(got, ["refused", false]);
  // As a window of its own: the one that opened it has no hold of it, and what it says is not heard.
  const popup = page.waitForEvent("popup");
  await page.evaluate((address) => (window.other = window.open(address)), `${url}&embed`);
  const viewer = await popup;
  await viewer.waitForSelector("#stage canvas");
  await final(viewer);
  const { mode } = (await state(viewer)).values;
  await page.evaluate(() => window.other?.postMessage({ chiaro: 1, type: "scene", id: 1, scene: { mode: "mip" } }, "*"));
  await viewer.evaluate(() => window.postMessage({ chiaro: 1, type: "scene", id: 2, scene: { mode: "mip" } }, "*")); // its own window is no page around it
  await page.waitForTimeout(200);
  assert.equal((await state(viewer)).values.mode, mode);
  assert.equal(await page.evaluate(() => window.heard.length), 0);
  await viewer.close();
}));

test("a link opens the same state, and asks for the token", { skip }, () => all.visit(async (page) => {
  await settled(page, () => page.keyboard.press("3"));
  await settled(page, () => drag(page, page.locator("#stage"), 60, 25));
  const was = await state(page);
  await page.evaluate(() => (navigator.clipboard.writeText = async (text) => void (window.copied = text)));
  await page.click("button[aria-label=More]");
  await page.click(".item:has-text('Copy a link to this')");
  await page.waitForFunction(() => window.copied);
  const link = await page.evaluate(() => window.copied);
  assert.ok(!link.includes(token) && link.startsWith(new URL(all.server.url).origin), link);
  await open(link, async (other) => {
    await other.waitForSelector("h1:has-text('Chiaro')");
    await other.fill("#token", "nothing of it");
    await other.keyboard.press("Enter");
    await other.waitForSelector("#wrong:has-text('A token is 32')");
    await other.fill("#token", all.server.url);
    await other.keyboard.press("Enter");
    await other.waitForFunction(() => window.chiaro?.store.state.values.mode === "mip");
    await final(other);
    const now = await state(other);
    assert.deepEqual([now.values, now.tf, now.camera["camera.azimuth_deg"]], [was.values, was.tf, was.camera["camera.azimuth_deg"]]);
    assert.ok(!other.url().includes("#"), "what was in the address is not applied twice");
    await settled(other, () => other.keyboard.press("Control+z"));
    assert.equal((await state(other)).values.mode ?? "dvr", "dvr");
  });
  // What is no state opens the volume as it is.
  await open(`${all.server.url}#state=nothing`, async (other) => {
    await final(other);
    assert.equal(await other.locator(".file b").textContent(), "sample:ball:32");
  });
}));
