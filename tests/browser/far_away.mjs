// What scripts/far_away measures at a page behind a slow way.
import { launch, openPage } from "./page.mjs";
import { relay } from "./relay.mjs";
import { final } from "./visit.mjs";

const quantile = (values, share) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(share * values.length))] ?? NaN;

/** In the page: when the pointer moved, what was sent then, and what was drawn. */
const watch = () => {
  const seen = (window.seen = { moves: [], sends: [], frames: [], drafts: new Map(), pairs: [] });
  addEventListener("pointermove", () => seen.moves.push(performance.now()), true);
  const send = WebSocket.prototype.send;
  WebSocket.prototype.send = function (text) {
    const n = /^\{"type":"state","n":(\d+)/.exec(text)?.[1];
    if (n) seen.sends.push([Number(n), performance.now(), text.length]);
    return send.call(this, text);
  };
  const copy = () => {
    const { canvas } = chiaro.frame, made = new OffscreenCanvas(canvas.width, canvas.height);
    made.getContext("2d").drawImage(canvas, 0, 0);
    return made;
  };
  addEventListener("load", () => {
    const shown = chiaro.shown;
    chiaro.shown = (header) => {
      seen.frames.push([header.n, performance.now(), header.size[0], header.stage]);
      if (header.stage === "draft" && header.moving && window.comparing) window.draft = copy();
      if (header.stage === "final" && window.draft) seen.pairs.push([window.draft, copy()]), (window.draft = null);
      shown(header);
    };
    const slices = chiaro.link.ask.bind(chiaro.link);
    chiaro.link.ask = (type, ...rest) => {
      const asked = slices(type, ...rest), at = performance.now();
      if (type === "slice" || type === "film_frame") asked.then(() => (seen[type] ??= []).push([at, performance.now()]), () => {});
      return asked;
    };
  });
};

/** The mean SSIM of luminance over blocks of 8 × 8, of a draft drawn over the whole and the lossless picture. */
const similar = () => window.seen.pairs.map(([draft, whole]) => {
  const of = (picture) => {
    const made = new OffscreenCanvas(whole.width, whole.height), g = made.getContext("2d");
    g.drawImage(picture, 0, 0, whole.width, whole.height);
    const { data } = g.getImageData(0, 0, whole.width, whole.height);
    return Float64Array.from({ length: data.length / 4 }, (_, i) => 0.2126 * data[4 * i] + 0.7152 * data[4 * i + 1] + 0.0722 * data[4 * i + 2]);
  };
  const [a, b] = [of(draft), of(whole)], w = whole.width;
  let sum = 0, blocks = 0;
  for (let y = 0; y + 8 <= whole.height; y += 4)
    for (let x = 0; x + 8 <= w; x += 4) {
      let ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
      for (let j = 0; j < 64; ++j) {
        const i = (y + (j >> 3)) * w + x + (j & 7);
        (ma += a[i]), (mb += b[i]), (aa += a[i] * a[i]), (bb += b[i] * b[i]), (ab += a[i] * b[i]);
      }
      (ma /= 64), (mb /= 64);
      const va = aa / 64 - ma * ma, vb = bb / 64 - mb * mb, c = ab / 64 - ma * mb;
      sum += ((2 * ma * mb + 6.5) * (2 * c + 58.5)) / ((ma * ma + mb * mb + 6.5) * (va + vb + 58.5)), ++blocks;
    }
  return sum / blocks;
});

/** Drags on the picture for so many seconds, to and fro; the pointer is let go at the end. */
async function orbit(page, seconds, half = () => {}) {
  const began = Date.now();
  await page.mouse.move(476, 400);
  await page.mouse.down();
  let halved = false;
  for (let i = 1; Date.now() - began < 1000 * seconds; ++i) {
    const t = (Date.now() - began) / 1000;
    if (!halved && t > seconds / 2) (halved = true), half();
    await page.mouse.move(476 + 200 * Math.sin(t), 400 + 60 * Math.sin(1.7 * t));
    await new Promise((go) => setTimeout(go, 12));
  }
  const rested = await page.evaluate(() => performance.now());
  await page.mouse.up();
  await final(page);
  return rested;
}

/** Of each move of the pointer in the time: how long until a frame drawn after it answers a state sent after it. */
function latencies({ moves, sends, frames }, from, to) {
  const found = [];
  for (const at of moves.filter((t) => t >= from && t < to)) {
    const sent = sends.find(([, t]) => t >= at), frame = sent && frames.find(([n]) => n >= sent[0]);
    if (frame) found.push([at, frame[1] - at]);
  }
  return found;
}
const seenBy = (page) => page.evaluate(() => ({ moves: seen.moves, sends: seen.sends, frames: seen.frames, slice: seen.slice ?? [], film: seen.film_frame ?? [] }));
const clear = (page) => page.evaluate(() => Object.assign(seen, { moves: [], sends: [], frames: [], slice: [], film_frame: [] }));

/** Scrolls slices for five seconds, a wheel's notch every so many milliseconds: the time of each slice that came. */
async function scrolled(page, every_ms, prepare = async () => {}) {
  await page.evaluate(() => chiaro.toggleSlices());
  await page.waitForFunction(() => document.querySelector(".pane:not([hidden]) canvas")?.dataset.drawn === "final");
  await prepare();
  await page.mouse.move(240, 200);
  await clear(page);
  const began = Date.now();
  for (; Date.now() - began < 5000; await new Promise((go) => setTimeout(go, every_ms))) page.mouse.wheel(0, 100 * (Math.floor((Date.now() - began) / 1500) % 2 ? -1 : 1)).catch(() => {});
  return (await seenBy(page)).slice.map(([asked, came]) => came - asked);
}

/** A slice of 512 x 512 pixels, with no way between. */
async function measureNear(browser, url) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
  await context.addInitScript(watch);
  const { page, faults } = await openPage({ newPage: () => context.newPage() }, url);
  await final(page);
  const size = () => page.evaluate(() => { const { width, height } = document.querySelector(".pane.large canvas"); return [width, height]; });
  const slice = await scrolled(page, 8, async () => {
    await page.locator(".pane .tool").first().click();
    await page.waitForTimeout(1000);
    const [width, height] = await size(), seen = page.viewportSize();
    await page.setViewportSize({ width: seen.width + 512 - width, height: seen.height + 512 - height });
    await page.waitForTimeout(1000);
  });
  console.log(`| loopback | slices of ${(await size()).join(" x ")} a second; 95 % of their times, ms | ${(slice.length / 5).toFixed(1)}; ${quantile(slice, 0.95).toFixed(0)} | >= 30 |`);
  if (faults.length) console.log(`| loopback | faults | ${faults.join("; ")} | none |`);
  await context.close();
}

