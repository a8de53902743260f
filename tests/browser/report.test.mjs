// The page of `chiaro compare VOLUME --methods` in a browser.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { withPage } from "./page.mjs";

const chiaro = join(process.env.CHIARO_BIN, "chiaro");
const brain = "/usr/share/mricron/templates/ch2better.nii.gz";
const methods = ["spao", "visibility"];

for (const volume of ["sample:cornell:32", brain]) {
  test(`the report on ${volume} opens without a fault`, { skip: volume === brain && !existsSync(brain) }, async () => {
    const folder = mkdtempSync(join(tmpdir(), "chiaro-report-"));
    try {
      const page = join(folder, "report.html");
      const options = ["--size", "96x72", "--reference-rays", "8", "--sh-subsample", "8", "--quiet"];
      execFileSync(chiaro, ["compare", volume, "--methods", methods.join(","), "-o", page, ...options]);
      await withPage(pathToFileURL(page).href, async (opened, faults) => {
        assert.equal(await opened.locator("tr").count(), 1 + methods.length);
        assert.deepEqual(
          await opened.locator("td:first-child").allTextContents(),
          methods,
        );
        const sizes = await opened.locator("img").evaluateAll((images) => images.map((image) => image.naturalWidth));
        assert.deepEqual(sizes, Array(2 * methods.length + 2).fill(96)); // occlusion has a reference of its own
        const truths = await opened.locator(".truth").evaluateAll((all) => all.map((one) => getComputedStyle(one).backgroundImage));
        const references = await opened.locator("img[alt=reference]").evaluateAll((all) => all.map((one) => one.src));
        assert.deepEqual(truths, references.map((source) => `url("${source}")`));
        const truth = opened.locator(".truth").first();
        const shown = () => truth.evaluate((element) => getComputedStyle(element).opacity);
        assert.equal(await shown(), "0");
        await opened.locator("figure > div").first().hover();
        assert.equal(await shown(), "1");
        assert.deepEqual(faults, []);
      });
    } finally {
      rmSync(folder, { recursive: true });
    }
  });
}
