// The picture of the transfer function: histogram, area, line, colour bar, axes. What it looks like at every moment
// follows from the state and the axis; graph-input.js moves both.
import { hex, short } from "./dom.js";
import { at } from "./scene.js";

/** Where values and opacities lie in the graph. */
export class Axis {
  left = 30; top = 8; height = 108; width = 300; linear = false; log = true;
  /** @param {number[]} range of the file */
  constructor(range) {
    this.range = range;
    this.view = [...range];
  }
  x(value) {
    return this.left + ((value - this.view[0]) / (this.view[1] - this.view[0])) * this.width;
  }
  value(x) {
    return this.view[0] + ((x - this.left) / this.width) * (this.view[1] - this.view[0]);
  }
  y(opacity) {
    return this.top + this.height * (1 - (this.linear ? opacity : Math.sqrt(Math.max(opacity, 0))));
  }
  /** Opacity at a height; within 3 pixels of the floor it is exactly 0. */
  opacity(y) {
    const up = 1 - (y - this.top) / this.height;
    if (up * this.height <= 3) return 0;
    return Math.min(1, this.linear ? up : up * up);
  }
  /** Values of one pixel. */
  get pixel() {
    return (this.view[1] - this.view[0]) / this.width;
  }
  zoom(x, factor) {
    const centre = this.value(x), whole = this.range[1] - this.range[0];
    const size = Math.min(Math.max((this.view[1] - this.view[0]) * factor, Math.min(4, whole / 100)), whole * 2);
    const lo = centre - ((x - this.left) / this.width) * size;
    this.view = [lo, lo + size];
  }
  get zoomed() {
    return this.view[0] !== this.range[0] || this.view[1] !== this.range[1];
  }
}

/** Ticks at round values. */
export function ticksOf([lo, hi], width) {
  const raw = ((hi - lo) / width) * 54, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].map((k) => k * power).find((s) => s >= raw) ?? power * 10;
  const ticks = [];
  for (let v = Math.ceil(lo / step) * step; v <= hi + step * 1e-9; v += step) ticks.push(Math.abs(v) < step * 1e-9 ? 0 : v);
  return ticks;
}

/** Heights of the bins in [0, 1] and which are cut: bottom at the 2nd percentile, top at the third largest. */
export function heightsOf(counts, log) {
  const sorted = [...counts].filter((c) => c > 0).sort((a, b) => a - b);
  if (!sorted.length) return counts.map(() => ({ height: 0, cut: false }));
  const f = log ? Math.log1p : (x) => x;
  const low = f(sorted[Math.floor(sorted.length * 0.02)]) * (log ? 0.9 : 0), high = f(sorted.at(-Math.min(3, sorted.length)));
  return counts.map((c) => ({ height: c > 0 ? Math.min(1, Math.max(0.015, (f(c) - low) / Math.max(high - low, 1e-9))) : 0, cut: f(c) > high * 1.0001 }));
}

/** The volume's histogram; whole numbers of few values get a bin each, as narrower ones would leave gaps. */
export function histogramOf({ histogram512, histogram, type }) {
  const { min, max, counts } = histogram512 ?? histogram, width = (max - min) / counts.length;
  if (!type.includes("int") || width >= 1 || !(width > 0)) return { min, max, counts };
  const whole = Array.from({ length: max - min + 1 }, (_, i) => counts[Math.min(counts.length - 1, Math.floor(i / width + 1e-9))]);
  return { min: min - 0.5, max: max + 0.5, counts: whole };
}

/** Share of the voxels in a range of values. */
export function shareOf(histogram, lo, hi) {
  const { min, max, counts } = histogram, width = (max - min) / counts.length || 1;
  let inside = 0, all = 0;
  counts.forEach((c, i) => {
    all += c;
    if (min + (i + 1) * width > lo && min + i * width < hi) inside += c;
  });
  return all ? inside / all : 0;
}

