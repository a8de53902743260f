// What can be done to the points of an opacity function: pure functions on lists of {value, opacity}.
import { clamp } from "./dom.js";
import { at } from "./scene.js";

/** Peaks: runs of points between two zeros, what people call a material. lo and hi: where it is not 0.
 * @param {any[]} points @param {any[]} stops @param {number[]} range @returns {{first: number, last: number, lo: number, hi: number, rgb: number[], name?: string}[]} */
export function peaksOf(points, stops, range) {
  const peaks = [];
  for (let i = 0; i < points.length; ++i) {
    if (!(points[i].opacity > 0)) continue;
    let last = i;
    while (last + 1 < points.length && points[last + 1].opacity > 0) ++last;
    const first = i > 0 ? i - 1 : i, end = last + 1 < points.length ? last + 1 : last;
    const peak = points.slice(first, end + 1).reduce((a, b) => (b.opacity > a.opacity ? b : a));
    peaks.push({ first, last: end, lo: i > 0 ? points[first].value : Math.min(range[0], points[first].value), hi: last + 1 < points.length ? points[end].value : Math.max(range[1], points[end].value),
      rgb: at(stops, peak.value, "rgb"), name: points[first].name });
    i = last;
  }
  return peaks;
}

/** Moves the chosen points by `dv` as far as their neighbours let them, and their opacity by `factor` (or to `opacity`, of one).
 * @param {any[]} points @param {number[]} chosen @param {number} dv @param {(opacity: number) => number} raise */
export function moved(points, chosen, dv, raise) {
  const all = new Set(chosen);
  for (const i of chosen) {
    if (i > 0 && !all.has(i - 1)) dv = Math.max(dv, points[i - 1].value - points[i].value);
    if (i + 1 < points.length && !all.has(i + 1)) dv = Math.min(dv, points[i + 1].value - points[i].value);
  }
  return points.map((p, i) => (all.has(i) ? { ...p, value: p.value + dv, opacity: clamp(raise(p.opacity), 0, 1) } : p));
}

/** Adds a point; returns the list and its index. */
export function inserted(points, point) {
  const index = points.filter((p) => p.value <= point.value).length;
  return { points: [...points.slice(0, index), point, ...points.slice(index)], index };
}

/** Without the chosen points; two stay. */
export const without = (points, chosen) => (points.length - chosen.length < 2 ? points : points.filter((_, i) => !chosen.includes(i)));

/** Points of a shape, `width` wide around a value. */
function shapePoints(kind, centre, width, opacity) {
  const h = width / 2, bell = [-1, -0.6, -0.3, 0, 0.3, 0.6, 1];
  const rows = {
    ramp: [[-h, 0], [h, opacity]], step: [[0, 0], [0, opacity]], box: [[-h, 0], [-h, opacity], [h, opacity], [h, 0]], peak: [[-h, 0], [0, opacity], [h, 0]],
    bell: bell.map((t) => [t * h, Math.abs(t) === 1 ? 0 : opacity * Math.exp(-4 * t * t)]),
  }[kind];
  return rows.map(([dv, o]) => ({ value: centre + dv, opacity: o }));
}

/** Puts a shape in the place of the points that it covers. Ramp and step leave what follows at least as opaque. */
export function withShape(points, kind, centre, width, opacity = 0.5) {
  const made = shapePoints(kind, centre, width, opacity), lo = made[0].value, hi = made.at(-1).value;
  const before = points.filter((p) => p.value < lo), after = points.filter((p) => p.value > hi);
  if (at(points, lo, "opacity") > 0) made.unshift({ value: lo, opacity: at(points, lo, "opacity") });
  if (kind !== "ramp" && kind !== "step" && at(points, hi, "opacity") > 0) made.push({ value: hi, opacity: at(points, hi, "opacity") });
  if (kind === "ramp" || kind === "step") return [...before, ...made, ...after.map((p) => ({ ...p, opacity: Math.max(p.opacity, opacity) }))];
  return [...before, ...made, ...after];
}

/** All points and stops, stretched so that first and last span the window. */
export function stretched(tf, [lo, hi]) {
  const [a, b] = spanOf(tf), to = (v) => (b > a ? lo + ((v - a) / (b - a)) * (hi - lo) : lo);
  const move = (list) => list.map((p) => ({ ...p, value: to(p.value) }));
  return { ...tf, points: move(tf.points), stops: move(tf.stops), rest: b > a ? restBy(tf.rest, to) : tf.rest };
}

/** What goes by the gradient, where values become others: those that are stretched rise as much more steeply. */
export function restBy(rest, to) {
  const steeper = Math.abs(to(1) - to(0));
  return { ...rest, ...(rest.widgets ? { widgets: rest.widgets.map((w) => ({ ...w, value: w.value.map(to).sort((p, q) => p - q), magnitude: w.magnitude.map((m) => m * steeper) })) } : {}),
    ...(rest.gradient_opacity ? { gradient_opacity: rest.gradient_opacity.map((p) => ({ ...p, magnitude: p.magnitude * steeper })) } : {}) };
}

export const spanOf = (tf) => {
  const values = [...tf.points, ...tf.stops].map((p) => p.value);
  return [Math.min(...values), Math.max(...values)];
};

/** A function for the picture alone: what lies outside [lo, hi] turns grey at `rest` of its opacity. */
export function highlighted(tf, lo, hi, rest) {
  const cut = (list, field) => {
    const inside = list.filter((p) => p.value > lo && p.value < hi);
    return [...list.filter((p) => p.value <= lo), { value: lo, [field]: at(list, lo, field) }, { value: lo, [field]: at(list, lo, field), in: 1 }, ...inside.map((p) => ({ ...p, in: 1 })),
      { value: hi, [field]: at(list, hi, field), in: 1 }, { value: hi, [field]: at(list, hi, field) }, ...list.filter((p) => p.value >= hi)];
  };
  const grey = (rgb) => Array(3).fill(0.3 * rgb[0] + 0.6 * rgb[1] + 0.1 * rgb[2]);
  const points = cut(tf.points, "opacity").map(({ in: kept, ...p }) => (kept ? p : { ...p, opacity: p.opacity * rest }));
  return { ...tf, points, stops: cut(tf.stops, "rgb").map(({ in: kept, ...p }) => (kept ? p : { ...p, rgb: grey(p.rgb) })) };
}

/** A round value near: 1, 2 or 5 times a power of ten that fits a step of `size`. */
export const roundTo = (value, size) => {
  const unit = 10 ** Math.ceil(Math.log10(size));
  return Number((Math.round(value / unit) * unit).toPrecision(12));
};
