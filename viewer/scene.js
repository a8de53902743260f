// Between the state of the page and the scene file: opacity and colour have points of their own here, and each lighting
// method keeps its settings.
import { clamp } from "./dom.js";

const near = 1e-6;

/** Keys that scenes write and that the state keeps as `values`. Settings of a lighting method are kept as "method:key". */
let described = new Map();

/** Takes the hello's descriptions. @param {any[]} groups */
export function describe(groups) {
  described = new Map();
  for (const group of groups)
    for (const setting of group.settings) described.set((setting.method ? setting.method + ":" : "") + setting.key, setting);
  return described;
}

export const setting = (key) => described.get(key);
/** Where one looks from, in the volume and in its slices: kept beside the design, with undo steps of its own. */
const placeOf = (key) => (/^(camera\.|slices\.(at|centre|zoom)$)/.test(key) ? "camera" : "values");
export const read = (state, key) => {
  const values = state[placeOf(key)];
  return key in values ? values[key] : (described.get(key)?.default ?? null);
};

/** The part of a change that gives `key` the value. */
export function write(state, key, value) {
  const place = placeOf(key);
  const next = { ...state[place] };
  if (value === null || value === undefined) delete next[key];
  else next[key] = value;
  return { [place]: next };
}

export const method = (state) => state.values["lighting.method"] ?? described.get("lighting.method")?.default ?? "none";

const between = (a, b, value) => (b.value > a.value ? clamp((value - a.value) / (b.value - a.value), 0, 1) : 1);
const mix = (a, b, t) => a + t * (b - a);

/** The field at a value: linear between the list's points, constant outside; of two points of one value the right one.
 * @param {any[]} list @param {number} value @param {"opacity"|"rgb"} field */
export function at(list, value, field) {
  let right = list.findIndex((point) => point.value > value);
  if (right < 0) right = list.length;
  if (right === 0) return list[0][field];
  if (right === list.length) return list[right - 1][field];
  const [a, b] = [list[right - 1], list[right]], t = between(a, b, value);
  return field === "rgb" ? a.rgb.map((c, i) => mix(c, b.rgb[i], t)) : mix(a.opacity, b.opacity, t);
}

/** Leaves out what lies on its neighbours' line within 1e-6. The ends stay. */
function thinned(points, fields) {
  const kept = [points[0]];
  for (let i = 1; i + 1 < points.length; ++i) {
    const a = kept.at(-1), p = points[i], b = points[i + 1];
    const step = p.value === a.value || p.value === b.value;
    const t = between(a, b, p.value);
    if (step || p.name || fields(p).some((x, k) => Math.abs(x - mix(fields(a)[k], fields(b)[k], t)) > near)) kept.push(p);
  }
  if (points.length > 1) kept.push(points.at(-1));
  return kept;
}

/** A file's points as opacity points and colour stops. */
export function split(transfer) {
  const { points, opacity_scale = 1, opacity_unit_distance, opacity_unit_mm, ...rest } = transfer;
  const unit = opacity_unit_mm !== undefined && opacity_unit_mm !== null
    ? { key: "opacity_unit_mm", value: opacity_unit_mm } : { key: "opacity_unit_distance", value: opacity_unit_distance ?? 1 };
  return {
    points: thinned(points, (p) => [p.opacity]).map(({ rgb, ...point }) => point),
    stops: thinned(points.map(({ value, rgb }) => ({ value, rgb })), (p) => p.rgb),
    scale: opacity_scale, unit, rest,
  };
}

/** The union of both lists, each point with opacity and colour: exact, since both are linear between their points. */
export function joined(tf) {
  const places = [...tf.points, ...tf.stops].map((p) => p.value);
  const values = [...new Set(places)].sort((a, b) => a - b);
  const all = [];
  for (const value of values) {
    const points = tf.points.filter((p) => p.value === value), stops = tf.stops.filter((p) => p.value === value);
    const count = Math.max(points.length, stops.length);
    for (let i = 0; i < count; ++i) {
      const point = points[Math.min(i, points.length - 1)], stop = stops[Math.min(i, stops.length - 1)];
      all.push({ value, rgb: stop?.rgb ?? at(tf.stops, value, "rgb"), opacity: point?.opacity ?? at(tf.points, value, "opacity"), ...(point?.name && i < points.length ? { name: point.name } : {}) });
    }
  }
  return all;
}

