// Where slices lie: their planes, what a pixel of them is in the world and in voxels, and the letters at their sides.
import { add, cross, dot, unit } from "./camera.js";

/** A step of one voxel along an axis of the volume, in the world (mm). */
export const stepOf = (volume, k) => [0, 1, 2].map((row) => volume.direction[row][k] * volume.spacing_mm[k]);
export const worldOf = (volume, voxel) => voxel.reduce((p, v, k) => add(p, stepOf(volume, k), v), volume.origin_mm);
/** The inverse, by Cramer's rule: axes may be oblique. */
export function voxelOf(volume, point) {
  const [a, b, c] = [0, 1, 2].map((k) => stepOf(volume, k)), d = add(point, volume.origin_mm, -1), det = dot(a, cross(b, c));
  return [dot(d, cross(b, c)) / det, dot(d, cross(c, a)) / det, dot(d, cross(a, b)) / det];
}
/** The point of the volume nearest to a point, along its axes. */
export const within = (volume, point) => worldOf(volume, voxelOf(volume, point).map((v, k) => Math.min(Math.max(v, 0), volume.dimensions[k] - 1)));
export const middleOf = (volume) => worldOf(volume, volume.dimensions.map((n) => Math.floor(n / 2)));

/** What lies in a direction, where the file states its frame (LPS or RAS): the side that it points at most, and a second
 * one where it is more than 22° off. */
export function letterOf(direction, world) {
  if (world === "unknown") return "";
  const s = world === "RAS" ? -1 : 1, d = unit(direction);
  return [[s * d[0], "L", "R"], [s * d[1], "P", "A"], [d[2], "S", "I"]].map(([c, to, from]) => [Math.abs(c), c > 0 ? to : from]).filter(([c]) => c > 0.38).sort((a, b) => b[0] - a[0]).map(([, letter]) => letter).join("");
}

/** The planes of a volume: {name, right, down, normal (unit vectors), step (mm to the next one)}; `side` mirrors those that
 * show left and right; a clip plane [nx, ny, nz, d] brings an oblique one.
 * @param {any} volume @param {string} side @param {number[]|undefined} plane */
export function planesOf(volume, side, plane) {
  const mirrored = (section) => (side === "neurological" && volume.world !== "unknown" && /[LR]/.test(letterOf(section.right, volume.world)[0]) ? { ...section, right: section.right.map((c) => -c) } : section);
  const whole = (section) => ({ ...section, normal: unit(cross(section.right, section.down)) });
  const sections = volume.sections.map((s) => whole(mirrored({ ...s, step: stepOf(volume, s.axis) })));
  return plane ? [...sections, whole(mirrored(oblique(volume, plane)))] : sections;
}

/** Upright as the others are: right and down as near as the plane allows to those of the section that it is most like. */
function oblique(volume, plane) {
  const normal = unit(plane.slice(0, 3)), like = volume.sections.map((s) => ({ ...s, across: Math.abs(dot(unit(cross(s.right, s.down)), normal)) })).sort((a, b) => b.across - a.across)[0];
  const right = unit(add(like.right, normal, -dot(like.right, normal))), down = cross(normal, right);
  return { name: "oblique", axis: null, right, down: dot(down, like.down) < 0 ? down.map((c) => -c) : down, step: normal.map((c) => c * Math.min(...volume.spacing_mm)) };
}

/** Millimetres a pixel at which all of the volume fits into w × h pixels. */
export function fitOf(volume, section, w, h) {
  const extent = (d) => volume.dimensions.reduce((sum, n, k) => sum + n * Math.abs(dot(stepOf(volume, k), d)), 0);
  return 1.06 * Math.max(extent(section.right) / Math.max(w, 1), extent(section.down) / Math.max(h, 1));
}

/** From pixels of a picture to the world and back: `s` mm a pixel, `middle` in its middle. */
export const pixelToWorld = ({ section, middle, s, w, h }, x, y) => add(add(middle, section.right, (x - w / 2) * s), section.down, (y - h / 2) * s);
export const worldToPixel = ({ section, middle, s, w, h }, p) => {
  const d = add(p, middle, -1);
  return [w / 2 + dot(d, section.right) / s, h / 2 + dot(d, section.down) / s];
};
/** The point moved along the plane's normal into the plane through `at`. */
export const ontoPlane = (point, at, normal) => add(point, normal, dot(add(at, point, -1), normal));
