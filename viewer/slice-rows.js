// The panel's section of the slices: layout, place by numbers, window, and how they look.
import { el, short } from "./dom.js";
import { choiceRow, numberField, sliderRow } from "./rows.js";
import { read } from "./scene.js";
import { fold } from "./sections.js";
import { within } from "./slice-geometry.js";
import { labelWords, sliceWords } from "./part-texts.js";
import { words } from "./texts.js";

const w = sliceWords;

export function makeSliceRows(app, slices) {
  const root = el("div", { hidden: true });
  let made = null;
  const choice = (key, label, options, tip) => choiceRow(app, { label, tip: `${tip} slices.${key} of a scene`, options, value: () => slices.get(key), change: (value) => slices.put(label, key, value) });

  /** The crosshair by numbers, in the file's frame. */
  function place() {
    const fields = words.axes.map((axis, k) => numberField(app, { label: `${w.crosshair} ${axis}`, low: -1e9, high: 1e9, step: Math.min(...app.volume.spacing_mm), unit: app.unitOfLength(), now: () => slices.at()[k], text: () => short(slices.at()[k], 5), change: (value) => slices.moveTo(slices.at().map((c, n) => (n === k ? value : c))) }));
    const row = el("div", { role: "group", "aria-label": w.crosshair }, el("div.label", { title: `${w.crosshairTip} slices.at of a scene` }, `${w.crosshair}, ${app.unitOfLength()}`), el("div.three", {}, ...fields.map((f, k) => el("div.field", {}, el("span.unit", {}, words.axes[k]), f.input)), ...fields.map((f) => f.wrong)));
    return Object.assign(row, { show: () => fields.forEach((f) => f.show()) });
  }
  function open() {
    const v = app.volume, [low, high] = v.range, framed = v.world !== "unknown", has = (name) => name !== "oblique" || slices.section(3);
    const names = ["volume", "linked", "axial", "coronal", "sagittal", "oblique"].map((name, k) => [name, k < 2 ? w.layouts[name] : slices.nameOf(k - 2)]);
    const layout = el("div");
    layout.show = () => {
      const options = names.filter(([name]) => has(name));
      if (layout.dataset.n !== String(options.length)) (layout.dataset.n = String(options.length)), layout.replaceChildren(choice("layout", w.layout, options, w.layoutTip));
      layout.firstChild.show();
    };
    const span = high > low ? high - low : 1, whole = v.type !== undefined && !/float/.test(v.type) && span > 20;
    const window_ = sliderRow(app, { label: w.window, tip: `${w.windowTip} slices.window of a scene`, two: true, low, high: low + span, least: low - 10 * span, most: high + 10 * span, step: whole ? 1 : span / 400, show_: (x) => short(x, 4), value: () => slices.window(), change: ([a, b]) => b > a && slices.setWindow(a, b) });
    const rows = [layout, place(), window_,
      choice("colors", w.colours, [["grey", w.grey], ["transfer", w.transfer]], w.coloursTip), choice("sampling", w.sampling, [["linear", w.linear], ["nearest", w.nearest]], w.samplingTip),
      ...(framed ? [choice("side", w.side, Object.entries(w.sides).map(([side, [name, where]]) => [side, `${name}: ${where}`]), w.sideTip)] : []), choice("outlines", w.outlines, [[true, words.choices.on], [false, words.choices.off]], w.outlinesTip)];
    const labels = sliderRow(app, { label: labelWords.overSlices, tip: `${labelWords.overSlicesTip} slices.labels of a scene`, low: 0, high: 1, step: 0.01, value: () => slices.get("labels") ?? 0.4, change: (v) => slices.put(`${labelWords.overSlices}…`, "labels", v) }), show = labels.show;
    labels.show = () => ((labels.hidden = !read(app.store.state, "labels.file")), show());
    rows.push(labels);
    const saves = el("div.buttons", { role: "group", "aria-label": w.save }, el("span.label", {}, w.save), ...[0, 1, 2, 3].map((i) => el("button", { onclick: () => slices.figure(i) }, slices.nameOf(i))));
    saves.show = () => [...saves.querySelectorAll("button")].forEach((button, i) => (button.hidden = !slices.isShown(i)));
    rows.push(saves);
    made = fold(w.title, () => (slices.layout() === "volume" ? "" : w.layouts[slices.layout()] ?? slices.nameOf(["axial", "coronal", "sagittal", "oblique"].indexOf(slices.layout()))), rows, "", "section.section.s-slices");
    root.replaceChildren(made);
  }
  root.show = () => (made ?? (open(), made)).show();
  return { root, show: () => root.show(), open };
}