/** The channels of a volume of several values, each with its function; the one that is edited has the state's. */
export const channelsOf = ({ channels, channel, tf }) => channels?.map((own, i) => (i === channel ? { ...own, tf } : own));

export const transferOf = (tf) => ({ ...tf.rest, [tf.unit.key]: tf.unit.value, ...(tf.scale !== 1 ? { opacity_scale: tf.scale } : {}), points: joined(tf) });

const nested = (scene, key, value) => {
  const parts = key.split(".");
  let place = scene;
  for (const part of parts.slice(0, -1)) place = place[part] ??= {};
  place[parts.at(-1)] = value;
};

/** The scene of a state, complete for the server and for a file. */
export function sceneOf(state, toCamera = (camera) => camera) {
  const channels = channelsOf(state), first = channels ? { ...channels[0].tf, scale: state.tf.scale } : state.tf; // one density for all
  const scene = { chiaro: 1, ...structuredClone(state.rest), transfer_function: transferOf(first) };
  if (channels) scene.channels = channels.map(({ tf, ...own }) => ({ ...own, transfer_function: transferOf({ ...tf, scale: 1 }) }));
  const now = method(state);
  scene.lighting = { method: now };
  for (const [key, value] of Object.entries({ ...state.values, ...toCamera(state.camera) })) {
    const of = key.includes(":") ? key.split(":") : ["", key];
    if (!of[0] || of[0] === now) nested(scene, of[1], value);
  }
  if (state.threshold) scene.threshold = state.threshold;
  if (state.iso.length) scene.iso = state.iso;
  if (state.marks?.length) scene.marks = state.marks;
  return scene;
}

/** The state of a scene; `old` gives what other methods were set to. */
export function stateOf(scene, old, fromCamera = (camera) => camera) {
  const { chiaro, transfer_function, threshold, iso, marks, channels, camera = {}, ...others } = structuredClone(scene);
  const now = others.lighting?.method ?? "none";
  const values = {}, rest = {};
  for (const [key, value] of Object.entries(old?.values ?? {})) if (key.includes(":") && !key.startsWith(now + ":")) values[key] = value;
  const take = (key, value) => {
    const own = `${now}:${key}`;
    if (described.has(own)) values[own] = value;
    else if (described.has(key) || /^(probe|lighting)\./.test(key)) values[key] = value;
    else return false;
    return true;
  };
  for (const [group, value] of Object.entries(others)) {
    if (["volume", "image", "bench", "conventions", "note"].includes(group)) rest[group] = value;
    else if (value && typeof value === "object" && !Array.isArray(value)) {
      for (const [key, inner] of Object.entries(value)) if (inner !== null && !take(`${group}.${key}`, inner)) (rest[group] ??= {})[key] = inner;
    } else if (value !== null && !take(group, value)) rest[group] = value;
  }
  values["lighting.method"] = now;
  const looked = Object.fromEntries(Object.entries(values).filter(([key]) => placeOf(key) === "camera"));
  for (const key in looked) delete values[key];
  const placed = Object.fromEntries(Object.entries(camera).filter(([, v]) => v !== null).map(([key, value]) => [`camera.${key}`, value]));
  const of = channels?.length > 1 && channels.every((own) => own.transfer_function?.points) ? { channel: 0, channels: channels.map(({ transfer_function: own, ...more }) => ({ ...more, tf: split(own) })) } : { channel: 0, channels: old?.channels };
  return { values, ...of, camera: { ...fromCamera(placed), ...looked }, tf: split(transfer_function), threshold: threshold ?? null, iso: iso ?? [], marks: marks ?? [], rest };
}

const others = (values) => JSON.stringify(Object.entries(values).filter(([key]) => !key.startsWith("slices.")).sort());
/** Whether two states make the same picture of the volume: slices and marks are not part of it. */
export const samePicture = (a, b) => ["tf", "channels", "threshold", "iso", "rest"].every((key) => a[key] === b[key]) && others(a.values) === others(b.values) && others(a.camera) === others(b.camera);
