// What a mark is in numbers, in a table and as lines: of pages, saved figures and files alike.
import { add, dot, unit } from "./camera.js";
import { short } from "./dom.js";
import { voxelOf, worldOf } from "./slice-geometry.js";

/** How many points a kind has: at least, at most. */
export const pointsOf = { distance: [2, 2], polyline: [2, 1000], angle: [3, 3], ball: [2, 2], box: [2, 2], profile: [2, 2], arrow: [2, 2], text: [1, 1] };
export const kinds = Object.keys(pointsOf);
export const isRegion = ({ kind }) => kind === "ball" || kind === "box";
const between = (a, b) => Math.hypot(...add(b, a, -1));

/** Of a line its length, of a ball its radius; mm. */
export const lengthOf = ({ points }) => points.slice(1).reduce((sum, p, i) => sum + between(points[i], p), 0);
/** At the second of three points, in degrees. */
export function angleOf({ points: [a, b, c] }) {
  const u = add(a, b, -1), v = add(c, b, -1);
  if (!Math.hypot(...u) || !Math.hypot(...v)) return NaN;
  return (Math.acos(Math.max(-1, Math.min(1, dot(unit(u), unit(v))))) * 180) / Math.PI;
}

/** What the server is asked of a region. */
export const regionOf = ({ kind, points: [a, b] }) => (kind === "ball" ? { shape: "ball", centre: a, radius: between(a, b) } : { shape: "box", corner: a, opposite: b });

/** In a few words. @param {any} mark @param {any} region what the server said, or nothing yet */
export function saysOf(mark, region, { length, value, mean }) {
  if (mark.kind === "angle") return `${angleOf(mark).toFixed(1)}°`;
  if (mark.kind === "text" || mark.kind === "arrow") return "";
  if (isRegion(mark)) return !region ? "…" : region.sentence ? "–" : `${mean} ${short(region.mean)}${region.deviation === null ? "" : ` ± ${short(region.deviation, 3)}`}${value ? " " + value : ""}`;
  return `${short(lengthOf(mark))} ${length}`;
}

/** The eight corners of a box whose edges run along the volume's axes. */
function cornersOf(volume, [a, b]) {
  const [p, q] = [a, b].map((point) => voxelOf(volume, point));
  return [...Array(8).keys()].map((i) => worldOf(volume, [0, 1, 2].map((k) => (i >> k & 1 ? q : p)[k])));
}

/** Whether a slice meets a mark. */
function isWithin({ kind, points }, on) {
  const away = points.map(on.away);
  if (kind === "ball" && points.length > 1) return Math.abs(away[0]) <= between(...points);
  return away.some((d) => Math.abs(d) <= on.half) || (Math.min(...away) <= 0 && Math.max(...away) >= 0);
}

/** Lines ({line: points, closed}), circles ({circle: [x, y], r}) and texts ({text, at}) of a mark, in pixels. `on` is what it is
 * drawn on: {at(point) → [x, y], mm: of a pixel at a point, away(point): mm in front of or behind a slice, half: mm that count as within, width: of all of it}. */
export function linesOf(mark, on, says, volume) {
  const { kind, points } = mark, at = points.map(on.at), parts = [];
  const label = [mark.text, says].filter(Boolean).join(": ");
  if (kind === "ball") {
    const r = between(points[0], points[1] ?? points[0]), d = on.away(points[0]), part = r * r - d * d;
    if (part > 0) parts.push({ circle: at[0], r: Math.sqrt(part) / on.mm(points[0]) });
  } else if (kind === "box" && points.length > 1) {
    const corners = cornersOf(volume, points).map(on.at);
    for (let i = 0; i < 8; ++i) for (const bit of [1, 2, 4]) if (!(i & bit)) parts.push({ line: [corners[i], corners[i | bit]] });
  } else if (kind !== "text") parts.push({ line: at });
  if (kind === "arrow" && at.length > 1) {
    const along = [at[1][0] - at[0][0], at[1][1] - at[0][1]], length = Math.hypot(...along) || 1, [x, y] = along.map((c) => (c / length) * 12);
    parts.push({ line: [[at[0][0] + x - y / 2, at[0][1] + y + x / 2], at[0], [at[0][0] + x + y / 2, at[0][1] + y - x / 2]] });
  }
  if (kind === "angle" && at.length === 3) {
    const arms = [at[0], at[2]].map((p) => [p[0] - at[1][0], p[1] - at[1][1]]), r = Math.min(24, ...arms.map((a) => Math.hypot(...a) * 0.6)), from = Math.atan2(arms[0][1], arms[0][0]);
    const turn = ((((Math.atan2(arms[1][1], arms[1][0]) - from) % (2 * Math.PI)) + 3 * Math.PI) % (2 * Math.PI)) - Math.PI;
    parts.push({ line: [...Array(17).keys()].map((i) => [at[1][0] + r * Math.cos(from + (turn * i) / 16), at[1][1] + r * Math.sin(from + (turn * i) / 16)]) });
  }
  const within = isWithin(mark, on);
  if (label && at.length && within) {
    const of = kind === "angle" ? at[1] : kind === "arrow" ? at.at(-1) : at.reduce((a, b) => (b[0] > a[0] ? b : a));
    // At the right edge it stands at the left of its place.
    const left = of[0] + 9 + 7.5 * label.length > on.width;
    parts.push({ text: label, left, at: [of[0] + (left ? -9 : 9), Math.max(of[1] - 7, 14)] });
  }
  return { parts, within };
}

const quoted = (text) => (/[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
/** Texts that a spreadsheet would take for a formula are made plain. */
const plain = (text) => quoted(/^[=+\-@\t\r]/.test(text) ? `'${text}` : text);
const number = (v) => (v === undefined || v === null || Number.isNaN(v) ? "" : String(v));

/** The table as CSV: lengths in mm (or voxels), places in the file's frame. @param {any[]} rows [{mark, region}] */
export function csvOf(rows, { length, value, frame, names }) {
  const u = length === "mm" ? "mm" : "voxels";
  const head = ["name", "kind", `length_or_radius_${u}`, "angle_degrees", "voxels", "mean", "standard_deviation", "min", "max", "p1", "p5", "p25", "median", "p75", "p95", "p99", `volume_of_voxels_${u}3`, `exact_volume_${u}3`, "unit_of_values", "frame", `points_${u}`];
  const lines = rows.map(({ mark, region: r }, i) => [plain(mark.text || names(mark, i)), mark.kind, isRegion(mark) ? (mark.kind === "ball" ? number(lengthOf(mark)) : "") : mark.kind === "angle" || mark.kind === "text" || mark.kind === "arrow" ? "" : number(lengthOf(mark)), mark.kind === "angle" ? number(angleOf(mark)) : "",
    ...[r?.count, r?.mean, r?.deviation, r?.min, r?.max, ...["1", "5", "25", "50", "75", "95", "99"].map((p) => r?.percentiles?.[p]), r?.volume_mm3, r?.exact_mm3].map(number), plain(value), frame, quoted(mark.points.map((p) => p.map(number).join(" ")).join("; "))]);
  return [head, ...lines].map((line) => line.join(",")).join("\r\n") + "\r\n";
}
