// The viewer in a frame behind a proxy with https, a prefix and another name: proxy.mjs PLAYWRIGHT URL. Drags, and prints the
// azimuth that the page has then, and its address.
import { createRequire } from "node:module";

const [playwright, url] = process.argv.slice(2);
const { chromium } = createRequire(import.meta.url)(playwright);
const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox", "--host-resolver-rules=MAP hub.test 127.0.0.1"] });
try {
  const page = await browser.newPage({ viewport: { width: 1000, height: 700 }, ignoreHTTPSErrors: true });
  const said = [];
  page.on("console", (m) => said.push(m.text()));
  await page.goto(url);
  const eventually = async (holds, says) => {
    for (const end = Date.now() + 60000; ; await new Promise((go) => setTimeout(go, 50))) {
      const found = await holds().catch(() => undefined);
      if (found) return found;
      if (Date.now() > end) throw new Error(`${says}: ${JSON.stringify(said)}`);
    }
  };
  const frame = await eventually(async () => page.frames().find((f) => f !== page.mainFrame() && f.url().includes("key=")), "no frame");
  const newest = () => frame.evaluate(() => { const c = document.querySelector("#stage canvas"); return c?.dataset.stage === "final" && Number(c.dataset.n) === chiaro.link.n && !chiaro.store.dragging ? chiaro.link.n : 0; });
  const before = await eventually(newest, "no final picture");
  await page.mouse.move(200, 300);
  await page.mouse.down();
  await page.mouse.move(320, 300, { steps: 6 });
  await page.mouse.up();
  await eventually(async () => (await newest()) > before, "the drag turned nothing");
  console.log(JSON.stringify({ azimuth: await frame.evaluate(() => chiaro.sceneWith({}).camera.azimuth_deg), frame: frame.url() }));
} finally {
  await browser.close();
}