/** Prints rows of a table of one way. */
async function measure(browser, url, name, way, asked, seconds) {
  const slow = await relay(Number(new URL(url).port), way), address = new URL(url);
  address.port = String(slow.port);
  const row = (what, value, wanted) => console.log(`| ${name} | ${what} | ${value} | ${wanted} |`);
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
  await context.addInitScript(watch);
  const { page, faults } = await openPage({ newPage: () => context.newPage() }, address.href);
  await final(page);
  await orbit(page, 3);
  await clear(page);
  way.longest_queue_ms = 0;
  const rested = await orbit(page, seconds), seen = await seenBy(page);
  const from = seen.moves[0] + 500, ages = latencies(seen, from, rested).map(([, age]) => age), moving = seen.frames.filter(([, t]) => t > from && t < rested);
  row("orbit: frames a second", ((1000 * moving.length) / (rested - from)).toFixed(1), `>= ${asked.rate}`);
  row("pointer to picture, median and 95 %, ms", `${quantile(ages, 0.5).toFixed(0)}, ${quantile(ages, 0.95).toFixed(0)}`, `95 % <= ${asked.age}`);
  row("narrowest draft (median), pixels", `${Math.min(...moving.map(([, , w]) => w))} (${quantile(moving.map(([, , w]) => w), 0.5)})`, `>= ${asked.width}`);
  row("lossless after rest, ms", (seen.frames.filter(([, , , stage]) => stage === "final").at(-1)[1] - rested).toFixed(0), `<= ${asked.rest}`);
  row("bytes of a state; states a second", `${quantile(seen.sends.map(([, , n]) => n), 0.5)}; ${((1000 * seen.sends.filter(([, t]) => t > from && t < rested).length) / (rested - from)).toFixed(0)}`, "");
  // Drafts beside the lossless picture of the same state: held still in the middle of a drag.
  await page.evaluate(() => (window.comparing = true));
  for (const x of [120, -90, 60]) {
    await page.mouse.move(476, 400);
    await page.mouse.down();
    await page.mouse.move(476 + x, 400 + x / 3, { steps: 12 });
    await page.waitForFunction((n) => seen.pairs.length >= n, [120, -90, 60].indexOf(x) + 1);
    await page.mouse.up();
    await final(page);
  }
  row("SSIM of drafts, least", Math.min(...(await page.evaluate(similar))).toFixed(3), ">= 0.85");
  // The rate falls to half in the middle.
  await clear(page);
  const whole = way.bits_per_ms;
  let halved = 0;
  await orbit(page, 10, () => ((way.bits_per_ms = whole / 2), page.evaluate(() => performance.now()).then((t) => (halved = t))));
  const after = await seenBy(page), told = latencies(after, halved, Infinity).filter(([at]) => at < halved + 4500), usual = quantile(told.filter(([at]) => at > halved + 2000).map(([, age]) => age), 0.95);
  const late = told.filter(([, age]) => age > 1.25 * usual).at(-1);
  row("half the rate: steady after, ms (95 % then)", `${late && late[0] < halved + 2500 ? (late[0] - halved).toFixed(0) : 0} (${usual.toFixed(0)})`, "<= 2000");
  row("longest queue, ms", way.longest_queue_ms.toFixed(0), "<= 1000");
  way.bits_per_ms = whole;
  // Slices, scrolled; the play bar.
  const slice = await scrolled(page, 30);
  row("slices a second; 95 % of their times, ms", `${(slice.length / 5).toFixed(1)}; ${quantile(slice, 0.95).toFixed(0)}`, `>= ${asked.rate}; <= ${asked.age}`);
  await page.evaluate(() => chiaro.toggleSlices());
  await page.evaluate(() => chiaro.toggleFilm().then(() => document.querySelectorAll("#film .film-bar > .plain")[2].click()));
  await final(page);
  await clear(page);
  await page.evaluate(() => chiaro.film.play());
  await page.waitForTimeout(5000);
  const played = await seenBy(page), since = played.sends[0]?.[1] ?? 0, shown = played.frames.filter(([, t]) => t > since);
  row("film played: frames a second", (shown.length / 5).toFixed(1), `>= ${asked.rate}`);
  if (faults.length) row("faults", faults.join("; "), "none");
  await context.close();
  await slow.close();
}

const [url, seconds = "10", only = ""] = process.argv.slice(2), browser = await launch();
console.log("| way | what | measured | asked |\n| --- | --- | ---: | --- |");
if ("loopback".includes(only)) await measureNear(browser, url);
for (const jitter_ms of [0, 40])
  for (const [name, way, asked] of [
    ["50 ms, 5 Mbit/s", { round_trip_ms: 50, bits_per_ms: 5000 }, { rate: 15, age: 150, width: 640, rest: 2000 }],
    ["150 ms, 2 Mbit/s", { round_trip_ms: 150, bits_per_ms: 2000 }, { rate: 8, age: 350, width: 480, rest: 4000 }],
  ])
    if (`${name}${jitter_ms ? ", jitter" : ""}`.includes(only)) await measure(browser, url, `${name}${jitter_ms ? ", ± 20 ms" : ""}`, { ...way, jitter_ms }, asked, Number(seconds));
await browser.close();
