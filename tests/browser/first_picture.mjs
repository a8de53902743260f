// What scripts/first_picture measures: a fresh browser each time, from the address to what is seen.
import { launch, openPage } from "./page.mjs";

const [url, times = "5"] = process.argv.slice(2), middle = (values) => [...values].sort((a, b) => a - b)[values.length >> 1], rows = { "first paint": [], "first picture": [], "final picture": [] };
for (let i = 0; i < Number(times); ++i) {
  const browser = await launch(), context = await browser.newContext({ viewport: { width: 1440, height: 900 } });
  await context.addInitScript(() => addEventListener("load", () => {
    const { shown } = chiaro;
    chiaro.shown = (header) => ((window.first ??= performance.now()), header.stage === "final" && (window.last ??= performance.now()), shown(header));
  }));
  const { page } = await openPage({ newPage: () => context.newPage() }, url);
  await page.waitForFunction(() => window.last);
  const seen = await page.evaluate(() => [performance.getEntriesByName("first-paint")[0]?.startTime ?? NaN, window.first, window.last]);
  Object.values(rows).forEach((row, k) => row.push(seen[k]));
  await browser.close();
}
console.log("| milliseconds | median | largest | asked |\n| --- | ---: | ---: | ---: |");
for (const [[name, row], asked] of Object.entries(rows).map((entry, k) => [entry, ["300", "800", ""][k]])) console.log(`| ${name} | ${middle(row).toFixed(0)} | ${Math.max(...row).toFixed(0)} | ${asked} |`);
