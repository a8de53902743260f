// Below the plane of value and gradient: what can be added, and the numbers of what is chosen.
import { el, short } from "./dom.js";
import { bent } from "./gradient-shapes.js";
import { choiceRow, sliderRow } from "./rows.js";
import { gradientWords as w } from "./part-texts.js";

/** @param {any} app @param {any} o list, put, change, remove, addShape, addCurve, chosen, plane, unit, nameOf, stepOf */
export function makeGradientRows(app, o) {
  const adds = Object.entries(w.shapes).map(([shape, name]) => el("button", { title: w.tips[shape], "aria-label": w.add(name), onclick: () => o.addShape(shape) }, `+ ${name}`));
  const curve = el("button", { title: w.tips.curve, "aria-label": w.add(w.curve), onclick: o.addCurve }, `+ ${w.curve}`);
  const hint = el("p.sentence"), numbers = el("div"), root = el("div", {}, el("div.buttons", {}, ...adds, curve), hint, numbers);
  let made = "", rows = [];

  const widget = () => o.list("widgets")[o.chosen.widgets], point = () => o.list("gradient_opacity")[o.chosen.gradient_opacity];
  const change = (more) => o.change(o.chosen.widgets, { ...widget(), ...more }, `${o.stepOf(o.chosen.widgets)}…`);
  function ofShape() {
    const [low, high] = app.volume.range, span = high > low ? high - low : 1, { steepest } = o.plane, rises = (key) => ([a, b]) => b > a && change({ [key]: [a, b] });
    return [
      choiceRow(app, { label: w.shape, tip: Object.values(w.tips).slice(0, 3).join(" "), options: Object.entries(w.shapes), value: () => widget().shape, change: (shape) => change({ shape }) }),
      sliderRow(app, { label: w.value, tip: "value of a widget in a transfer function", two: true, low, high: low + span, least: low - 10 * span, most: high + 10 * span, step: span / 1000, show_: (x) => short(x, 4), value: () => widget().value, change: rises("value") }),
      sliderRow(app, { label: w.gradient, tip: `magnitude of a widget in a transfer function, ${o.unit()}`, two: true, low: 0, high: steepest, least: 0, most: 1e6 * steepest, step: steepest / 1000, show_: (x) => short(x, 4), value: () => widget().magnitude, change: rises("magnitude") }),
      sliderRow(app, { label: w.opacity, tip: "opacity of a widget in a transfer function", low: 0, high: 1, step: 0.01, start: 1, value: () => widget().opacity ?? 1, change: (opacity) => change({ opacity }) }),
      el("div.buttons", {}, el("button", { onclick: () => o.remove("widgets", o.chosen.widgets) }, w.removed(o.nameOf(o.chosen.widgets)))),
    ];
  }
  function ofPoint() {
    const { steepest } = o.plane, put = (magnitude, opacity) => o.put(`${w.curve}…`, "gradient_opacity", bent(o.list("gradient_opacity"), o.chosen.gradient_opacity, magnitude, opacity));
    return [
      sliderRow(app, { label: w.gradient, tip: `magnitude of gradient_opacity in a transfer function, ${o.unit()}`, low: 0, high: steepest, least: 0, most: 1e6 * steepest, step: steepest / 1000, show_: (x) => short(x, 4), value: () => point().magnitude, change: (m) => put(m, point().opacity) }),
      sliderRow(app, { label: w.opacity, tip: "opacity of gradient_opacity in a transfer function", low: 0, high: 1, step: 0.01, value: () => point().opacity, change: (opacity) => put(point().magnitude, opacity) }),
      el("div.buttons", {}, el("button", { onclick: () => o.remove("gradient_opacity", o.chosen.gradient_opacity) }, o.list("gradient_opacity").length > 2 ? `${w.remove}: ${w.point}` : w.removed(w.curve))),
    ];
  }
  return { root, show(seen) {
    const key = JSON.stringify([o.chosen, o.plane.steepest, app.volume.file, widget()?.shape, o.list("gradient_opacity").length]);
    if (key !== made && !app.store.dragging) {
      made = key;
      rows = widget() ? ofShape() : point() ? ofPoint() : [];
      numbers.replaceChildren(...rows);
    }
    if (widget() || point()) rows.forEach((row) => row.show?.());
    curve.hidden = o.list("gradient_opacity").length > 0;
    hint.textContent = !seen ? w.volumeOnly : o.list("widgets").length || o.list("gradient_opacity").length ? "" : w.hint;
  } };
}
