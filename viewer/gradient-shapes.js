// What is shown by value and gradient, as shapes over both: pure functions on the widgets and points of a transfer function.
import { clamp } from "./dom.js";

const digits = (x) => Number(x.toPrecision(6));
/** Shares of a range that its ends stay apart by, so that a shape has an inside. */
const least = 0.005;

/** Where values and magnitudes lie in the plot: magnitudes by their square root, so that weak edges have room beside strong ones. */
export class Plane {
  left = 30; top = 6; width = 280; height = 120;
  /** @param {number[]} view the values @param {number} steepest the magnitude on top */
  constructor(view, steepest) {
    this.view = view;
    this.steepest = steepest;
  }
  x = (value) => this.left + ((value - this.view[0]) / (this.view[1] - this.view[0])) * this.width;
  value = (x) => this.view[0] + ((x - this.left) / this.width) * (this.view[1] - this.view[0]);
  y = (magnitude) => this.top + this.height * (1 - Math.sqrt(Math.max(0, magnitude) / this.steepest));
  magnitude = (y) => this.steepest * clamp((this.top + this.height - y) / this.height, 0, 1) ** 2;
}

/** The border of what a widget leaves at least `share` of its opacity in, as [value, magnitude] all around.
 * @param {any} widget @param {number} share */
export function outlineOf({ shape, value: [a, b], magnitude: [low, high] }, share = 0) {
  const middle = (a + b) / 2, half = (b - a) / 2, steps = 24, along = Array.from({ length: steps + 1 }, (_, i) => i / steps);
  if (shape === "ellipse") {
    const r = Math.sqrt(1 - share);
    return along.map((t) => [middle + r * half * Math.cos(2 * Math.PI * t), (low + high) / 2 + (r * (high - low) * Math.sin(2 * Math.PI * t)) / 2]);
  }
  // A triangle is as wide as the box where it ends, and stands on its tip at no gradient.
  const wide = (m) => (shape === "triangle" ? (1 - share) * half * (m / high) : half), side = along.map((t) => low + t * (high - low));
  return [...side.map((m) => [middle - wide(m), m]), ...side.reverse().map((m) => [middle + wide(m), m])];
}

/** A range of shares of the axis, moved as a whole, as far as it goes. */
const movedBy = ([a, b], d, low, high) => ((d = clamp(d, low - a, high - b)), [a + d, b + d]);
const shareOf = (magnitude, steepest) => Math.sqrt(magnitude / steepest);

/** Moves a widget by values and by shares of the magnitude's axis: as large in the plot as before. */
export function moved(widget, dv, dq, steepest) {
  const q = movedBy(widget.magnitude.map((m) => shareOf(m, steepest)), dq, 0, Math.max(1, shareOf(widget.magnitude[1], steepest)));
  return { ...widget, value: widget.value.map((v) => digits(v + dv)), ...(dq ? { magnitude: q.map((s) => digits(steepest * s * s)) } : {}) };
}

/** With one of its sides elsewhere: it stops before the other. @param {any} widget @param {"value"|"magnitude"} key @param {number} which @param {number} to @param {number} range of the whole axis */
export function resized(widget, key, which, to, range) {
  const next = [...widget[key]], apart = least * range * (key === "magnitude" ? least : 1);
  next[which] = digits(which ? Math.max(to, next[0] + apart) : Math.min(key === "magnitude" ? Math.max(0, to) : to, next[1] - apart));
  return { ...widget, [key]: next };
}

/** A widget between two corners of the plot. */
export const between = (shape, values, magnitudes, range, steepest) => {
  const [a, b] = values.map(digits).sort((p, q) => p - q), [low, high] = magnitudes.map((m) => digits(Math.max(0, m))).sort((p, q) => p - q);
  return { shape, value: [a, Math.max(b, digits(a + least * range))], magnitude: [shape === "triangle" ? 0 : low, Math.max(high, low + least * least * steepest)], opacity: 1 };
};

/** The curve over the magnitude: linear between its points, constant outside. */
export function curveAt(points, magnitude) {
  const right = points.findIndex((p) => p.magnitude > magnitude);
  if (right <= 0) return right ? points.at(-1).opacity : points[0].opacity;
  const [a, b] = [points[right - 1], points[right]];
  return a.opacity + ((magnitude - a.magnitude) / (b.magnitude - a.magnitude)) * (b.opacity - a.opacity);
}

/** A point of the curve elsewhere: it stops at its neighbours. */
export const bent = (points, i, magnitude, opacity) => points.map((p, k) => (k === i ? { magnitude: digits(clamp(magnitude, points[i - 1]?.magnitude ?? 0, points[i + 1]?.magnitude ?? Infinity)), opacity: digits(clamp(opacity, 0, 1)) } : p));

/** With one point more, that lies on the curve or where it is put; and its index. */
export function withBend(points, magnitude, opacity) {
  const index = points.filter((p) => p.magnitude <= magnitude).length;
  return [[...points.slice(0, index), { magnitude: digits(magnitude), opacity: digits(opacity) }, ...points.slice(index)], index];
}
