// Rows of the panel: slider with number, two-handled slider, choice, switch; and a row made from a setting's description.
import { arrow, clamp, el, endMoved, hex, fromHex, short, typed, tell } from "./dom.js";
import { read, write } from "./scene.js";
import { keyOf } from "./table.js";
import { words } from "./texts.js";

let ids = 0;

/** Horizontal scale of a slider: value to share of the track and back. */
const scaleOf = ({ low, high, log }) => ({
  share: (v) => clamp(log ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low), 0, 1) || 0,
  value: (s) => (log ? low * (high / low) ** s : low + s * (high - low)),
});

const rounded = (value, { step = 0.01, log }, fine = 1) => {
  if (log && step < 1) return Number(value.toPrecision(3));
  const unit = step * fine;
  return Number((Math.round(value / unit) * unit).toPrecision(12));
};

/** One step of the arrow keys: a step, or a percent on a logarithmic scale. */
const stepped = (value, steps, o) => (o.log ? (o.step >= 1 ? value + Math.sign(steps) * Math.max(1, Math.round(value * Math.abs(1.05 ** steps - 1))) : value * 1.02 ** steps) : value + steps * o.step);

/** Drags with the pointer: from(event) at the press, move(dx, event) then; one undo step; Esc goes back.
 * @param {any} element @param {any} store @param {string} label @param {(event: PointerEvent) => any} from @param {any} move @param {string} [track] */
export function draggable(element, store, label, from, move, track = "design") {
  element.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || element.disabled) return;
    const start = from(event);
    if (start === false) return;
    element.setPointerCapture(event.pointerId);
    store.begin(typeof label === "function" ? label() : label, track);
    const moved = (e) => move(start, e.clientX - event.clientX, e.clientY - event.clientY, e);
    const stop = (e) => {
      for (const [name, f] of Object.entries(heard)) element.removeEventListener(name, f);
      removeEventListener("keydown", escape, true);
      if (e.type === "pointerup") store.end();
      else store.cancel();
    };
    const escape = (e) => e.key === "Escape" && (e.stopPropagation(), stop(e));
    const heard = { pointermove: moved, pointerup: stop, pointercancel: stop };
    for (const [name, f] of Object.entries(heard)) element.addEventListener(name, f);
    addEventListener("keydown", escape, true);
  });
}

/** A handle of a track. @param {any} o options of the row @param {number} which of the values */
function handle(app, o, track, which) {
  const scale = scaleOf(o), values = () => [o.value()].flat(), track_ = o.track ?? "design";
  const put = (value) => o.change(o.two ? endMoved(values(), which, value) : value);
  const thumb = el("div.thumb", { role: "slider", tabIndex: 0, "aria-label": o.two ? `${o.label}, ${which ? "to" : "from"}` : o.label, "aria-valuemin": String(o.low), "aria-valuemax": String(o.high) });
  draggable(thumb, app.store, o.step_ ?? o.label, () => scale.share(values()[which]), (start, dx, _, e) => {
    const value = scale.value(clamp(start + dx / (track.clientWidth || 1), 0, 1));
    put(clamp(rounded(value, o, e.shiftKey ? 0.1 : 1), o.low, o.high));
  }, track_);
  thumb.addEventListener("keydown", (event) => {
    const steps = arrow(event) ?? { PageUp: 10, PageDown: -10 }[event.key];
    const ends = { Home: o.low, End: o.high }[event.key];
    if (steps === undefined && ends === undefined) return;
    event.preventDefault();
    put(clamp(ends ?? rounded(stepped(values()[which], steps * (event.shiftKey ? 10 : 1), o), o), o.low, o.high));
  });
  return thumb;
}

/** Writing the same anew would lay out the page. */
const setText = (input, text) => input.value !== text && (input.value = text);

