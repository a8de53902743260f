// One slice: its picture from the server, the crosshair, letters, ruler and slider, and what the pointer does there.
import { barOf, frame, write } from "./captions.js";
import { add } from "./camera.js";
import { clamp, download, el, icon, renew, short, svg } from "./dom.js";
import { newestOnly } from "./link.js";
import { read, sceneOf, transferOf } from "./scene.js";
import { letterOf, pixelToWorld, voxelOf, worldToPixel } from "./slice-geometry.js";
import { sliceWords } from "./part-texts.js";

const w = sliceWords;

export function makePane(app, slices, i) {
  const { store } = app, canvas = el("canvas"), lines = svg("svg", { "aria-hidden": "true" });
  const name = el("b"), place = el("span"), grow = el("button.tool", { onclick: () => slices.enlarge(i) }, icon("grow"));
  const letters = ["left", "up", "right", "down"].map((side) => el(`span.letter.${side}`)), side = el("span.side"), said = el("div.read", { hidden: true }), rule = el("div.ruler", {}, el("span"));
  const slider = el("input.slice-slider", { type: "range", oninput: () => slices.scroll(i, Number(slider.value) - position().index) });
  const picture = el("div.slice-picture", {}, canvas, lines, el("div.slice-head", {}, name, place), grow, ...letters, side, rule, said);
  const root = el("section.pane", { tabIndex: 0, hidden: true, role: "group" }, picture, slider);
  const size = () => [picture.clientWidth, picture.clientHeight], view = () => slices.viewOf(i, ...size());
  const local = (event) => [event.clientX - picture.getBoundingClientRect().left, event.clientY - picture.getBoundingClientRect().top];

  /** Which slice of how many; of an oblique one steps from the volume's centre. */
  function position() {
    const now = slices.section(i), v = app.volume;
    if (now.axis !== null) return { index: Math.round(voxelOf(v, now.at)[now.axis]), low: 0, high: v.dimensions[now.axis] - 1 };
    const step = Math.hypot(...now.step), offset = now.at.reduce((sum, c, k) => sum + (c - app.box.centre[k]) * (now.step[k] / step), 0), reach = Math.ceil(app.box.radius / step);
    return { index: Math.round(offset / step), low: -reach, high: reach };
  }

  // The picture: quick while things move, lossless 200 ms after.
  let asked = "", resting = 0, last = 0, drawn = 0;
  const fetch = newestOnly(app.link, async (request) => {
    const order = ++last;
    let frame;
    await app.link.ask("slice", { ...request, pane: i }, (_, data) => data && (frame = data));
    const bitmap = frame && (await createImageBitmap(frame, { colorSpaceConversion: "none" }));
    if (!bitmap || order < drawn) return;
    drawn = order;
    Object.assign(canvas, { width: bitmap.width, height: bitmap.height });
    canvas.getContext("2d", { willReadFrequently: true }).drawImage(bitmap, 0, 0);
    bitmap.close();
    canvas.dataset.drawn = request.lossless ? "final" : "draft";
    canvas.dataset.key = keyOf(request);
  });
  const keyOf = ({ lossless, ...request }) => JSON.stringify(request);
  function request(v, ratio = devicePixelRatio) {
    const size = [v.w, v.h].map((n) => clamp(Math.round(n * ratio), 1, 4096)), [low, high] = slices.window();
    const colours = slices.get("colors") === "transfer" ? { transfer_function: transferOf(store.state.tf), ...(store.state.threshold ? { threshold: store.state.threshold } : {}) } : {};
    const scene = store.state.channels || read(store.state, "labels.file") ? sceneOf(store.state) : {};
    const several = scene.channels ? { channels: scene.channels } : {}, labels = scene.labels?.file ? { labels: scene.labels, label_opacity: slices.get("labels") } : {};
    return { plane: { centre: v.middle, right: v.section.right.map((c) => (c * v.s) / ratio), down: v.section.down.map((c) => (c * v.s) / ratio) }, size, sampling: slices.get("sampling"), window: [(low + high) / 2, high - low], ...colours, ...several, ...labels };
  }

  /** With its picture of so many pixels. */
  function show(pixels) {
    const now = slices.section(i), v = slices.viewOf(i, ...pixels), { index, low, high } = position(), world = app.volume.world, right = letterOf(now.right, world), down = letterOf(now.down, world);
    renew(root, "aria-label", w.slice(slices.nameOf(i)));
    renew(name, "textContent", slices.nameOf(i));
    name.style.color = slices.colourOf(now);
    renew(place, "textContent", now.axis === null ? `${short(index * Math.hypot(...now.step), 3)} mm` : w.of(index + 1, high + 1));
    const enlarged = root.classList.contains("large");
    renew(grow, "title", enlarged ? w.back : w.enlarge);
    renew(grow, "aria-label", `${enlarged ? w.back : w.enlarge}: ${slices.nameOf(i)}`);
    for (const [key, number] of Object.entries({ min: low, max: high, step: 1, value: index })) renew(slider, key, String(number));
    renew(slider, "aria-label", w.slice(slices.nameOf(i)));
    renew(slider, "aria-valuetext", place.textContent);
    const opposite = (d) => letterOf(d.map((c) => -c), world);
    [opposite(now.right), opposite(now.down), right, down].forEach((text, k) => renew(letters[k], "textContent", text));
    renew(side, "textContent", world !== "unknown" && /[LR]/.test(right[0]) ? w.sides[slices.get("side")][0] : "");
    const bar = barOf(app, v.s);
    rule.style.width = `${bar.pixels}px`;
    renew(rule.firstChild, "textContent", bar.text);
    crosshair(v);
    app.marks?.drawPane(i, v, lines);
    const wanted = request(v), key = keyOf(wanted);
    if (key === asked || !app.link.open) return;
    asked = canvas.dataset.asked = key;
    app.frame.postpone();
    fetch({ ...wanted, lossless: false });
    clearTimeout(resting);
    resting = setTimeout(() => fetch({ ...wanted, lossless: true }), 200);
  }
  function crosshair(v) {
    const [x, y] = worldToPixel(v, slices.at()), others = [0, 1, 2].filter((k) => k !== i).map((k) => slices.section(k)), colour = (d) => slices.colourOf(others.map((o) => [Math.abs(o.normal.reduce((s, c, k) => s + c * d[k], 0)), o]).sort((a, b) => b[0] - a[0])[0][1]);
    const line = (d, c) => svg("path", { d, style: `stroke:${c}` }), gap = 10;
    lines.replaceChildren(line(`M${x} 0V${y - gap}M${x} ${y + gap}V${v.h}`, colour(v.section.right)), line(`M0 ${y}H${x - gap}M${x + gap} ${y}H${v.w}`, colour(v.section.down)));
  }

  /** The slice as a figure, twice as fine as it is seen: with its name, letters, side, ruler and what was measured. */
  async function figure() {
    const v = view(), ratio = Math.min(2, 4096 / Math.max(v.w, v.h)), made = new OffscreenCanvas(Math.round(v.w * ratio), Math.round(v.h * ratio)), g = made.getContext("2d");
    let data;
    await app.link.ask("slice", { ...request(v, ratio), lossless: true }, (_, blob) => blob && (data = blob));
    const bitmap = await createImageBitmap(data, { colorSpaceConversion: "none" });
    g.drawImage(bitmap, 0, 0, made.width, made.height);
    bitmap.close();
    const measured = app.marks?.figureOn(v, ratio);
    if (measured) g.translate(measured.x, measured.y), measured.draw(g), g.translate(-measured.x, -measured.y);
    g.scale(ratio, ratio);
    g.font = `600 13px ${getComputedStyle(document.body).fontFamily}`;
    const edge = 12, at = { left: ["left", edge, v.h / 2], right: ["right", v.w - edge, v.h / 2], up: ["center", v.w / 2, edge + 8], down: ["center", v.w / 2, v.h - edge] };
    const say = (text, x, y, align) => text && write(g, text, x, y, align);
    letters.forEach((letter) => { const [align, x, y] = at[letter.classList[1]]; say(letter.textContent, x, y, align); });
    say(`${name.textContent}  ${place.textContent}`, edge, edge + 8, "left");
    say(side.textContent, edge, v.h - edge, "left");
    const bar = barOf(app, v.s);
    frame(g, v.w - edge - bar.pixels, v.h - edge - 2, bar.pixels, 2);
    say(bar.text, v.w - edge, v.h - edge - 8, "right");
    download(await made.convertToBlob({ type: "image/png" }), `${slices.nameOf(i).toLowerCase().replaceAll(" ", "-")}.png`);
  }

  // What is under the pointer: the file's own number, where it is in the world and in voxels.
  const look = newestOnly(app.link, async (point) => {
    const { values } = await app.link.ask("slice", { plane: { centre: point, right: [1, 0, 0], down: [0, 1, 0] }, size: [1, 1], sampling: "nearest", values: true, ...(store.state.channel ? { channel: store.state.channel } : {}) }), label = await app.labels?.at(point);
    if (said.hidden) return;
    const voxel = voxelOf(app.volume, point).map((c) => Math.round(c)), mm = point.map((c) => c.toFixed(1).replace("-", "−")).join(", ");
    said.replaceChildren(el("b", {}, values[0] === null ? w.outside : app.exactly(values[0])), el("span", {}, `${mm} ${app.unitOfLength()}${app.volume.world === "unknown" ? "" : ` ${app.volume.world}`}`), ...(values[0] === null ? [] : [el("span", {}, w.voxel(voxel))]), ...(label ? [el("span", {}, label.name)] : []));
  });
  const tell = (event) => ((said.hidden = false), look(pixelToWorld(view(), ...local(event))));

  const pointers = new Map();
  let act = null;
  /** Two fingers pan and pinch. */
  function pinch() {
    const [a, b] = [...pointers.values()];
    return { gap: Math.max(1, Math.hypot(a[0] - b[0], a[1] - b[1])), middle: [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2] };
  }
  const panBy = (v, dx, dy) => store.set(w.pan, (s) => ({ camera: { ...s.camera, "slices.centre": add(add(v.middle, v.section.right, -dx * v.s), v.section.down, -dy * v.s) } }), "camera");
  picture.addEventListener("pointerdown", (event) => {
    if (event.target.closest("button")) return;
    root.focus({ preventScroll: true });
    picture.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, local(event));
    said.hidden = event.pointerType !== "touch";
    store.cancel();
    const v = view(), [low, high] = slices.window(), [x, y] = local(event);
    if (pointers.size === 2) {
      app.marks?.unpress();
      let last = pinch();
      store.begin(w.pan, "camera");
      act = () => {
        const next = pinch();
        panBy(view(), next.middle[0] - last.middle[0], next.middle[1] - last.middle[1]);
        slices.zoomBy(next.gap / last.gap, pixelToWorld(view(), ...next.middle));
        last = next;
      };
    } else if (event.button === 2) {
      store.begin(w.window);
      act = (e, dx, dy) => {
        const width = (high - low) * Math.max(0.01, dx >= 0 ? 1 + dx / 400 : 1 / (1 - dx / 400)), centre = (low + high) / 2 - (dy / 400) * (high - low);
        slices.setWindow(centre - width / 2, centre + width / 2);
      };
    } else if (event.button === 1 || event.shiftKey) {
      store.begin(w.pan, "camera");
      act = (e, dx, dy) => panBy(v, dx, dy);
    } else if (!(act = app.marks?.pressOn({ view: v, x, y }) ?? null)) {
      store.begin(w.crosshair, "camera");
      act = (e) => (slices.moveTo(pixelToWorld(v, ...local(e))), e.pointerType === "touch" && tell(e));
      act(event);
    }
    const from = local(event), move = act;
    act = (e) => move(e, local(e)[0] - from[0], local(e)[1] - from[1]);
  });
  picture.addEventListener("pointermove", (event) => {
    if (!pointers.has(event.pointerId)) return event.pointerType === "mouse" && (tell(event), app.marks?.hover({ view: view(), x: local(event)[0], y: local(event)[1] }));
    pointers.set(event.pointerId, local(event));
    act?.(event);
  });
  const up = (event) => pointers.delete(event.pointerId) && ((act = null), app.marks?.release(), store.end());
  for (const kind of ["pointerup", "pointercancel"]) picture.addEventListener(kind, up);
  picture.addEventListener("pointerleave", () => pointers.size || (said.hidden = true));
  picture.addEventListener("contextmenu", (event) => event.preventDefault());
  picture.addEventListener("dblclick", (event) => event.target.closest("button") || app.marks?.end() || slices.enlarge(i));
  let turned = 0;
  root.addEventListener("wheel", (event) => {
    event.preventDefault();
    if (event.ctrlKey) return slices.zoomBy(1.0015 ** clamp(-event.deltaY, -300, 300), pixelToWorld(view(), ...local(event)));
    turned += event.deltaMode ? 50 * Math.sign(event.deltaY) : event.deltaY; // a notch of a wheel is 100 or more, a touch pad's many small ones add up
    const steps = Math.trunc(turned / 50);
    if (!steps) return;
    turned = 0;
    slices.scroll(i, Math.sign(steps) * Math.max(1, Math.floor(Math.abs(steps) / 2)));
  }, { passive: false });
  root.addEventListener("keydown", (event) => {
    if (event.target !== root || event.ctrlKey || event.altKey || event.metaKey) return;
    const v = view(), [dx, dy] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key] ?? [0, 0], steps = { PageUp: 1, PageDown: -1 }[event.key];
    const zoom = { "+": 1.1, "=": 1.1, "-": 1 / 1.1 }[event.key], step = Math.min(...app.volume.spacing_mm);
    if (app.marks?.key(event)) return void event.preventDefault();
    if (zoom) slices.zoomBy(zoom, v.middle);
    else if (steps) slices.scroll(i, steps * (event.shiftKey ? 10 : 1));
    else if (event.key === "Home" || event.key === "End") slices.scroll(i, position()[event.key === "Home" ? "low" : "high"] - position().index);
    else if (event.key === "Enter" || (event.key === "Escape" && root.classList.contains("large"))) slices.enlarge(i);
    else if (dx || dy) event.shiftKey ? panBy(v, -20 * dx, -20 * dy) : slices.moveTo(add(add(slices.at(), v.section.right, dx * step), v.section.down, dy * step));
    else return;
    event.preventDefault();
  });
  new ResizeObserver(() => root.hidden || store.redraw()).observe(picture);
  return { root, picture, show, size, view, figure, forget: () => (asked = "") };
}
