// What a saved picture may carry: a scale bar and a legend of the colours, drawn here because the page has the fonts.
import { scaleOf } from "./camera.js";
import { hex, short } from "./dom.js";
import { ticksOf } from "./graph.js";
import { at, read } from "./scene.js";
import { words } from "./texts.js";

const margin = 16, dark = "rgba(0,0,0,.7)", light = "#fff";

/** A round length of at most 110 CSS pixels of so many millimetres: its text and its pixels. */
export function barOf(app, size) {
  const most = size * 110, power = 10 ** Math.floor(Math.log10(most));
  const length = [5, 2, 1].map((k) => k * power).find((v) => v <= most) ?? power;
  return { text: `${short(length)} ${app.unitOfLength()}`, pixels: length / size };
}
/** Of a picture so high, at the centre. */
export const scaleBar = (app, view, height) => barOf(app, scaleOf(view, height));

/** The values that can be seen: where the opacity is not 0, within the file's range and the threshold. */
export function shownRange({ tf, threshold }, [lo, hi]) {
  const points = tf.points, seen = points.filter((p, i) => [i - 1, i, i + 1].some((k) => points[k]?.opacity > 0)).map((p) => p.value);
  const low = Math.max(lo, threshold?.[0] ?? lo, points[0].opacity > 0 ? lo : Math.min(...seen)), high = Math.min(hi, threshold?.[1] ?? hi, points.at(-1).opacity > 0 ? hi : Math.max(...seen));
  return seen.length && low < high ? [low, high] : [lo, hi];
}

/** A piece of `width` × `height` CSS pixels, as PNG in base64 where `place` wants its left upper corner. */
async function piece(width, height, ratio, place, draw) {
  const canvas = new OffscreenCanvas(Math.ceil(width * ratio), Math.ceil(height * ratio)), g = canvas.getContext("2d");
  g.scale(ratio, ratio);
  g.font = `12px ${getComputedStyle(document.body).fontFamily}`;
  g.lineJoin = "round";
  draw(g);
  const url = await new Promise((done) => {
    const reader = new FileReader();
    reader.onload = () => done(reader.result);
    canvas.convertToBlob().then((blob) => reader.readAsDataURL(blob));
  });
  return { at: place(canvas.width, canvas.height), png: url.slice(url.indexOf(",") + 1) };
}

/** White with a dark rim: read on any picture. */
export function write(g, text, x, y, align = "center") {
  Object.assign(g, { textAlign: align, lineWidth: 3, strokeStyle: dark, fillStyle: light });
  g.strokeText(text, x, y);
  g.fillText(text, x, y);
}
export function frame(g, x, y, width, height) {
  g.fillStyle = dark;
  g.fillRect(x - 2, y - 2, width + 4, height + 4);
  g.fillStyle = light;
  g.fillRect(x - 1, y - 1, width + 2, height + 2);
}

function drawLegend(g, app, range, width) {
  const { tf } = app.store.state, left = 24, x = (v) => left + ((v - range[0]) / (range[1] - range[0])) * width;
  frame(g, left, 4, width, 12);
  for (let i = 0; i < width; i += 0.5) {
    g.fillStyle = hex(at(tf.stops, range[0] + ((i + 0.25) / width) * (range[1] - range[0]), "rgb"));
    g.fillRect(left + i, 4, 0.5, 12);
  }
  const ticks = ticksOf(range, width).filter((v) => v <= range[1]);
  for (const v of ticks) write(g, short(v), x(v), 32);
  if (app.volume.unit) write(g, app.volume.unit, left + width + 6, 15, "left");
}
function drawSurfaces(g, app, surfaces) {
  surfaces.forEach(({ value, color }, i) => {
    frame(g, 4, 22 * i + 5, 12, 12);
    g.fillStyle = hex(color ?? at(app.store.state.tf.stops, value, "rgb"));
    g.fillRect(4, 22 * i + 5, 12, 12);
    write(g, `${short(value)} ${app.volume.unit}`, 24, 22 * i + 15, "left");
  });
}

/** The pieces that are wanted of a picture of w × h pixels, for a request to save it. @param {{scale: boolean, legend: boolean, marks: boolean}} wanted */
export async function captions(app, { scale, legend, marks }, w, h) {
  const stage = app.stage, ratio = Math.min(w / stage.clientWidth, h / stage.clientHeight), edge = Math.round(margin * ratio), pieces = [];
  const fits = (width, height) => width * ratio + 2 * edge <= w && height * ratio + 2 * edge <= h;
  if (scale && fits(160, 34)) {
    const { text, pixels } = scaleBar(app, app.view(), h / ratio);
    pieces.push(piece(pixels + 60, 34, ratio, (pw, ph) => [w - edge - pw, h - edge - ph], (g) => {
      frame(g, 55, 26, pixels, 2);
      write(g, text, 55 + pixels / 2, 18);
    }));
  }
  if (legend) {
    const { iso } = app.store.state, surfaces = read(app.store.state, "mode") === "iso" ? iso : null, [width, height] = surfaces ? [160, 22 * surfaces.length] : [270, 38];
    if (fits(width, height)) pieces.push(piece(width, height, ratio, (_, ph) => [edge, h - edge - ph], (g) => (surfaces ? drawSurfaces(g, app, surfaces) : drawLegend(g, app, shownRange(app.store.state, app.volume.range), 200))));
  }
  const figure = marks && app.marks?.figure(w, h, ratio);
  if (figure) pieces.push(piece(figure.width, figure.height, 1, () => [figure.x, figure.y], figure.draw));
  return Promise.all(pieces);
}
