// Colour and opacity: graph, chips of the peaks, the chosen point's numbers, density, window, and the section's menu.
import { chooseFile, clamp, download, el, fromHex, hex, icon, short } from "./dom.js";
import { histogramOf } from "./graph.js";
import { makeGraph } from "./graph-input.js";
import { highlighted, moved, restBy, spanOf, stretched, withShape } from "./peaks.js";
import { colourRow, numberField, sliderRow } from "./rows.js";
import { at, read, split, transferOf } from "./scene.js";
import { words } from "./texts.js";

export function makeColour(app) {
  const { store, ui } = app, graph = (app.graph = makeGraph(app)), { axis } = graph;
  const tf = () => store.state.tf;
  const set = (label, change) => store.set(label, (s) => ({ tf: { ...s.tf, ...change(s.tf) } }));
  const button = (name, tip, act) => el("button.tool", { title: tip, "aria-label": tip, onclick: act }, typeof name === "string" && name in words.iconNames ? icon(name) : name);
  const log = el("button.tool.log", { title: words.logTip, onclick: () => ((axis.log = !axis.log), store.redraw()) }, words.log);
  const shape = button("shape", words.shape, () => app.menu(shape, Object.entries(words.shapes).map(([kind, name]) => [name, () => addShape(kind)])));
  /** Functions of value and gradient come when they are first used. */
  let asked = null;
  const gradients = () => (asked ??= import("./gradients.js").then(({ makeGradients }) => makeGradients(app, section)));
  const more = button("more", words.graphMenu, () => app.menu(more, [
    [words.gradients, () => gradients().then((part) => part.toggle())],
    [words.reverse, () => reverse()], [words.linearAxis, () => ((axis.linear = !axis.linear), store.redraw())],
    tf().unit.key === "opacity_unit_mm" ? [words.unitVoxels, () => set(words.unitVoxels, () => ({ unit: { key: "opacity_unit_distance", value: 1 } }))] : [words.unitMm, () => set(words.unitMm, () => ({ unit: { key: "opacity_unit_mm", value: 1 } }))],
    tf().rest.rgb_space === "linear" ? [words.asPicked, () => set(words.asPicked, ({ rest: { rgb_space, ...rest } }) => ({ rest }))] : [words.asLight, () => set(words.asLight, ({ rest }) => ({ rest: { ...rest, rgb_space: "linear" } }))],
    [words.importTf, () => chooseFile("", app.take)], [words.exportTf, () => download(new Blob([text()], { type: "application/json" }), "transfer-function.json")], [words.copyTf, () => app.copy(text())],
  ]));
  const text = () => JSON.stringify(transferOf(tf()), null, 1);
  const larger = button("grow", `${words.editor} (E)`, () => app.dock());

  const place = () => (ui.points.length ? tf().points[ui.points[0]].value : spanOf(tf()).reduce((a, b) => a + b) / 2);
  function addShape(kind) {
    const [lo, hi] = spanOf(tf());
    graph.setPoints(words.shapes[kind], withShape(tf().points, kind, place(), (hi - lo) / 10));
  }
  const reverse = () => set(words.reverse, ({ points, stops, rest }) => {
    const [lo, hi] = spanOf(tf()), turn = (list) => list.map((p) => ({ ...p, value: lo + hi - p.value })).reverse();
    return { points: turn(points), stops: turn(stops), rest: restBy(rest, (v) => lo + hi - v) };
  });

  // Chips: what people call a material.
  const chips = el("div.chips", { role: "group", "aria-label": words.peak });
  function chip(peak) {
    let hold = 0, resting = 0, held = false;
    const release = () => (clearTimeout(hold), clearTimeout(resting), app.highlight(null));
    const made = el("button.chip", { title: words.peakTip, onpointerenter: (e) => e.pointerType === "mouse" && (resting = setTimeout(() => app.highlight(peak.lo, peak.hi, 0.25), 300)), onpointerleave: release,
      onpointerdown: () => ((held = false), (hold = setTimeout(() => ((held = true), app.highlight(peak.lo, peak.hi, 0)), 300))), onpointerup: release,
      onclick: () => !held && graph.choose(tf().points.map((_, i) => i).slice(peak.first, peak.last + 1)),
      ondblclick: () => (release(), rename(peak, made)), onkeydown: (e) => e.key === "F2" && rename(peak, made) },
      el("i.blob", { style: `--own:${hex(peak.rgb)}`, onclick: (e) => (e.stopPropagation(), paint(peak)) }), peak.name ? el("b", {}, peak.name) : "", words.range(peak.lo, peak.hi));
    return made;
  }
  /** The name is kept by the peak's first point, so that it is saved with the function. */
  function rename(peak, made) {
    const done = () => {
      const name = input.value.trim() || undefined;
      chips.dataset.key = "";
      if (input.isConnected && name !== peak.name) graph.setPoints(words.peakName, tf().points.map((p, i) => (i === peak.first ? { ...p, name } : p)));
      store.redraw();
    };
    const input = el("input.chip", { value: peak.name ?? "", maxLength: 40, "aria-label": words.peakName, onblur: done, onkeydown: (e) => {
      if (e.key === "Escape") input.value = peak.name ?? "";
      if (e.key === "Escape" || e.key === "Enter") input.blur();
    } });
    made.replaceWith(input);
    input.select();
  }
  function paint(peak) {
    const input = el("input", { type: "color", value: hex(peak.rgb), oninput: () => graph.setStops("Colour…", [...tf().stops.filter((s) => s.value < peak.lo), ...[peak.lo, peak.hi].map((value) => ({ value, rgb: fromHex(input.value) })), ...tf().stops.filter((s) => s.value > peak.hi)]) });
    input.click();
  }

  // The chosen point, or colour stop.
  const point = () => (ui.stop >= 0 ? tf().stops[ui.stop] : ui.points.length === 1 ? tf().points[ui.points[0]] : null);
  const mixed = () => (ui.points.length > 1 ? words.mixed : "");
  const value = numberField(app, { label: words.value, low: -Infinity, high: Infinity, now: () => point()?.value ?? 0, text: () => (point() ? short(point().value) : mixed()), change: (v) => {
    if (ui.stop >= 0) return graph.setStops("Colour stop", tf().stops.map((s, i) => (i === ui.stop ? { ...s, value: clamp(v, tf().stops[i - 1]?.value ?? -Infinity, tf().stops[i + 1]?.value ?? Infinity) } : s)));
    if (ui.points.length === 1) graph.setPoints(words.value, moved(tf().points, ui.points, v - point().value, (o) => o));
  } });
  const opacity = numberField(app, { label: words.opacity, low: 0, high: 1, step: 0.01, now: () => point()?.opacity ?? 0, text: () => (point() && ui.stop < 0 ? short(point().opacity, 3) : mixed()),
    change: (o) => ui.points.length && graph.setPoints(words.opacity, tf().points.map((p, i) => (ui.points.includes(i) ? { ...p, opacity: o } : p))) });
  const swatch = el("input.swatch", { type: "color", "aria-label": words.colourField, oninput: () => {
    const rgb = fromHex(swatch.value);
    if (ui.stop >= 0) return graph.setStops("Colour…", tf().stops.map((s, i) => (i === ui.stop ? { ...s, rgb } : s)));
    const v = place(), index = tf().stops.findIndex((s) => s.value === v);
    graph.setStops("Colour…", index >= 0 ? tf().stops.map((s, i) => (i === index ? { ...s, rgb } : s)) : [...tf().stops, { value: v, rgb }].sort((a, b) => a.value - b.value));
  } });
  const cell = (label, ...what) => el("div.field", {}, el("span.unit", {}, label), ...what);
  const three = el("div.three", {}, cell(words.value, value.input), cell(words.opacity, opacity.input), cell(words.colourField, swatch), value.wrong, opacity.wrong);
  app.typeValue = () => (value.input.focus(), value.input.select());

  const density = sliderRow(app, { label: words.density, tip: "Multiplies the extinction. --opacity-scale", low: 0.1, high: 10, step: 0.01, log: true, least: 0, most: 1e6, start: 1, origin: 1, unit: "×", value: () => tf().scale, change: (scale) => set(`${words.density}…`, () => ({ scale })) });
  density.querySelector("input").dataset.at = "density";
  // The slider spans the file's range; the window itself may reach past it.
  const window_ = el("div.own-window");
  const surface = el("div");
  const section = el("section.section.open.s-colour", {}, el("div.head", {}, el("h2", {}, words.colour), el("div.tools-right", {}, log, shape, larger, more)), graph.root, chips, three, density, window_, surface);
  let windowRow = null, surfaceRows = [];

  function open() {
    const [least, most] = app.volume.range;
    app.histogram = histogramOf(app.volume);
    axis.range = most > least ? [least, most] : [least, least + 1];
    axis.view = [...axis.range];
    Object.assign(ui, { points: [], stop: -1 });
    const [low, high] = axis.range;
    windowRow = sliderRow(app, { label: words.window, tip: "Moves and stretches all points. W: 1st to 99.9th percentile. --window", two: true, low, high, least: -1e30, most: 1e30, step: (high - low) / 255 >= 1 ? 1 : (high - low) / 1000, value: () => spanOf(tf()), change: (w) => w[1] > w[0] && store.set(`${words.window}…`, (s) => ({ tf: stretched(s.tf, w) })) });
    window_.replaceChildren(windowRow);
    const first = () => store.state.iso[0] ?? { value: place() };
    const change = (more) => store.set(`${words.surface}…`, (s) => ({ iso: [{ ...first(), ...more }, ...s.iso.slice(1)] }));
    surfaceRows = [sliderRow(app, { label: words.surfaceValue, tip: "Value of the surface. --iso", low, high, step: (high - low) / 255 >= 1 ? 1 : (high - low) / 1000, value: () => first().value, change: (v) => change({ value: v }) }),
      colourRow(app, { label: words.colourField, value: () => first().color ?? at(tf().stops, first().value, "rgb"), change: (color) => change({ color }) })];
    surface.replaceChildren(...surfaceRows);
  }
  store.watch((state) => {
    if (!app.volume) return;
    if (tf().rest.widgets || tf().rest.gradient_opacity) gradients();
    log.style.color = axis.log ? "var(--accent)" : "";
    log.setAttribute("aria-pressed", String(axis.log));
    const peaks = graph.peaks(), key = JSON.stringify(peaks);
    if (chips.dataset.key !== key && !chips.matches(":active")) (chips.dataset.key = key), chips.replaceChildren(...peaks.map(chip));
    peaks.forEach((peak, i) => chips.children[i]?.setAttribute("aria-pressed", String(ui.points.length > 0 && ui.points.every((k) => k >= peak.first && k <= peak.last))));
    for (const field of [value, opacity]) field.show();
    swatch.value = hex(ui.stop >= 0 ? tf().stops[ui.stop]?.rgb ?? [0, 0, 0] : at(tf().stops, place(), "rgb"));
    opacity.input.disabled = !ui.points.length;
    const { unit, scale } = tf(), length = unit.key === "opacity_unit_mm" ? unit.value : unit.value * app.box.edge;
    opacity.input.title = point() && ui.stop < 0 && app.volume.spacing_stated !== false ? words.overMm(short(1 - (1 - point().opacity) ** (scale / length), 3)) : "";
    value.input.disabled = !point();
    for (const row of [density, windowRow]) row.show();
    surface.hidden = read(state, "mode") !== "iso";
    if (!surface.hidden) surfaceRows.forEach((row) => row.show());
  }, { camera: false });
  app.highlight = (lo, hi, rest) => store.show(lo === null ? null : { tf: highlighted(tf(), lo, hi, rest) });
  app.windowNow = () => spanOf(tf());
  app.fitWindow = () => store.set(words.window, (s) => ({ tf: stretched(s.tf, [app.volume.percentiles["1"], app.volume.percentiles["99.9"]]) }));
  app.setTransfer = (transfer, label) => store.set(label, () => ({ tf: split(transfer), look: undefined }));
  return { section, open, density: (factor) => set(`${words.density}…`, ({ scale }) => ({ scale: clamp(scale * factor, 0.01, 100) })) };
}
