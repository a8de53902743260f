// Where each setting of the library stands in the page, its label and scale. The key is its flag (or scene key); what
// it means, its range and its default come with the hello. A test walks both.

/** @typedef {{place: string, label?: string, log?: boolean, step?: number, low?: number, high?: number, unit?: string,
 *   only?: string, tips?: boolean, off?: boolean}} Entry */

const elsewhere = (place, flags) => Object.fromEntries(flags.split(" ").map((flag) => [flag, { place }]));

/** @type {Object<string, Entry>} */
export const table = {
  ...elsewhere("file", "raw-size raw-type raw-spacing raw-endian raw-offset series rescale time channels-as volume.dims volume.type volume.spacing labels label-table"),
  ...elsewhere("graph", "transfer window threshold opacity-scale opacity-unit opacity-unit-mm iso"),
  ...elsewhere("bar", "mode"),
  ...elsewhere("save", "size"),
  ...elsewhere("light", "lighting probe hist-effects hist-channel glow"),
  ...elsewhere("cut", "clip-box clip-plane largest"),
  ...elsewhere("picture", "eye target view"),
  ...elsewhere("slices", "layout at centre zoom window sampling colors side outlines labels".replace(/\w+/g, "slices.$&")),
  // Light: first the ones one reaches for.
  "probe-rotation": { place: "light", label: "Turn", low: 0, high: 360, step: 1, unit: "°" },
  "probe-exposure": { place: "light", label: "Exposure", low: -8, high: 8, step: 0.1, unit: "EV" },
  strength: { place: "light", label: "Strength", low: 0, high: 1, step: 0.01 },
  "spao-levels": { place: "light", label: "Reach", low: 1, high: 9, step: 1, unit: "vx" },
  "spao-normal-factor": { place: "light", label: "Facing", low: 0, high: 2, step: 0.05 },
  "hist-radius": { place: "light", label: "Radius", low: 1, high: 32, step: 1, unit: "vx" },
  "hist-anisotropy": { place: "light", label: "Forward", low: -0.95, high: 0.95, step: 0.05 },
  "reference-rays": { place: "light", label: "Rays", low: 1, high: 4096, step: 1, log: true },
  bounces: { place: "light", label: "Bounces" },
  "reference-quantity": { place: "hidden" }, // pictures have one, radiance; the others are fields
  // Accuracy, folded.
  "spao-model": { place: "accuracy", label: "Model" },
  "spao-filter": { place: "accuracy", label: "Filter" },
  "spao-mip-levels": { place: "accuracy", label: "Hybrid levels", low: 0, high: 8, step: 1, only: "hybrid" },
  "sh-bands": { place: "accuracy", label: "Coefficients" },
  "sh-subsample": { place: "accuracy", label: "Grid" },
  "sh-directions": { place: "accuracy", label: "Directions", low: 16, high: 4096, step: 1, log: true },
  "sh-sampling": { place: "accuracy", label: "Sampling" },
  "sh-traversal": { place: "accuracy", label: "Traversal" },
  "sh-model": { place: "accuracy", label: "Model" },
  "sh-window": { place: "accuracy", label: "Windowing" },
  "sh-storage": { place: "accuracy", label: "Storage" },
  "hist-clusters": { place: "accuracy", label: "Clusters", low: 16, high: 4096, step: 1, log: true },
  "hist-packed-bins": { place: "accuracy", label: "Packed bins", low: 2, high: 256, step: 1, log: true },
  "hist-packing": { place: "accuracy", label: "Packing" },
  "hist-metric": { place: "accuracy", label: "Metric" },
  "hist-path": { place: "accuracy", label: "Path" },
  "hist-subsample": { place: "accuracy", label: "Grid" },
  "hist-model": { place: "accuracy", label: "Model" },
  cache: { place: "hidden" }, // a page may name no folder of the computer
  "reference-medium": { place: "accuracy", label: "Medium" },
  "reference-start": { place: "hidden" }, // of fields
  "reference-subsample": { place: "hidden" }, // of fields
  surfaces: { place: "accuracy", label: "Surfaces" },
  "reference-time": { place: "hidden" }, // the page shows each pass and can be stopped
  "reference-error": { place: "hidden" },
  "albedo-max": { place: "accuracy", label: "Albedo limit", low: 0, high: 1, step: 0.01 },
  "transport-grid": { place: "accuracy", label: "Grid", low: 16, high: 256, step: 1, log: true, unit: "" },
  "transport-directions": { place: "accuracy", label: "Directions", low: 6, high: 256, step: 1, log: true },
  "transport-first-directions": { place: "accuracy", label: "First directions", low: 16, high: 4096, step: 1, log: true },
  "transport-error": { place: "hidden" }, // it stops by itself
  seed: { place: "accuracy", label: "Seed", low: 0, high: 100, step: 1 },
  // Surface.
  shading: { place: "surface", label: "Shading" },
  ambient: { place: "surface", label: "Ambient", low: 0, high: 1, step: 0.01 },
  diffuse: { place: "surface", label: "Diffuse", low: 0, high: 1, step: 0.01 },
  specular: { place: "surface", label: "Shine", low: 0, high: 1, step: 0.01 },
  shininess: { place: "surface", label: "Sharpness", low: 1, high: 200, step: 1, log: true },
  light: { place: "surface" },
  // Camera.
  projection: { place: "camera", label: "Projection" },
  fov: { place: "camera", label: "Angle", low: 5, high: 90, step: 1, unit: "°" },
  azimuth: { place: "camera", label: "Azimuth", low: -180, high: 180, step: 1, unit: "°" },
  elevation: { place: "camera", label: "Elevation", low: -90, high: 90, step: 1, unit: "°" },
  roll: { place: "camera", label: "Roll", low: -180, high: 180, step: 1, unit: "°" },
  fit: { place: "camera", label: "Fits" },
  "camera.fit_centre": { place: "hidden" }, // found by the server
  "camera.fit_radius": { place: "hidden" },
  zoom: { place: "camera", label: "Zoom", low: 0.1, high: 20, step: 0.01, log: true, unit: "×" },
  up: { place: "camera", label: "Up" },
  aperture: { place: "camera", label: "Aperture", low: 0, high: 50, step: 0.5, unit: "mm" },
  "camera-matrix": { place: "hidden" }, // another program's camera
  focus: { place: "hidden" }, // the centre, or what a double click chose
  // Picture.
  background: { place: "picture" },
  "probe-background": { place: "picture" },
  exposure: { place: "picture", label: "Exposure", low: -5, high: 5, step: 0.1, unit: "EV" },
  tone: { place: "picture", label: "Tone curve" },
  color: { place: "picture", label: "Colours mixed" },
  step: { place: "picture", label: "Step", low: 0.1, high: 4, step: 0.05, log: true, unit: "vx" },
  "samples-per-pixel": { place: "picture", label: "Samples a pixel", low: 1, high: 64, step: 1, log: true },
  classification: { place: "picture", label: "Classification" },
  compositing: { place: "picture", label: "Compositing" },
  "ray-setup": { place: "picture", label: "Ray set-up" },
  "early-termination": { place: "picture", label: "Ends rays at", low: 0, high: 0.1, step: 0.001 },
  interpolation: { place: "picture", label: "Between voxels" },
  floor: { place: "picture", label: "Floor" },
  "floor-albedo": { place: "picture", label: "Floor's albedo", low: 0, high: 1, step: 0.01 },
  "no-skip-empty": { place: "hidden" }, // a check of the renderer, the same picture
};

/** Entries of a place in the table's order, with the settings' descriptions; of a method only its own. */
export function placed(groups, place, method = "") {
  const settings = new Map(groups.flatMap((group) => group.settings).map((s) => [s.flag ?? s.key, s]));
  return Object.entries(table)
    .filter(([flag, entry]) => entry.place === place && entry.label && settings.has(flag))
    .map(([flag, entry]) => ({ ...settings.get(flag), ...entry, flag }))
    .filter((s) => !s.methods?.length || s.methods.includes(method));
}

/** The key of a setting in the page's state. */
export const keyOf = (setting) => (setting.method ? `${setting.method}:` : "") + setting.key;
