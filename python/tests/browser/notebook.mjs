// A notebook in Chromium: notebook.mjs PLAYWRIGHT URL PICTURE. Runs the cells of test_view_browser.py one after the other, with
// what a person does in between; prints JSON of what was seen.
import { createRequire } from "node:module";
import assert from "node:assert/strict";

const [playwright, url, picture] = process.argv.slice(2);
const { chromium } = createRequire(import.meta.url)(playwright);
const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox", "--ignore-certificate-errors"] });
const page = await browser.newPage({ viewport: { width: 1280, height: 1000 }, ignoreHTTPSErrors: true });
const seen = { messages: [] };
page.on("console", (m) => m.type() === "error" && seen.messages.push(m.text()));

async function eventually(holds, says, timeout = 60000) {
  const end = Date.now() + timeout;
  for (;;) {
    const found = await holds().catch(() => undefined);
    if (found) return found;
    if (Date.now() > end) {
      await page.screenshot({ path: picture });
      throw new Error(`${says}; the browser said ${JSON.stringify(seen.messages)}`);
    }
    await new Promise((go) => setTimeout(go, 50));
  }
}

try {
  await page.goto(url);
  await page.waitForFunction(() => window.Jupyter?.notebook?.kernel?.is_connected(), null, { timeout: 60000 });
  const run = (k) => page.evaluate((i) => { Jupyter.notebook.select(i); Jupyter.notebook.execute_cells([i]); }, k);
  const output = (k) => page.evaluate((i) => Jupyter.notebook.get_cell(i).output_area.outputs.map((o) => o.text ?? "").join(""), k);

  await run(0);
  const frame = await eventually(async () => page.frames().find((f) => f !== page.mainFrame() && /[?]key=/.test(f.url())), "no page under the cell");
  const newest = () => frame.evaluate(() => { const c = document.querySelector("#stage canvas"); return c?.dataset.stage === "final" && Number(c.dataset.n) === chiaro.link.n && !chiaro.store.dragging ? chiaro.link.n : 0; });
  const pixels = () => frame.evaluate(() => { const c = document.querySelector("#stage canvas"), { data } = c.getContext("2d").getImageData(0, 0, c.width, c.height); let sum = 0x811c9dc5; for (const b of data) sum = Math.imul(sum ^ b, 0x01000193) >>> 0; return `${c.width}x${c.height}:${sum}`; });
  await eventually(newest, "no final picture");
  const first = await pixels();

  // From Python: the picture moves.
  const before = await newest();
  await run(1);
  await eventually(async () => (await newest()) > before, "what Python set is not shown");
  const second = await pixels();
  assert.notEqual(second, first, "the same picture");
  seen.page_azimuth = await frame.evaluate(() => chiaro.sceneWith({}).camera.azimuth_deg);

  // By mouse: Python sees it.
  const box = await (await frame.frameElement()).boundingBox();
  await page.mouse.move(box.x + 200, box.y + 250);
  await page.mouse.down();
  await page.mouse.move(box.x + 320, box.y + 250, { steps: 6 });
  await page.mouse.up();
  const turned = await newest();
  await eventually(async () => (await newest()) > before + 1 && (await pixels()) !== second, `the drag turned nothing (${turned})`);
  seen.dragged_azimuth = await frame.evaluate(() => chiaro.sceneWith({}).camera.azimuth_deg);
  await run(2);
  seen.python_azimuth = Number(await eventually(() => output(2), "no answer of the kernel"));

  seen.frame = frame.url();
  await page.screenshot({ path: picture });
  await page.evaluate(() => Jupyter.notebook.save_notebook());
  await eventually(() => page.evaluate(() => !Jupyter.notebook.dirty), "the notebook is not saved");
  console.log(JSON.stringify(seen));
} finally {
  await browser.close();
}
