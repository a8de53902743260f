// The editor on the graph: points, segments, peaks, colour stops and the axis, with pointer and keys.
import { arrow, clamp, el, hex, short, tell } from "./dom.js";
import { Axis, drawGraph, shareOf } from "./graph.js";
import { makeMarkers } from "./markers.js";
import { peaksOf, inserted, moved, roundTo, without } from "./peaks.js";
import { draggable } from "./rows.js";
import { at, read } from "./scene.js";
import { words } from "./texts.js";

const snaps = [0, 0.01, 0.03, 0.1, 0.3, 1];
const nearest = (value, list) => list.reduce((a, b) => (Math.abs(b - value) < Math.abs(a - value) ? b : a));

/** Builds the graph. `ui` holds what is chosen: points (indices), stop. */
export function makeGraph(app) {
  const { store, ui } = app;
  const canvas = el("canvas"), layer = el("div.layer"), readout = el("div.readout");
  const root = el("div.graph", { role: "group", "aria-label": words.colour }, readout, el("div.plot", {}, canvas, layer));
  const plot = root.lastChild, axis = new Axis([0, 1]), marks = {};
  const tf = () => store.state.tf;
  const setPoints = (label, points) => store.set(label, (s) => ({ tf: { ...s.tf, points } }));
  const setStops = (label, stops) => store.set(label, (s) => ({ tf: { ...s.tf, stops } }));
  const peaks = () => peaksOf(tf().points, tf().stops, axis.range);
  /** What undo calls it: the peak by its name or values. */
  const stepName = (i) => {
    const peak = peaks().find((h) => i >= h.first && i <= h.last);
    return words.opacity.toLowerCase() + (peak ? ` of ${peak.name ?? words.range(peak.lo, peak.hi)}` : "");
  };
  const choose = (points, stop = -1) => ((ui.points = points), (ui.stop = stop), store.redraw());

  /** Applies a drag of (dx, dy) pixels to points that were `from` when it began; `grabbed` is the opacity under the pointer. */
  function shift(from, chosen, lead, dx, dy, event, sideways = true) {
    if (event.shiftKey && sideways) Math.abs(dx) > Math.abs(dy) ? (dy = 0) : (dx = 0);
    const first = from[chosen[0]], start = lead.opacity;
    let dv = dx * axis.pixel, opacity = dy === 0 ? start : axis.opacity(clamp(axis.y(start) + dy, axis.top, axis.y(0)));
    if (event.ctrlKey) (dv = roundTo(lead.value + dv, axis.pixel * 6) - lead.value), (opacity = nearest(opacity, snaps));
    const raise = chosen.length === 1 ? () => opacity : start > 0 ? (o) => (o * opacity) / start : () => opacity;
    return first && moved(from, chosen, dv, dy === 0 ? (o) => o : raise);
  }

  const remove = (chosen) => (setPoints("Remove a point", without(tf().points, chosen)), choose([]));
  const add = (value, opacity) => {
    const made = inserted(tf().points, { value, opacity });
    setPoints("New point", made.points);
    choose([made.index]);
    return made.index;
  };

  function pointElement(i) {
    const point = el("div.point", { role: "slider", tabIndex: 0, "aria-label": words.point, "aria-valuemin": "0", "aria-valuemax": "1" }, el("i"));
    draggable(point, store, () => stepName(i), (event) => {
      const chosen = event.shiftKey ? [...new Set([...ui.points, i])] : ui.points.includes(i) ? ui.points : [i];
      choose(chosen.sort((a, b) => a - b));
      point.focus({ preventScroll: true });
      return { from: tf().points, chosen };
    }, ({ from, chosen }, dx, dy, event) => {
      const box = plot.getBoundingClientRect(), out = Math.max(box.top - event.clientY, event.clientY - box.bottom - 20) > 40;
      plot.classList.toggle("dropping", out);
      setPoints(stepName(i), shift(from, chosen, from[i], dx, dy, event));
      point.ontransitionend = null;
      point.dataset.out = out ? "1" : "";
    });
    point.addEventListener("pointerup", () => {
      plot.classList.remove("dropping");
      if (point.dataset.out) setTimeout(() => remove(ui.points.length ? ui.points : [i]));
      point.dataset.out = "";
    });
    point.addEventListener("dblclick", () => app.typeValue?.());
    point.addEventListener("focus", () => !ui.points.includes(i) && choose([i]));
    point.addEventListener("keydown", (event) => {
      const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -2], ArrowDown: [0, 2], PageUp: [0, -10], PageDown: [0, 10] }[event.key];
      if (event.key === "Delete" || event.key === "Backspace") remove(ui.points);
      else if (event.key.toLowerCase() === "n" && !event.ctrlKey) ((i) => requestAnimationFrame(() => requestAnimationFrame(() => points[i]?.focus())))(add(...between(i)));
      else if (steps) setPoints(`${stepName(i)}…`, shift(tf().points, ui.points, tf().points[i], steps[0] * (event.shiftKey ? 10 : 1), steps[1] * (event.shiftKey ? 5 : 1), { shiftKey: false }, false));
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
    return point;
  }
  const between = (i) => {
    const p = tf().points, next = p[i + 1] ?? p[i - 1] ?? { value: axis.range[1], opacity: 0 };
    const value = (p[i].value + next.value) / 2;
    return [value, at(p, value, "opacity")];
  };

  function stopElement(i) {
    const colour = el("input.hidden-colour", { type: "color", tabIndex: -1, "aria-label": words.colourField, oninput: () => setStops("Colour…", tf().stops.map((s, k) => (k === i ? { ...s, rgb: app.fromHex(colour.value) } : s))) });
    const stop = el("div.stop", { role: "slider", tabIndex: 0, "aria-label": words.stop }, el("i"), colour);
    const place = (from, dv) => from.map((s, k) => (k === i ? { ...s, value: clamp(s.value + dv, from[k - 1]?.value ?? -Infinity, from[k + 1]?.value ?? Infinity) } : s));
    let travelled = 0;
    draggable(stop, store, "Colour stop", () => (choose([], i), (travelled = 0), tf().stops), (from, dx, _, event) => {
      travelled = Math.max(travelled, Math.abs(dx));
      if (travelled > 3) setStops("Colour stop", place(from, event.ctrlKey ? roundTo(from[i].value + dx * axis.pixel, axis.pixel * 6) - from[i].value : dx * axis.pixel));
    });
    const pick = () => ((colour.value = hex(tf().stops[i].rgb)), colour.showPicker ? colour.showPicker() : colour.click());
    stop.addEventListener("click", (event) => event.target !== colour && travelled <= 3 && pick());
    stop.addEventListener("focus", () => ui.stop !== i && choose([], i));
    stop.addEventListener("keydown", (event) => {
      const step = arrow(event);
      if (event.key === "Delete" || event.key === "Backspace") tf().stops.length > 1 && (setStops("Remove a colour", tf().stops.filter((_, k) => k !== i)), choose([]));
      else if (event.key === "Enter" || event.key === " ") pick();
      else if (step) setStops("Colour stop…", place(tf().stops, step * axis.pixel * (event.shiftKey ? 10 : 1)));
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
    return stop;
  }

  const markers = makeMarkers(app, axis, plot);

  // The plot itself: lines, peaks, rectangle, axis.
  const local = (event) => [event.clientX - plot.getBoundingClientRect().left, event.clientY - plot.getBoundingClientRect().top];
  const what = (x, y) => {
    const floor = axis.y(0), value = axis.value(x);
    if (y > floor + 28) return "axis";
    if (y > floor + 3) return "bar";
    const line = axis.y(at(tf().points, value, "opacity"));
    return Math.abs(y - line) <= 6 && y < floor - 4 ? "line" : Math.abs(y - line) <= 4 ? "floor" : y < line ? "above" : "inside";
  };
  const segmentAt = (value) => {
    const right = tf().points.findIndex((p) => p.value > value);
    return right < 0 ? [tf().points.length - 1] : right === 0 ? [0] : [right - 1, right];
  };
  plot.addEventListener("pointerdown", (event) => {
    if (event.target !== canvas && event.target !== layer) return;
    if (event.button !== 0) return;
    const [x, y] = local(event), kind = what(x, y), value = axis.value(x), opacity = at(tf().points, value, "opacity");
    const peak = kind === "inside" && peaks().find((h) => value >= h.lo && value <= h.hi);
    const chosen = kind === "line" ? segmentAt(value) : peak ? tf().points.map((_, i) => i).slice(peak.first, peak.last + 1) : [];
    const from = tf().points, view = [...axis.view], far = event.pointerType === "touch" ? 8 : 4;
    let dragging = false;
    plot.setPointerCapture(event.pointerId);
    const move = (e) => {
      const dx = e.clientX - event.clientX, dy = e.clientY - event.clientY;
      if (!dragging && Math.hypot(dx, dy) < far) return;
      if (!dragging && chosen.length) (store.begin(stepName(chosen[0])), choose(chosen));
      dragging = true;
      if (kind === "axis") (axis.view = view.map((v) => v - dx * ((view[1] - view[0]) / axis.width))), store.redraw();
      else if (chosen.length) {
        // A segment goes up and down, with Shift sideways; a peak goes where it is dragged.
        const [mx, my] = kind === "line" ? (e.shiftKey ? [dx, 0] : [0, dy]) : [dx, dy];
        setPoints(stepName(chosen[0]), shift(from, chosen, { value, opacity: Math.max(opacity, 1e-6) }, mx, my, { ctrlKey: e.ctrlKey, shiftKey: e.shiftKey && kind !== "line" }));
      } else if (kind === "above" || kind === "floor") (marks.box = [x, y, dx, dy]), store.redraw();
    };
    const up = (e) => {
      plot.removeEventListener("pointermove", move);
      store.end();
      if (dragging && marks.box) {
        const [bx, by, w, h] = marks.box, inside = (v, a, d) => v >= Math.min(a, a + d) && v <= Math.max(a, a + d);
        choose(tf().points.map((p, i) => (inside(axis.x(p.value), bx, w) && inside(axis.y(p.opacity), by, h) ? i : -1)).filter((i) => i >= 0));
        delete marks.box;
        store.redraw();
      } else if (!dragging && e.type === "pointerup") {
        if (kind === "line" || kind === "above" || kind === "floor") add(value, kind === "above" ? axis.opacity(y) : opacity);
        else if (peak) choose(chosen);
      }
    };
    plot.addEventListener("pointermove", move);
    plot.addEventListener("pointerup", up, { once: true });
    plot.addEventListener("pointercancel", up, { once: true });
  });
  plot.addEventListener("dblclick", (event) => {
    if (event.target !== canvas && event.target !== layer) return;
    const [x, y] = local(event), kind = what(x, y), value = axis.value(x);
    if (kind === "axis") (axis.view = app.windowNow()), store.redraw();
    if (kind !== "bar") return;
    const index = tf().stops.filter((s) => s.value <= value).length, made = { value, rgb: at(tf().stops, value, "rgb") };
    setStops("New colour", [...tf().stops.slice(0, index), made, ...tf().stops.slice(index)]);
    choose([], index);
  });
  plot.addEventListener("wheel", (event) => {
    event.preventDefault();
    axis.zoom(local(event)[0], 1.0015 ** event.deltaY);
    store.redraw();
  }, { passive: false });

  // Resting: the value, its opacity and share in the strip above; the picture lights up what has about that value.
  let rest = 0;
  plot.addEventListener("pointermove", (event) => {
    const [x, y] = local(event);
    const cursor = what(x, y);
    canvas.style.cursor = { line: event.shiftKey ? "ew-resize" : "ns-resize", inside: "move", axis: "grab", bar: "copy", above: "crosshair" }[cursor] ?? "crosshair";
    marks.hover = !event.buttons && event.pointerType === "mouse" && y < axis.y(0) + 20 && x >= axis.left && event.target === canvas ? axis.value(x) : undefined;
    clearTimeout(rest);
    if (ui.lit) (ui.lit = false), app.highlight(null);
    if (marks.hover !== undefined) {
      const band = (axis.view[1] - axis.view[0]) * 0.01, centre = marks.hover;
      rest = setTimeout(() => ((ui.lit = true), app.highlight(centre - band, centre + band, 0.25)), 600);
    }
    store.redraw();
  });
  plot.addEventListener("pointerleave", () => {
    clearTimeout(rest);
    marks.hover = undefined;
    if (ui.lit) (ui.lit = false), app.highlight(null);
    store.redraw();
  });

  const fit = (list, count, make) => {
    while (list.length > count) list.pop().remove();
    while (list.length < count) layer.append(list[list.push(make(list.length)) - 1]);
  };
  const points = [], stops = [];
  function draw(state) {
    if (!root.isConnected || !root.clientWidth) return;
    axis.width = canvas.clientWidth - axis.left - 3;
    axis.height = canvas.clientHeight - axis.top - 48;
    ui.points = ui.points.filter((i) => i < state.tf.points.length);
    fit(points, state.tf.points.length, pointElement);
    fit(stops, state.tf.stops.length, stopElement);
    const put = (element, x, y) => ((element.style.transform = `translate(${x}px, ${y}px)`), (element.style.visibility = x < axis.left - 2 || x > axis.left + axis.width + 2 ? "hidden" : ""));
    state.tf.points.forEach((p, i) => {
      const element = points[i], colour = hex(at(state.tf.stops, p.value, "rgb"));
      put(element, axis.x(p.value), axis.y(p.opacity));
      element.style.setProperty("--own", colour);
      element.classList.toggle("chosen", ui.points.includes(i));
      tell(element, p.opacity, words.pointText(short(p.opacity, 3), app.withUnit(p.value)));
    });
    state.tf.stops.forEach((s, i) => {
      put(stops[i], axis.x(s.value), axis.y(0) + 23);
      stops[i].style.setProperty("--own", hex(s.rgb));
      stops[i].classList.toggle("chosen", ui.stop === i);
      tell(stops[i], s.value, words.stopText(hex(s.rgb), app.withUnit(s.value)));
    });
    markers.draw(state);
    marks.selected = ui.points.length === 1 ? state.tf.points[ui.points[0]].value : ui.stop >= 0 ? state.tf.stops[ui.stop]?.value : undefined;
    marks.surfaces = read(state, "mode") === "iso" ? state.iso.map((s) => s.value) : [];
    marks.seen = ui.seen;
    marks.glow = app.glowNow?.();
    drawGraph(canvas, axis, state, app.histogram, app.theme.colours(), marks);
    const shown = marks.hover ?? marks.selected;
    const half = (axis.range[1] - axis.range[0]) / app.histogram.counts.length / 2;
    readout.replaceChildren(...(shown === undefined ? [] : [el("b", {}, app.withUnit(shown)), el("span", {}, `${words.opacity.toLowerCase()} ${short(at(state.tf.points, shown, "opacity"), 3)}`),
      el("span", {}, words.ofVoxels(app.percent(shareOf(app.histogram, shown - half, shown + half))))]));
  }
  store.watch(draw, { camera: false });
  return { root, axis, draw, add, peaks, setPoints, setStops, choose };
}
