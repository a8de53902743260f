// The panel's section of measurements: what to place, the table, and the numbers of the chosen one.
import { download, el, icon, short, svg } from "./dom.js";
import { isRegion, lengthOf } from "./mark-shapes.js";
import { numberField } from "./rows.js";
import { fold } from "./sections.js";
import { markWords } from "./part-texts.js";
import { words } from "./texts.js";

const w = markWords;

export function makeMarkRows(app, marks) {
  const root = el("div", { hidden: true }), list = el("div.mark-list", { role: "list" }), details = el("div.mark-details");
  let section = null, detailsOf = "";

  const kinds = el("div.mark-kinds", { role: "radiogroup", "aria-label": w.title }, ...marks.kinds.map((kind) => el("button", { role: "radio", title: w.hints[kind], "data-kind": kind, onclick: () => ((marks.kind = kind), app.gestures.choose("measure")) }, w.kinds[kind])));
  const hint = el("p.sentence"), bySlices = el("button", { title: w.atCrosshairTip, onclick: () => (app.gestures.choose("measure"), marks.atCrosshair()) }, w.atCrosshair), done = el("button", { onclick: () => marks.end() }, w.done);
  const table = el("div.buttons", {}, el("button", { onclick: () => marks.csv() }, w.csv), el("button", { onclick: () => marks.clear() }, w.clear));

  function row(i) {
    const name = el("input", { type: "text", maxLength: 200, onchange: () => marks.change(i, { text: name.value.trim() || undefined }, w.named), onkeydown: (e) => e.key === "Enter" && name.blur() });
    const value = el("button.mark-value", { onclick: () => marks.select(i) }), gone = el("button", { onclick: () => marks.remove(i) }, icon("close"));
    return Object.assign(el("div.mark-row", { role: "listitem" }, name, value, gone), { show() {
      const mark = marks.list()[i], called = marks.nameOf({ ...mark, text: "" }, i), says = marks.says(mark);
      if (document.activeElement !== name) name.value = mark.text ?? "";
      name.placeholder = called;
      name.setAttribute("aria-label", w.nameOf(called));
      value.replaceChildren(says || w.show);
      value.setAttribute("aria-label", `${marks.nameOf(mark, i)}${says ? `: ${says}` : ""}`);
      value.setAttribute("aria-pressed", String(marks.selected === i));
      gone.setAttribute("aria-label", `${words.remove}: ${marks.nameOf(mark, i)}`);
    } });
  }

  /** A curve or bars in a small picture: values over [from, to]. */
  function plot(values, from, to, unit, bars) {
    const known = values.filter((v) => v !== null), low = bars ? 0 : Math.min(...known), high = Math.max(...known), x = (i) => (300 * (i + (bars ? 0.5 : 0))) / Math.max(1, values.length - (bars ? 0 : 1)), y = (v) => 78 - (70 * (v - low)) / (high - low || 1);
    const d = bars ? values.map((v, i) => `M${x(i).toFixed(1)} 78V${y(v).toFixed(1)}`).join("") : values.map((v, i) => (v === null ? "" : `${i && values[i - 1] !== null ? "L" : "M"}${x(i).toFixed(1)} ${y(v).toFixed(1)}`)).join("");
    return el("div.mark-plot", {}, svg("svg", { viewBox: "0 0 300 82", role: "img", "aria-label": bars ? w.histogram : w.profileOf(short(low), short(high)) }, svg("path", { d, class: bars ? "bars" : "" })), el("div", {}, el("span", {}, short(from)), el("span", {}, bars ? "" : `${short(low)} ${words.to} ${short(high)}`), el("span", {}, `${short(to)} ${unit}`.trim())));
  }
  const facts = (pairs) => el("dl", {}, ...pairs.flatMap(([k, v]) => [el("dt", {}, k), el("dd", {}, v)]));
  function ofRegion(mark, found) {
    if (!found) return [];
    if (found.sentence) return [el("p.wrong", {}, found.sentence.replace(/^region: /, "").replace(/^./, (c) => c.toUpperCase()) + ".")];
    const { length, value } = marks.units(), v = (x) => (x === null ? "–" : `${short(x, 6)} ${value}`.trim()), p = found.percentiles;
    return [facts([[w.count, String(found.count)], [w.mean, v(found.mean)], [w.deviation, v(found.deviation)], [w.range, `${v(found.min)} ${words.to} ${v(found.max)}`], [w.median, v(p[50])], [w.quartiles, `${v(p[25])}, ${v(p[75])}`], [w.tails, `${v(p[5])}, ${v(p[95])}`],
      [w.volume, `${short(found.volume_mm3)} ${length}³`], [w.exactVolume, `${short(found.exact_mm3)} ${length}³`], ...(mark.kind === "ball" ? [[w.radius, `${short(lengthOf(mark))} ${length}`]] : [])]), plot(found.histogram, found.min, found.max, value, true)];
  }
  function ofProfile(mark, found) {
    if (!found?.values?.some((v) => v !== null)) return [];
    const { length, value } = marks.units(), csv = () => download(new Blob([`distance_${length},value${value ? "_" + value : ""}\r\n${found.values.map((x, i) => `${i * found.step},${x ?? ""}`).join("\r\n")}\r\n`], { type: "text/csv" }), w.profileFile);
    return [plot(found.values, 0, lengthOf(mark), length, false), el("div.buttons", {}, el("button", { onclick: csv }, w.profileCsv))];
  }
  function showDetails() {
    const i = marks.selected, mark = marks.list()[i], found = mark && (isRegion(mark) ? marks.region(mark) : mark.kind === "profile" ? marks.profile(mark) : null), key = JSON.stringify([i, mark?.kind, mark?.points, found]);
    if (key === detailsOf || (mark && details.contains(document.activeElement) && app.store.dragging)) return;
    detailsOf = key;
    if (!mark) return details.replaceChildren();
    if (!details.lastChild || details.dataset.of !== `${i} ${mark.kind} ${mark.points.length}`) {
      details.dataset.of = `${i} ${mark.kind} ${mark.points.length}`;
      const points = mark.points.length > 12 ? [] : mark.points.map((_, n) => {
        const fields = words.axes.map((axis, k) => numberField(app, { label: `${w.pointOf(marks.nameOf(mark, i), n + 1)} ${axis}`, low: -1e9, high: 1e9, step: Math.min(...app.volume.spacing_mm), now: () => marks.list()[i].points[n][k], text: () => short(marks.list()[i]?.points[n]?.[k] ?? 0, 6),
          change: (v) => marks.change(i, { points: marks.list()[i].points.map((p, m) => (m === n ? p.map((c, a) => (a === k ? v : c)) : p)) }, `${w.moved}…`) }));
        return Object.assign(el("div.three", {}, ...fields.map((f, k) => el("div.field", {}, el("span.unit", {}, words.axes[k]), f.input)), ...fields.map((f) => f.wrong)), { show: () => fields.forEach((f) => f.show()) });
      });
      details.replaceChildren(...(points.length ? [el("div.label", {}, w.points(app.unitOfLength(), app.volume.world))] : []), ...points, el("div.mark-numbers"));
    }
    for (const part of details.children) part.show?.();
    details.lastChild.replaceChildren(...(isRegion(mark) ? ofRegion(mark, found) : mark.kind === "profile" ? ofProfile(mark, found) : []));
  }

  function show() {
    if (!section) return open();
    const { kind } = marks, all = marks.list();
    for (const button of kinds.children) {
      const on = button.dataset.kind === kind;
      button.setAttribute("aria-checked", String(on && marks.busy));
      button.tabIndex = on ? 0 : -1;
    }
    hint.textContent = marks.busy ? w.hints[kind] : "";
    bySlices.hidden = !app.slices || app.slices.layout() === "volume";
    done.hidden = marks.draft?.kind !== "polyline";
    table.hidden = !all.length;
    if (list.children.length !== all.length) list.replaceChildren(...all.map((_, i) => row(i)));
    for (const part of list.children) part.show();
    showDetails();
    section.show();
  }
  kinds.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const at = marks.kinds.indexOf(marks.kind), next = kinds.children[(at + step + marks.kinds.length) % marks.kinds.length];
    next.click();
    next.focus();
  });
  function open() {
    const px = numberField(app, { label: w.snap, low: 0, high: 20, step: 1, unit: "px", now: () => marks.reach, text: () => String(marks.reach), change: (v) => (marks.reach = v) });
    const snap = Object.assign(el("div.row.choice", { role: "group", "aria-label": w.snap }, el("div.label", { title: w.snapTip }, w.snap), el("div.field.mark-snap", {}, px.input, el("span.unit", {}, "px")), px.wrong), { show: px.show });
    section = fold(w.title, () => (marks.list().length ? w.some(marks.list().length) : w.none), [kinds, hint, snap, el("div.buttons", {}, bySlices, done), list, details, table], "", "section.section.s-marks");
    root.replaceChildren(section);
    section.querySelector(".head").click();
    show();
  }
  /** A mark is there: a text asks for its words. */
  const made = () => requestAnimationFrame(() => {
    const mark = marks.list()[marks.selected];
    if (mark && (mark.kind === "text" || mark.kind === "arrow") && !mark.text) show(), list.lastChild?.querySelector("input").focus();
  });
  return { root, show, open, made };
}