/** A field for a number: click types, a drag scrubs. */
export function numberField(app, o) {
  const id = `f${++ids}`;
  const input = el("input.number", { id, inputMode: "decimal", "aria-label": o.label, autocomplete: "off", spellcheck: false });
  const wrong = el("div.wrong", { role: "alert", hidden: true });
  const ends = () => o.ends?.() ?? [o.least ?? o.low, o.most ?? o.high];
  const range = () => `${ends().map((end) => short(end)).join(` ${words.to} `)}${o.unit ? " " + o.unit : ""}`;
  let refused = ""; // what the value was then
  const say = (bad) => {
    wrong.hidden = !bad;
    refused = o.text();
    input.setAttribute("aria-invalid", String(bad));
    if (bad) wrong.textContent = words.outOfRange(range());
  };
  const take = () => {
    if (input.value === o.text()) return say(false);
    const value = typed(input.value), [least, most] = ends();
    // What was typed stays with the range below it; the last good value stays in force.
    if (!(value >= least && value <= most)) return say(true);
    say(false);
    o.change(value);
    setText(input, o.text()); // which may be the nearest that is possible
  };
  input.addEventListener("change", take);
  input.addEventListener("keydown", (event) => {
    if (event.key === "Enter") take();
    if (event.key === "Escape") (input.value = o.text()), say(false), input.blur();
    const steps = { ArrowUp: 1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
    if (!steps || !o.step) return;
    event.preventDefault();
    o.change(clamp(rounded(stepped(o.now(), steps * (event.shiftKey ? 10 : 1), o), o), ...ends()));
  });
  const show = () => {
    if (!wrong.hidden && o.text() !== refused) say(false), setText(input, o.text());
    if (document.activeElement !== input && wrong.hidden) setText(input, o.text());
  };
  return { input, wrong, show };
}

/** Label, track and number. o: {label, low, high, step, log, unit, tip, value(), change(v), start, two, track}. */
export function sliderRow(app, o) {
  const scale = scaleOf(o), line = el("div.line"), fill = el("div.fill");
  const track = el("div.track", {}, line, fill);
  const thumbs = o.two ? [handle(app, o, track, 0), handle(app, o, track, 1)] : [handle(app, o, track, 0)];
  track.append(...thumbs);
  if (o.start !== undefined && !o.two && o.origin) track.append(el("div.origin", { style: `left:${100 * scale.share(o.origin)}%` }));
  const text = (v) => (o.show_ ? o.show_(v) : short(v, 3));
  const fields = (o.two ? [0, 1] : [0]).map((which) => numberField(app, {
    ...o, label: o.two ? `${o.label}, ${which ? "to" : "from"}` : o.label, now: () => [o.value()].flat()[which], text: () => text([o.value()].flat()[which]),
    change: (v) => o.change(o.two ? [o.value()].flat().map((x, i) => (i === which ? v : x)) : o.parse ? o.parse(v) : v),
    ends: o.two && (() => [which ? o.value()[0] : o.least ?? o.low, which ? o.most ?? o.high : o.value()[1]]),
  }));
  const number = el("div.field", {}, fields[0].input, ...(o.two ? [el("span.unit", {}, words.to), fields[1].input] : []), o.unit && !o.two ? el("span.unit", {}, o.unit) : null);
  const dot = el("i.dot", { hidden: true, title: "changed" });
  const note = o.note ? el("small", {}) : null, label = el("div.label", { title: o.tip ?? "" }, o.label, note, dot);
  const row = el(`div.row${o.two ? ".two" : ""}`, { role: "group", "aria-label": o.label }, label, track, number, ...fields.map((f) => f.wrong));
  if (!o.two) {
    // The label scrubs: one step per 2 pixels, Shift a tenth; double click: the default.
    draggable(label, app.store, o.step_ ?? o.label, () => o.value(), (start, dx, _, e) => {
      const value = o.log ? scale.value(clamp(scale.share(start) + (dx / 2) * 0.01 * (e.shiftKey ? 0.1 : 1), 0, 1)) : start + Math.trunc(dx / 2) * o.step * (e.shiftKey ? 0.1 : 1);
      o.change(clamp(rounded(value, o, e.shiftKey ? 0.1 : 1), o.low, o.high));
    }, o.track);
    label.addEventListener("dblclick", () => o.start !== undefined && o.change(o.start, true));
    track.addEventListener("pointerdown", (event) => event.target === track && o.change(rounded(scale.value(clamp(event.offsetX / track.clientWidth, 0, 1)), o)));
  }
  return Object.assign(row, { show() {
    const values = [o.value()].flat(), shares = values.map((v) => scale.share(v));
    const origin = o.two ? shares[0] : o.origin ? scale.share(o.origin) : 0, end = o.two ? shares[1] : shares[0];
    fill.style.left = `${100 * Math.min(origin, end)}%`;
    fill.style.width = `${100 * Math.abs(end - origin)}%`;
    thumbs.forEach((thumb, i) => {
      thumb.style.left = `${100 * shares[i]}%`;
      tell(thumb, values[i], `${text(values[i])}${o.unit ? " " + o.unit : ""}`);
    });
    fields.forEach((f) => f.show());
    if (note) note.textContent = o.note(values[0]);
    dot.hidden = o.two || o.start === undefined || values[0] === o.start || Boolean(o.unchanged?.());
  } });
}

/** A label with a choice of few. options: [[value, name], …]. */
export function choiceRow(app, o) {
  const id = `c${++ids}`;
  const select = el("select", { id, onchange: () => o.change(o.options[select.selectedIndex][0]) }, ...o.options.map(([, name]) => el("option", {}, name)));
  return Object.assign(el("div.row.choice", {}, el("label.label", { for: id, title: o.tip ?? "" }, o.label), select), {
    show: () => (select.selectedIndex = o.options.findIndex(([value]) => String(value) === String(o.value()))),
  });
}

/** A colour of the system's own picker. */
export function colourRow(app, o) {
  const input = el("input.swatch", { type: "color", "aria-label": o.label, oninput: () => o.change(fromHex(input.value)) });
  return Object.assign(el("div.row.choice", {}, el("span.label", {}, o.label), input), { show: () => (input.value = hex(o.value())) });
}

const nameOf = (choice) => words.choices[choice] ?? choice;

/** The row of a described setting. */
export function settingRow(app, s) {
  const key = keyOf(s), track = s.key.startsWith("camera.") ? "camera" : "design";
  const tip = `${s.sentence[0].toUpperCase()}${s.sentence.slice(1)}. --${s.flag}`;
  const change = (value, reset) => app.store.set(`${s.label}…`, (state) => write(state, key, reset ? null : value), track);
  const now = () => read(app.store.state, key);
  if (s.flag === "zoom") return sliderRow(app, { ...s, tip, start: 1, value: () => 1 / (now() ?? 1), change: (v) => change(1 / v), track, origin: 1 });
  if (s.flag === "fit") return choiceRow(app, { ...s, tip, options: s.choices.map((c) => [c, words.choices[c]]), value: now, change: (v) => app.gestures.fit(v) });
  // Automatic, until it is moved: the number is the server's.
  if (s.flag === "probe-exposure") return sliderRow(app, { ...s, tip, start: "auto", value: () => { const v = now(); return v === "auto" ? app.frame.last?.probe_exposure ?? 0 : v; }, change, track, unchanged: () => now() === "auto", origin: 0, least: s.lowest, most: s.highest });
  const steps = /^\d+(\|\d+)+$/.test(s.form ?? "") ? s.form.split("|").map(Number) : null;
  if (steps) return choiceRow(app, { ...s, tip, options: steps.map((n) => [n, s.label === "Grid" ? `1:${n}` : String(s.flag === "sh-bands" ? n * n : n)]), value: now, change });
  if (s.flag === "bounces") return choiceRow(app, { ...s, tip, options: [...[0, 1, 2, 3, 4, 6, 8, 12, 16].map((n) => [n, String(n)]), ["unlimited", words.choices.unlimited]], value: now, change });
  if (s.flag === "sh-sampling") return choiceRow(app, { ...s, tip, options: [["fibonacci", nameOf("fibonacci")], ["jittered", nameOf("jittered")]], value: () => String(now()).split(":")[0], change });
  if (s.flag === "up") return choiceRow(app, { ...s, tip, options: ["+x", "-x", "+y", "-y", "+z", "-z"].map((n) => [n, n]), value: () => now() ?? "+z", change });
  if (s.flag === "shading") return choiceRow(app, { ...s, tip, options: [["none", words.choices.none], ["lambert", words.choices.lambert], ["phong", words.choices.phong]],
    value: () => ({ true: "phong", false: "none" })[String(now())] ?? now(), change: (v) => change({ phong: true, none: false }[v] ?? v) });
  if (s.kind === "switch") return choiceRow(app, { ...s, tip, options: [[false, words.choices.off], [true, words.choices.on]], value: () => now() ?? false, change });
  if (s.kind === "choice") return choiceRow(app, { ...s, tip, options: s.choices.map((c) => [c, nameOf(c)]), value: now, change });
  const least = s.lowest ?? s.low, most = s.highest ?? s.high;
  const wrap = s.unit === "°" && s.flag !== "fov" && s.flag !== "elevation";
  const shown = (v) => (wrap ? ((((v ?? 0) - s.low) % 360) + 360) % 360 + s.low : v ?? s.default ?? s.low);
  return sliderRow(app, { ...s, tip, least, most, start: s.default ?? undefined, value: () => shown(now()), change, track,
    origin: s.low < 0 && s.high > 0 ? 0 : undefined, note: s.unit === "vx" && s.place === "light" ? (v) => (app.volume.spacing_stated === false ? "" : `${short((s.flag === "spao-levels" ? 2 ** (v - 1) : v) * app.box.edge, 3)} mm`) : undefined,
    ...(s.flag === "spao-levels" ? { show_: (v) => short(2 ** (v - 1)), parse: (v) => Math.round(Math.log2(v)) + 1, least: 1, most: 8192 } : {}) });
}
