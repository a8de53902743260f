// A volume whose numbers tell where they lie, as a file: for tests of page and program together.
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { drawn } from "./page.mjs";
import { serve } from "./served.mjs";

export const dimensions = [40, 30, 20];
export const fileValue = (i, j, k) => i + 100 * j + 3000 * k;

/** Writes NRRD; `directions` are the columns of its frame, "" for space: none. */
export function nrrd(folder, name, { space = "left-posterior-superior", directions = "(1,0,0) (0,1,0) (0,0,2)" } = {}) {
  const n = dimensions, data = Buffer.alloc(2 * n[0] * n[1] * n[2]);
  for (let k = 0, at = 0; k < n[2]; ++k) for (let j = 0; j < n[1]; ++j) for (let i = 0; i < n[0]; ++i, at += 2) data.writeUInt16LE(fileValue(i, j, k), at);
  const frame = space ? `space: ${space}\nspace directions: ${directions}\nspace origin: (-20,-15,10)\n` : "spacings: 1 1 2\n", file = join(folder, name);
  writeFileSync(file, Buffer.concat([Buffer.from(`NRRD0004\ntype: unsigned short\ndimension: 3\nsizes: ${n.join(" ")}\n${frame}endian: little\nencoding: raw\n\n`), data]));
  return file;
}

/** Visits the program as it shows a volume (a file's name, or made by `more`). */
export async function onVolume(all, volume, act, options = {}) {
  const own = await serve(all.folder, volume);
  try {
    await all.visit(act, { url: own.url, ...options });
  } finally {
    await own.end("SIGINT");
  }
}
export const onFile = (all, name, act, more = {}, options = {}) => onVolume(all, nrrd(all.folder, name, more), act, options);

/** Waits until so many slices are drawn as they rest. */
export async function shown(page, count = 3) {
  await drawn(page); // what was changed is asked for in the next frame
  await page.waitForFunction((c) => [...document.querySelectorAll(".pane:not([hidden]) .slice-picture > canvas")].filter(({ dataset }) => dataset.drawn === "final" && dataset.key === dataset.asked).length === c, count, { polling: 30 });
}
export async function slices(page) {
  await page.evaluate(() => chiaro.toggleSlices());
  await shown(page);
}
/** Where a voxel is on the page, in a pane. */
export const place = (page, pane, p) => page.evaluate(async ([i, v]) => {
  const { worldOf, worldToPixel } = await import("./slice-geometry.js"), { picture, view } = chiaro.slices.panes[i], box = picture.getBoundingClientRect();
  const [x, y] = worldToPixel(view(), worldOf(chiaro.volume, v));
  return [box.left + x, box.top + y];
}, [pane, p]);