/** Draws the graph. `look`: colours of the theme; `marks`: {hover, seen, selected, glow, box}. */
export function drawGraph(canvas, axis, state, histogram, look, marks) {
  const ratio = devicePixelRatio, w = canvas.clientWidth, h = canvas.clientHeight;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) Object.assign(canvas, { width: Math.round(w * ratio), height: Math.round(h * ratio) });
  const g = canvas.getContext("2d"), { tf } = state, floor = axis.y(0), right = axis.left + axis.width;
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, w, h);
  g.font = `11px ${look.font}`;
  g.lineWidth = 1;
  for (const o of axis.height > 150 ? [0.01, 0.05, 0.1, 0.3, 0.6, 1] : axis.linear ? [0.25, 0.5, 1] : [0.01, 0.1, 0.3, 1]) {
    g.strokeStyle = look.grid;
    g.beginPath();
    g.moveTo(axis.left, Math.round(axis.y(o)) + 0.5);
    g.lineTo(right, Math.round(axis.y(o)) + 0.5);
    g.stroke();
    g.fillStyle = look.quiet;
    g.textAlign = "right";
    g.fillText(String(o), axis.left - 6, axis.y(o) + 4);
  }
  g.save();
  g.beginPath();
  g.rect(axis.left, 0, axis.width + 1, h);
  g.clip();
  histogramShape(g, axis, histogram, look, floor);
  for (let x = 0; x < axis.width; ++x) {
    const value = axis.value(axis.left + x + 0.5), colour = hex(at(tf.stops, value, "rgb")), top = axis.y(at(tf.points, value, "opacity"));
    g.fillStyle = colour;
    g.globalAlpha = 0.42;
    g.fillRect(axis.left + x, top, 1, floor - top);
    g.globalAlpha = 1;
    g.fillRect(axis.left + x, floor + 6, 1.5, 12);
  }
  if (state.threshold) hatch(g, axis, state.threshold, look, floor);
  if (marks.glow) (g.fillStyle = look.accent), (g.globalAlpha = 0.16), g.fillRect(axis.x(marks.glow[0]), axis.top, axis.x(marks.glow[1]) - axis.x(marks.glow[0]), axis.height), (g.globalAlpha = 1);
  g.strokeStyle = look.line;
  g.lineWidth = 1.5;
  g.beginPath();
  const places = [...Array(Math.ceil(axis.width) + 1).keys()].map((x) => axis.value(axis.left + x));
  for (const { value, opacity } of [...places.map((value) => ({ value, opacity: at(tf.points, value, "opacity") })), ...tf.points].sort((a, b) => a.value - b.value)) g.lineTo(axis.x(value), axis.y(opacity));
  g.stroke();
  g.lineWidth = 1;
  const vertical = (value, colour, dashed) => {
    g.strokeStyle = colour;
    g.setLineDash(dashed ? [2, 2] : []);
    g.beginPath();
    g.moveTo(axis.x(value), axis.top - 4);
    g.lineTo(axis.x(value), floor);
    g.stroke();
    g.setLineDash([]);
  };
  if (marks.selected !== undefined) vertical(marks.selected, look.accent, true);
  for (const surface of marks.surfaces ?? []) vertical(surface, look.line, true);
  if (marks.hover !== undefined) {
    vertical(marks.hover, look.line, false);
    g.fillStyle = look.line;
    g.beginPath();
    g.arc(axis.x(marks.hover), axis.y(at(tf.points, marks.hover, "opacity")), 2.5, 0, 7);
    g.fill();
  }
  if (marks.seen !== undefined) (g.fillStyle = look.line), g.fillRect(axis.x(marks.seen) - 1, floor - 5, 2, 5);
  if (marks.box) (g.strokeStyle = look.accent), g.strokeRect(...marks.box);
  g.restore();
  if (axis.zoomed) overview(g, axis, look);
  g.fillStyle = look.quiet;
  const ticks = ticksOf(axis.view, axis.width).filter((v) => axis.x(axis.view[1]) - axis.x(v) > 30 || v === axis.view[1]);
  for (const v of new Set([...ticks, ...(axis.zoomed ? [] : [axis.view[1]])])) {
    const x = axis.x(v);
    g.textAlign = x < axis.left + 8 ? "left" : x > right - 10 ? "right" : "center";
    g.fillText(short(v), x, floor + 44);
  }
}

function histogramShape(g, axis, { min, max, counts }, look, floor) {
  const width = (max - min) / counts.length || 1, heights = heightsOf(counts, axis.log);
  g.fillStyle = look.histogram;
  g.beginPath();
  g.moveTo(axis.x(min), floor);
  heights.forEach(({ height }, i) => {
    g.lineTo(axis.x(min + i * width), floor - height * axis.height);
    g.lineTo(axis.x(min + (i + 1) * width), floor - height * axis.height);
  });
  g.lineTo(axis.x(max), floor);
  g.fill();
  g.strokeStyle = look.line;
  heights.forEach(({ cut }, i) => {
    if (!cut) return;
    const x = axis.x(min + (i + 0.5) * width);
    g.beginPath();
    for (const dy of [10, 14]) (g.moveTo(x - 3, axis.top + dy + 2), g.lineTo(x + 3, axis.top + dy - 2));
    g.stroke();
  });
}

function hatch(g, axis, [lo, hi], look, floor) {
  g.strokeStyle = look.quiet;
  for (const [from, to] of [[axis.left, axis.x(lo)], [axis.x(hi), axis.left + axis.width]]) {
    if (to <= from) continue;
    g.save();
    g.beginPath();
    g.rect(from, axis.top, to - from, axis.height);
    g.clip();
    g.beginPath();
    for (let x = from - axis.height; x < to; x += 6) (g.moveTo(x, floor), g.lineTo(x + axis.height, axis.top));
    g.stroke();
    g.restore();
  }
}

function overview(g, axis, look) {
  const whole = axis.range[1] - axis.range[0] || 1, part = (v) => axis.left + Math.min(1, Math.max(0, (v - axis.range[0]) / whole)) * axis.width;
  g.fillStyle = look.grid;
  g.fillRect(axis.left, 0, axis.width, 4);
  g.fillStyle = look.quiet;
  g.fillRect(part(axis.view[0]), 0, Math.max(2, part(axis.view[1]) - part(axis.view[0])), 4);
}
