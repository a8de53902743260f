// Slices beside the volume: planes through the same voxels, linked by one crosshair. Loaded when first shown.
import { add, project } from "./camera.js";
import { clamp, el, svg } from "./dom.js";
import { frameOf } from "./planes.js";
import { read, write } from "./scene.js";
import { fitOf, middleOf, ontoPlane, planesOf, stepOf, voxelOf, within, worldOf } from "./slice-geometry.js";
import { makePane } from "./slice-pane.js";
import { makeSliceRows } from "./slice-rows.js";
import { styled } from "./styles.js";
import { sliceWords } from "./part-texts.js";
import { words } from "./texts.js";

export const axisColours = ["#f07b6d", "#8dc063", "#7aa7f0", "#F2B84B"];
const large = ["axial", "coronal", "sagittal", "oblique"];

export async function makeSlices(app, area) {
  const { store, stage } = app, get = (key) => read(store.state, `slices.${key}`), w = sliceWords;
  const put = (label, key, value) => store.set(label, (s) => write(s, `slices.${key}`, value), ["at", "centre", "zoom"].includes(key) ? "camera" : "design");
  const plane = () => read(store.state, "clip.planes")?.[0];
  const at = () => get("at") ?? middleOf(app.volume), sections = () => planesOf(app.volume, get("side"), plane());
  /** What a layout names stands for the volume's own axes where it has no frame. */
  const place = (name) => large.indexOf(name);
  const section = (i) => {
    const found = sections()[i];
    return found?.axis === null ? { ...found, at: frameOf(plane(), app.box).at } : found && { ...found, at: at() };
  };
  const layout = () => (get("layout") === "oblique" && !plane() ? "linked" : get("layout"));
  /** [low, high] of the grey levels: the 1st to the 99.9th percentile where nothing else is said. */
  function window_() {
    const own = get("window"), p = app.volume.percentiles;
    if (own) return [own[0] - own[1] / 2, own[0] + own[1] / 2];
    const [low, high] = p["99.9"] > p["1"] ? [p["1"], p["99.9"]] : app.volume.range;
    return high > low ? [low, high] : [low - 0.5, low + 0.5];
  }
  const setWindow = (low, high) => put(`${w.window}…`, "window", [(low + high) / 2, Math.max(high - low, 1e-9 * Math.max(1, Math.abs(low), Math.abs(high)))]);

  const slices = {
    at, section, layout, window: window_, setWindow, get, put,
    moveTo: (point) => put(`${w.crosshair}…`, "at", within(app.volume, point)),
    /** To the slice so many steps on; of an oblique one the clip plane moves. */
    scroll(i, steps) {
      const now = section(i);
      if (now.axis === null) {
        const [x, y, z, d] = plane(), length = Math.hypot(x, y, z) * Math.hypot(...now.step);
        return store.set(`${words.cut}…`, (s) => write(s, "clip.planes", read(s, "clip.planes").map((p, k) => (k ? p : [x, y, z, d + steps * length]))));
      }
      const voxel = voxelOf(app.volume, at());
      voxel[now.axis] = clamp(Math.round(voxel[now.axis]) + steps, 0, app.volume.dimensions[now.axis] - 1);
      put(`${w.crosshair}…`, "at", worldOf(app.volume, voxel));
    },
    zoomBy(factor, fixed) {
      const before = get("zoom"), zoom = clamp(before * factor, 0.01, 1000), centre = get("centre") ?? app.box.centre;
      store.set(`${w.zoom}…`, (s) => ({ camera: { ...s.camera, "slices.zoom": zoom, "slices.centre": add(fixed, add(centre, fixed, -1), before / zoom) } }), "camera");
    },
    /** What a picture of w × h pixels shows. */
    viewOf(i, width, height) {
      const now = section(i), alike = layout() === "linked" ? sections().slice(0, 3) : [now]; // three of one size have one scale
      return { section: now, w: width, h: height, s: Math.max(...alike.map((one) => fitOf(app.volume, one, width, height))) / get("zoom"), middle: ontoPlane(get("centre") ?? app.box.centre, now.at, now.normal) };
    },
    enlarge: (i) => put(w.layout, "layout", layout() === large[i] ? "linked" : large[i]),
    figure: (i) => panes[i].figure().catch(app.fault),
    isShown: (i) => !panes[i].root.hidden,
    nameOf: (i) => (i === 3 ? w.names.oblique : app.volume.world === "unknown" ? w.across(words.axes[2 - i]) : w.names[large[i]]),
    colourOf: (now) => axisColours[now.axis ?? 3],
  };

  await styled("slices.css");
  const panes = large.map((_, i) => makePane(app, slices, i));
  const rows = makeSliceRows(app, slices);
  const lines = svg("svg"), layer = el("div.planes.slice-lines", { hidden: true, "aria-hidden": "true" }, lines);
  area.append(...panes.map((pane) => pane.root));
  stage.append(layer);

  /** Where the slices lie in the volume: the four corners of each, and the crosshair. */
  function outlines() {
    layer.hidden = layout() === "volume" || get("outlines") === false || Boolean(app.compare.on);
    if (layer.hidden) return;
    const v = app.volume, on = (p) => project(app.view(), p, stage.clientWidth, stage.clientHeight).map((c) => c.toFixed(1)).join(" "), voxel = voxelOf(v, at());
    const made = [0, 1, 2].map((axis) => {
      const [a, b] = [0, 1, 2].filter((k) => k !== axis), corner = (s, t) => {
        const p = [...voxel];
        (p[a] = s ? v.dimensions[a] - 0.5 : -0.5), (p[b] = t ? v.dimensions[b] - 0.5 : -0.5);
        return on(worldOf(v, p));
      };
      return svg("path", { d: `M${corner(0, 0)}L${corner(1, 0)}L${corner(1, 1)}L${corner(0, 1)}Z`, style: `stroke:${axisColours[axis]};stroke-dasharray:none;stroke-width:1.25` });
    });
    const marks = [0, 1, 2].map((axis) => svg("path", { d: `M${on(add(at(), stepOf(v, axis), -0.02 * v.dimensions[axis]))}L${on(add(at(), stepOf(v, axis), 0.02 * v.dimensions[axis]))}`, style: `stroke:${axisColours[axis]};stroke-dasharray:none` }));
    lines.replaceChildren(...made, ...marks);
  }

  store.watch(() => {
    if (!app.volume?.sections) return;
    const now = layout();
    panes.forEach((pane, i) => {
      pane.root.hidden = now === "volume" || (i === 3 && (!plane() || now !== "oblique"));
      pane.root.classList.toggle("large", large[i] === now);
      pane.root.style.order = String(large[i] === now ? -2 : 2 * i);
    });
    const shown = panes.filter((pane) => !pane.root.hidden), sizes = shown.map((pane) => pane.size());  // laid out once
    shown.forEach((pane, i) => pane.show(sizes[i]));
    rows.root.hidden = now === "volume";
    if (!rows.root.hidden) rows.show();
    outlines();
  });
  return { ...slices, rows: rows.root, panes, open: rows.open, place };
}
