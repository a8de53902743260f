// The main ways through the viewer in Debian's Firefox, over WebDriver BiDi: puppeteer drives pointer, keys, double clicks and
// fingers there. What it cannot: hand over a file as the system's drag does (a drop is made of a DataTransfer), and tell of
// downloads (they go to a folder that is watched).
import assert from "node:assert/strict";
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { patience } from "./page.mjs";
import { serve, skip as none } from "./served.mjs";
import { eventually } from "./visit.mjs";
import { nrrd } from "./volume_file.mjs";

const executablePath = [process.env.CHIARO_FIREFOX, "/usr/bin/firefox-esr", "/usr/bin/firefox"].find((path) => path && existsSync(path));
const skip = none || (executablePath ? false : "no firefox-esr");
let browser, folder, server, page;
const faults = [];

before(async () => {
  if (skip) return;
  const { default: puppeteer } = await import("puppeteer-core");
  folder = mkdtempSync(join(tmpdir(), "chiaro-firefox-"));
  server = await serve(folder, "sample:ball:32");
  browser = await puppeteer.launch({ browser: "firefox", executablePath, headless: true, timeout: patience, protocolTimeout: patience, extraPrefsFirefox: { "browser.download.dir": folder, "browser.download.folderList": 2, "browser.download.always_ask_before_handling_new_types": false } });
  page = await browser.newPage();
  page.setDefaultTimeout(patience);
  page.on("pageerror", (error) => faults.push(String(error.stack ?? error)));
  await page.setViewport({ width: 1100, height: 700 });
  await page.goto(server.url);
  await final();
});
after(async () => {
  if (skip) return;
  await browser.close();
  await server.end("SIGINT");
  rmSync(folder, { recursive: true, force: true });
});
const final = () => page.waitForFunction(() => {
  const { stage, n } = document.querySelector("#stage canvas").dataset;
  return stage === "final" && Number(n) === chiaro.link.n && !chiaro.store.dragging;
}, { polling: 30 });
const get = (what) => page.evaluate(what);
/** Until what the page tells is another. */
const changes = async (what, act, says) => {
  const before = JSON.stringify(await get(what));
  await act();
  await eventually(async () => JSON.stringify(await get(what)) !== before, says);
};
const drag = async (x, y, dx, dy, button = "left") => {
  await page.mouse.move(x, y);
  await page.mouse.down({ button });
  await page.mouse.move(x + dx, y + dy, { steps: 5 });
  await page.mouse.up({ button });
};
const azimuth = () => chiaro.store.state.camera["camera.azimuth_deg"], zoom = () => chiaro.store.state.camera["camera.fit_scale"], marks = () => chiaro.store.state.marks?.length ?? 0;
const middle = (selector) => page.$eval(selector, (e) => (({ x, y, width, height }) => [x + width / 2, y + height / 2])(e.getBoundingClientRect()));

test("Firefox: open, orbit, zoom, edit, undo", { skip }, async () => {
  await changes(azimuth, () => drag(300, 300, 60, 20), "it turns");
  await changes(zoom, () => page.mouse.wheel({ deltaY: 100 }), "it comes nearer");
  await changes(() => chiaro.store.state.tf, () => drag(300, 300, 40, 10, "right"), "the window");
  await changes(() => chiaro.store.state.tf.scale, () => page.keyboard.press("]"), "the density");
  await changes(() => chiaro.store.state.tf.scale, async () => {
    await page.keyboard.down("Control");
    await page.keyboard.press("z");
    await page.keyboard.up("Control");
  }, "undone");
  await final();
});

test("Firefox: fingers turn and pinch", { skip }, async () => {
  await changes(azimuth, async () => {
    const finger = await page.touchscreen.touchStart(300, 300);
    for (const x of [320, 350, 380]) await finger.move(x, 300);
    await finger.end();
  }, "one turns");
  await changes(zoom, async () => {
    const [one, two] = [await page.touchscreen.touchStart(300, 300), await page.touchscreen.touchStart(360, 300)];
    await one.move(280, 300);
    await two.move(390, 300);
    await one.end();
    await two.end();
  }, "two pinch");
  await final();
});

test("Firefox: slices, measuring, a film", { skip }, async () => {
  await page.keyboard.press("s");
  await page.waitForFunction(() => [...document.querySelectorAll(".pane:not([hidden]) canvas")].filter((c) => c.dataset.drawn === "final").length === 3);
  const [x, y] = await middle(".pane:not([hidden]) .slice-picture");
  await changes(() => chiaro.slices.at(), () => page.mouse.click(x + 30, y + 20), "the crosshair");
  await changes(() => chiaro.slices.at(), () => page.mouse.wheel({ deltaY: 100 }), "the next slice");
  await changes(() => chiaro.slices.layout(), () => page.mouse.click(x, y, { count: 2 }), "large");
  await changes(() => chiaro.slices.layout(), () => page.keyboard.press("Enter"), "and back");
  await page.keyboard.press("m");
  await page.waitForFunction(() => chiaro.marks);
  await changes(marks, async () => {
    await page.mouse.click(x - 40, y);
    await page.mouse.click(x + 40, y);
  }, "a distance");
  assert.equal(await get(() => chiaro.store.state.marks[0].kind), "distance");
  await page.keyboard.press("s");
  await page.keyboard.press("o");
  await page.keyboard.press("k");
  await page.waitForFunction(() => chiaro.store.state.film?.keys.length === 1);
  await changes(azimuth, () => drag(300, 250, 60, 0), "it turns");
  await page.keyboard.press("k");
  await page.waitForFunction(() => chiaro.store.state.film.keys.length === 2);
  await page.evaluate(() => chiaro.film.play());
  await page.waitForFunction(() => chiaro.film.now > 0.1);
  await page.evaluate(() => (chiaro.film.play(), chiaro.toggleFilm()));
  await final();
});

test("Firefox: the picture is saved, and carries its scene", { skip }, async () => {
  // Firefox makes the file at once, empty, and fills another one beside it.
  const saved = () => readdirSync(folder).filter((name) => name.endsWith(".png") && statSync(join(folder, name)).size > 0);
  await page.click("#bar .primary");
  await page.waitForSelector(".popover form");
  await page.click(".popover button.primary");
  await eventually(() => saved().length === 1 && !readdirSync(folder).some((name) => name.endsWith(".part")), "a picture is there");
  const bytes = readFileSync(join(folder, saved()[0]));
  assert.equal(bytes.toString("latin1", 1, 4), "PNG");
  assert.ok(bytes.includes("transfer_function") || bytes.includes("chiaro"));
});

test("Firefox: killed and started again, it goes on; then a file is dropped", { skip }, async () => {
  const was = await get(azimuth);
  await server.end("SIGKILL");
  await page.waitForSelector(".banner button");
  server = await serve(folder, "sample:ball:32", server.port);
  await page.waitForFunction(() => chiaro.link.open || (document.querySelector(".banner button")?.click(), false), { polling: 300 });
  await final();
  assert.equal(await get(azimuth), was);
  const bytes = readFileSync(nrrd(folder, "dropped.nrrd")).toString("base64");
  await page.evaluate((data) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], "dropped.nrrd"));
    for (const kind of ["dragover", "drop"]) document.querySelector("#stage").dispatchEvent(new DragEvent(kind, { bubbles: true, cancelable: true, dataTransfer: transfer }));
  }, bytes);
  await page.waitForFunction(() => document.querySelector(".file b")?.textContent === "dropped.nrrd");
  await final();
  assert.deepEqual(faults.filter((fault) => !/WebSocket|NetworkError|ws:\/\//.test(fault)), []);
});
