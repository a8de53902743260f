// The picture of the plane of value and gradient: how often both come together, the shapes, the curve, and the axes.
import { short } from "./dom.js";
import { ticksOf } from "./graph.js";
import { outlineOf } from "./gradient-shapes.js";

/** The server's picture of counts as opacity, so that any theme can draw it; what occurs once can be seen. @param {Blob} picture */
export async function shadesOf(picture) {
  const bitmap = await createImageBitmap(picture, { colorSpaceConversion: "none" }), { width, height } = bitmap, canvas = new OffscreenCanvas(width, height), g = canvas.getContext("2d");
  g.drawImage(bitmap, 0, 0);
  bitmap.close();
  const image = g.getImageData(0, 0, width, height);
  for (let i = 0; i < image.data.length; i += 4) (image.data[i + 3] = image.data[i] && 64 + 0.75 * image.data[i]), image.data.fill(255, i, i + 3);
  g.putImageData(image, 0, 0);
  return canvas;
}

/** In the theme's colour: the counts are its alpha. */
function tinted(shades, colour) {
  const made = new OffscreenCanvas(shades.width, shades.height), g = made.getContext("2d");
  g.drawImage(shades, 0, 0);
  g.globalCompositeOperation = "source-in";
  g.fillStyle = colour;
  g.fillRect(0, 0, made.width, made.height);
  return made;
}

/** Round magnitudes, as far apart as their words need. */
function magnitudesOf(plane) {
  const found = [0];
  for (const share of [0.33, 0.62, 1]) {
    const m = plane.steepest * share ** 2, unit = 10 ** Math.floor(Math.log10(m)), round = Math.floor(m / unit) * unit;
    if (plane.y(found.at(-1)) - plane.y(round) > 18) found.push(round);
  }
  return found;
}

/** @param {HTMLCanvasElement} canvas @param {import("./gradient-shapes.js").Plane} plane @param {any} o widgets, curve, chosen, colourAt, shades, told, look */
export function drawPlane(canvas, plane, { widgets, curve, chosen, colourAt, shades, told, look }) {
  const ratio = devicePixelRatio, w = canvas.clientWidth, h = canvas.clientHeight, floor = plane.top + plane.height, right = plane.left + plane.width;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) Object.assign(canvas, { width: Math.round(w * ratio), height: Math.round(h * ratio) });
  const g = canvas.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, w, h);
  g.font = `11px ${look.font}`;
  g.lineWidth = 1;
  g.textAlign = "right";
  for (const m of magnitudesOf(plane)) {
    const y = Math.round(plane.y(m)) + 0.5;
    g.strokeStyle = look.grid;
    g.beginPath();
    for (const [from, to] of [[plane.left, right], ...(curve ? [[curve.left, curve.left + curve.width]] : [])]) g.moveTo(from, y), g.lineTo(to, y);
    g.stroke();
    g.fillStyle = look.quiet;
    g.fillText(short(m, 2), plane.left - 6, m ? y + 4 : y + 1);
  }
  g.save();
  g.beginPath();
  g.rect(plane.left, plane.top - 2, plane.width + 1, plane.height + 4);
  g.clip();
  if (shades && told) {
    const [low, high] = told.values, x = plane.x(low), y = plane.y(told.steepest);
    g.drawImage(tinted(shades, look.quiet), x, y, plane.x(high > low ? high : low + 1) - x, floor - y);
  }
  widgets.forEach((widget, i) => {
    const path = (share) => {
      g.beginPath();
      for (const [value, magnitude] of outlineOf(widget, share)) g.lineTo(plane.x(value), plane.y(magnitude));
      g.closePath();
    };
    g.fillStyle = colourAt((widget.value[0] + widget.value[1]) / 2);
    // What is left of the opacity, in four steps.
    const levels = widget.shape === "rectangle" ? [0] : [0, 0.25, 0.5, 0.75];
    g.globalAlpha = (0.15 + 0.4 * widget.opacity) / levels.length;
    for (const share of levels) path(share), g.fill();
    g.globalAlpha = 1;
    path(0);
    g.strokeStyle = i === chosen ? look.accent : look.line;
    g.lineWidth = 1.5;
    g.stroke();
  });
  g.restore();
  g.fillStyle = look.quiet;
  for (const value of ticksOf(plane.view, plane.width)) {
    const x = plane.x(value);
    g.textAlign = x < plane.left + 8 ? "left" : x > right - 10 ? "right" : "center";
    g.fillText(short(value), x, floor + 16);
  }
  if (curve) drawCurve(g, plane, curve, look, floor);
}

/** The curve: upwards the magnitude as beside it, to the right the opacity. */
function drawCurve(g, plane, { points, left, width, at }, look, floor) {
  const line = Array.from({ length: Math.ceil(plane.height) + 1 }, (_, i) => [left + width * at(points, plane.magnitude(floor - i)), floor - i]);
  g.beginPath();
  g.moveTo(left, floor);
  for (const [x, y] of line) g.lineTo(x, y);
  g.lineTo(left, plane.top);
  g.fillStyle = look.histogram;
  g.fill();
  g.beginPath();
  for (const [x, y] of line) g.lineTo(x, y);
  g.strokeStyle = look.line;
  g.lineWidth = 1.5;
  g.stroke();
  g.fillStyle = look.quiet;
  g.textAlign = "center";
  for (const o of [0, 1]) g.fillText(String(o), left + o * width, floor + 16);
}
