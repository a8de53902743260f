// The camera as the page turns it: an orbit about a target. A panned camera is written as eye and target.
const radians = (degrees) => (degrees * Math.PI) / 180;
const degrees = (angle) => (angle * 180) / Math.PI;
export const add = (a, b, t = 1) => a.map((x, i) => x + t * b[i]);
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const unit = (a) => a.map((x) => x / Math.hypot(...a));

/** Box of the volume in the world: centre, radius, corners' axes (mm). @param {any} volume */
export function boxOf(volume) {
  const d = volume.direction, s = volume.spacing_mm, n = volume.dimensions;
  const axes = [0, 1, 2].map((k) => [0, 1, 2].map((row) => d[row][k] * s[k] * (n[k] - 1)));
  const diagonal = add(add(axes[0], axes[1]), axes[2]);
  const centre = add(volume.origin_mm, diagonal, 0.5);
  return { origin: volume.origin_mm, axes, centre, radius: Math.max(Math.hypot(...diagonal) / 2, 1e-30), edge: Math.min(...s) };
}

const axisNames = { x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] };
export function upOf(camera) {
  const up = camera["camera.up"] ?? "+z";
  return Array.isArray(up) ? unit(up) : axisNames[up.at(-1)].map((x) => (up[0] === "-" ? -x : x));
}

/** The axes that azimuth turns between, as docs/scene.md says. */
function level(up) {
  const e = Math.abs(up[2]) === 1 ? [1, 0, 0] : Math.abs(up[0]) === 1 ? [0, 1, 0] : Math.abs(up[1]) === 1 ? [0, 0, 1] : Math.abs(up[0]) > 0.9 ? [0, 1, 0] : [1, 0, 0];
  const flat = unit(add(e, up, -dot(e, up)));
  return [flat, cross(up, flat)];
}

export function direction(azimuth, elevation, up) {
  const [e, f] = level(up), az = radians(azimuth), el = radians(elevation);
  return add(add(e.map((x) => x * Math.cos(el) * Math.cos(az)), f, Math.cos(el) * Math.sin(az)), up, Math.sin(el));
}

/** Azimuth and elevation in degrees of a direction. */
export function anglesOf(towards, up) {
  const [e, f] = level(up), d = unit(towards);
  return [degrees(Math.atan2(dot(d, f), dot(d, e))), degrees(Math.asin(Math.max(-1, Math.min(1, dot(d, up)))))];
}

const value = (camera, key, otherwise) => camera[`camera.${key}`] ?? otherwise;

/** What the camera fits: the ball that was found around what is visible, or the volume's. */
const ballOf = (camera, box) => (value(camera, "fit", "visible") === "visible" && camera["camera.fit_centre"] ? { centre: camera["camera.fit_centre"], radius: camera["camera.fit_radius"] } : box);

/** Everything that projecting takes: eye, target, axes, half height (tangent, or mm). */
export function viewOf(camera, box) {
  const up = upOf(camera), fov = value(camera, "view_angle_deg", 30), fit = value(camera, "fit_scale", 1);
  const perspective = value(camera, "projection", "perspective") === "perspective";
  const elevation = value(camera, "elevation_deg", 25), azimuth = value(camera, "azimuth_deg", 35);
  const towards = direction(azimuth, elevation, up);
  const ball = ballOf(camera, box), target = camera["camera.target"] ?? ball.centre;
  const distance = (fit * ball.radius) / Math.sin(radians(fov) / 2);
  const forward = towards.map((x) => -x);
  const steep = Math.abs(elevation) > 89.9999;
  const upright = steep ? direction(azimuth, 0, up).map((x) => x * -Math.sign(elevation)) : up;
  const flat = unit(cross(forward, upright)), high = cross(flat, forward), roll = radians(value(camera, "roll", 0));
  const right = add(flat.map((x) => x * Math.cos(roll)), high, Math.sin(roll));
  return { eye: add(target, towards, distance), target, forward, right, up: cross(right, forward), distance, perspective,
    half: perspective ? Math.tan(radians(fov) / 2) : ball.radius * fit };
}

/** Millimetres of the world a pixel at the target's depth. */
export const scaleOf = (view, height) => (2 * view.half * (view.perspective ? view.distance : 1)) / height;

/** A point of the world in pixels of a picture. */
export function project(view, point, width, height) {
  const d = add(point, view.eye, -1), depth = view.perspective ? Math.max(dot(d, view.forward), 1e-9) : 1;
  const k = height / 2 / (view.half * depth);
  return [width / 2 + k * dot(d, view.right), height / 2 - k * dot(d, view.up)];
}

/** The ray through a pixel. */
export function ray(view, x, y, width, height) {
  const u = ((2 * x - width) / height) * view.half, v = ((height - 2 * y) / height) * view.half;
  const aside = add(view.right.map((c) => c * u), view.up, v);
  return view.perspective ? { from: view.eye, along: add(view.forward, aside) } : { from: add(view.eye, aside), along: view.forward };
}

/** Keys of a scene's camera: the orbit, or eye and target where it was panned. */
export function toScene(camera, box) {
  const { "camera.target": target, ...orbit } = camera;
  if (!target) return orbit;
  // Straight down, up must not lie along the view: a hair less is the same picture.
  const el = value(camera, "elevation_deg", 25), bent = { ...camera, "camera.elevation_deg": Math.max(-89.99, Math.min(89.99, el)) };
  const { "camera.azimuth_deg": _, "camera.elevation_deg": __, ...rest } = orbit;
  return { ...rest, "camera.eye": viewOf(bent, box).eye, "camera.target": target };
}

/** The page's camera of a scene's: named views and eyes become an orbit; of another program's matrix there is none. */
export function fromScene(camera, box, world) {
  const { "camera.eye": eye, "camera.target": target, "camera.view": named, "camera.model": _, "camera.matrix": _matrix, ...rest } = camera;
  if (named) return { ...rest, ...namedView(named, world, upOf(rest)) };
  if (!eye || !target) return rest;
  const [azimuth, elevation] = anglesOf(add(eye, target, -1), upOf(rest));
  const fov = radians(value(rest, "view_angle_deg", 30));
  const perspective = value(rest, "projection", "perspective") === "perspective";
  const fit = perspective ? (Math.hypot(...add(eye, target, -1)) * Math.sin(fov / 2)) / ballOf(rest, box).radius : value(rest, "fit_scale", 1);
  return { ...rest, "camera.azimuth_deg": azimuth, "camera.elevation_deg": elevation, "camera.target": target, "camera.fit_scale": fit };
}

/** Azimuth and elevation of an anatomical view, or of an axis such as "+x". */
export function namedView(name, world, up = [0, 0, 1]) {
  const sign = world === "RAS" ? -1 : 1;
  const towards = { anterior: [0, -sign, 0], posterior: [0, sign, 0], left: [sign, 0, 0], right: [-sign, 0, 0], superior: [0, 0, 1], inferior: [0, 0, -1] }[name]
    ?? axisNames[name.at(-1)].map((x) => (name[0] === "-" ? -x : x));
  let [azimuth, elevation] = anglesOf(towards, up);
  // Looking along up, the picture's top is where the orbit's own limit puts it: anterior is up from above and below.
  if (Math.abs(elevation) > 89.9) azimuth = anglesOf([0, Math.sign(elevation) * sign, 0], up)[0];
  return { "camera.azimuth_deg": azimuth, "camera.elevation_deg": elevation };
}
