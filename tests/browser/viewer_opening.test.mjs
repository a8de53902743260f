// Opening what lies on this computer: dropped or chosen, a file or a folder; the page that has no volume yet.
import assert from "node:assert/strict";
import { mkdirSync, readdirSync, readFileSync, statSync, truncateSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { eventually, faint, final } from "./visit.mjs";
import { openPage } from "./page.mjs";
import { options, serve, servedVisits, skip } from "./served.mjs";
import { nrrd } from "./volume_file.mjs";

const all = servedVisits();

async function empty(act, { more = [], allowed = /$^/, page: own = options } = {}) {
  const server = await serve(all.folder, "", 0, more), { page, faults } = await openPage(all.browser, server.url, own);
  try {
    await page.waitForSelector("h1:has-text('Open a volume')");
    await act(page);
    assert.deepEqual(faults.filter((fault) => !allowed.test(fault)), []);
  } finally {
    await page.close();
    await server.end("SIGINT");
  }
}
const drop = (page, files) => page.evaluate((given) => {
  const transfer = new DataTransfer();
  for (const [name, bytes] of given) transfer.items.add(new File([Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0))], name));
  document.querySelector("#stage").dispatchEvent(new DragEvent("dragover", { bubbles: true, cancelable: true, dataTransfer: transfer }));
  document.querySelector("#stage").dispatchEvent(new DragEvent("drop", { bubbles: true, cancelable: true, dataTransfer: transfer }));
}, files.map(([name, bytes]) => [name, bytes.toString("base64")]));
/** Files below the server's private folders. */
const sent = () => {
  const below = (folder) => readdirSync(folder, { withFileTypes: true }).flatMap((e) => (e.isDirectory() ? below(join(folder, e.name)) : [join(folder, e.name)]));
  try {
    return below(join(all.folder, "chiaro")).filter((file) => /chiaro-view-/.test(file.slice(all.folder.length)));
  } catch {
    return [];
  }
};

test("a file that is dropped is sent, opened, and gone when the server ends", { skip }, async () => {
  const bytes = readFileSync(nrrd(all.folder, "dropped.nrrd"));
  await empty(async (page) => {
    await drop(page, [["dropped.nrrd", bytes]]);
    await final(page);
    assert.equal(await page.locator(".file b").textContent(), "dropped.nrrd");
    assert.deepEqual(sent().map((file) => readFileSync(file).equals(bytes)), [true]);
    // Another one takes its place; what is no volume leaves it.
    await drop(page, [["broken.nrrd", bytes.subarray(0, 5000)]]);
    await page.waitForSelector("h1:has-text('could not be read')");
    assert.match(await page.locator(".state p").textContent(), /broken\.nrrd/);
    await page.click("button:has-text('Back to the picture')");
    assert.equal(await page.locator(".file b").textContent(), "dropped.nrrd");
  });
  assert.deepEqual(sent(), []);
});

test("a folder is chosen by a button: its header is opened", { skip }, () => empty(async (page) => {
  const folder = join(all.folder, "series");
  mkdirSync(join(folder, "raw"), { recursive: true });
  writeFileSync(join(folder, "scan.mhd"), "ObjectType = Image\nNDims = 3\nDimSize = 12 10 8\nElementType = MET_UCHAR\nElementSpacing = 1 1 2\nElementDataFile = raw-scan.raw\n");
  writeFileSync(join(folder, "raw", "scan.raw"), Buffer.from(Array.from({ length: 960 }, (_, i) => i % 200)));
  writeFileSync(join(folder, ".hidden"), "nothing");
  const chooser = page.waitForEvent("filechooser");
  await page.click("button:has-text('Choose a folder')");
  await (await chooser).setFiles(folder);
  await final(page);
  assert.equal(await page.locator(".file b").textContent(), "scan.mhd");
  assert.deepEqual(sent().map((file) => file.split("/").at(-1)).sort(), ["raw-scan.raw", "scan.mhd"]);
}));

test("a folder of DICOM", { skip: skip || (process.env.CHIARO_DATA_DIR ? false : "no data") }, () => empty(async (page) => {
  const chooser = page.waitForEvent("filechooser");
  await page.click("button:has-text('Choose a folder')");
  await (await chooser).setFiles(join(process.env.CHIARO_DATA_DIR, "volumes", "t1_slab_dicom"));
  await final(page);
  assert.match(await page.locator(".file span").textContent(), /×/);
}));

test("progress and cancel: what was sent is taken away", { skip }, () => empty(async (page) => {
  const file = join(all.folder, "large_512x512x400_uint8.raw");
  writeFileSync(file, "");
  truncateSync(file, 512 * 512 * 400);
  const wire = await page.context().newCDPSession(page);
  await wire.send("Network.enable");
  await wire.send("Network.emulateNetworkConditions", { offline: false, latency: 0, downloadThroughput: -1, uploadThroughput: 4e6 });
  const chooser = page.waitForEvent("filechooser");
  await page.click("button:has-text('Choose a file')");
  await (await chooser).setFiles(file);
  await page.waitForSelector("h1:has-text('Sending large_512x512x400_uint8.raw')");
  await page.waitForFunction(() => /[1-9].*%/.test(document.querySelector(".state p")?.textContent ?? ""));
  assert.equal(sent().length, 1);
  assert.ok(statSync(sent()[0]).size < 512 * 512 * 400);
  await page.click(".state button:has-text('Cancel')");
  await page.waitForSelector("h1:has-text('Open a volume')");
  await eventually(() => sent().length === 0, "the part that came is gone");
}, { allowed: /volume\?/ }));

test("more than is allowed is refused in a sentence", { skip }, () => empty(async (page) => {
  await drop(page, [["big.nrrd", Buffer.alloc(200000)]]);
  await page.waitForSelector("h1:has-text('could not be taken')");
  assert.equal(await page.locator(".state p").textContent(), "A volume may have at most 104.9 KiB (--max-upload).");
}, { more: ["--max-upload", "0.0001"], allowed: /volume\?|413/ }));

for (const colorScheme of ["dark", "light"])
  test(`the page without a volume in the ${colorScheme} theme: samples, recent volumes with their pictures, by keys`, { skip }, () => empty(async (page) => {
    await page.click("button:has-text('Try a sample')");
    await page.click(".item:has-text('ball')");
    await final(page);
    await page.waitForFunction(() => JSON.parse(localStorage.getItem("recent") ?? "[]").length === 1);
    await page.evaluate(() => (sessionStorage.clear(), chiaro.states.empty()));
    await page.waitForSelector(".recent img");
    assert.ok(await page.locator(".recent img").evaluate((image) => image.naturalWidth === 128));
    assert.deepEqual(await faint(page), []);
    assert.ok(await page.evaluate(() => document.documentElement.scrollHeight <= innerHeight && document.documentElement.scrollWidth <= innerWidth));
    await page.locator(".recent button").focus();
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => !document.querySelector(".state"));
    await final(page);
    assert.equal(await page.locator(".file b").textContent(), "sample:ball");
  }, { page: { ...options, colorScheme } }));
