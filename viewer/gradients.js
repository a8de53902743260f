// Functions of value and gradient: the histogram of both, the shapes over it, and the curve over the gradient alone. Loaded when first used.
import { clamp, el, hex, icon, short, tell } from "./dom.js";
import { between, bent, curveAt, moved, Plane, resized, withBend } from "./gradient-shapes.js";
import { drawPlane, shadesOf } from "./gradient-picture.js";
import { makeGradientRows } from "./gradient-rows.js";
import { draggable } from "./rows.js";
import { at, read } from "./scene.js";
import { styled } from "./styles.js";
import { gradientWords as w } from "./part-texts.js";
import { words } from "./texts.js";

const strip = 52; // pixels of the curve's, with the gap before it
const far = 4; // pixels from where a press is a drag

export async function makeGradients(app, section) {
  await styled("gradients.css");
  const { store } = app, rest = () => store.state.tf.rest, axis = app.graph.axis;
  const canvas = el("canvas"), ground = el("div.ground"), side = el("div.ground"), layer = el("div.layer"), plot = el("div.plot.gradient-plot", {}, canvas, ground, side, layer);
  const readout = el("span"), waiting = el("div.gradient-waiting", { role: "status", hidden: true });
  const close = el("button.tool", { onclick: () => toggle() }), body = el("div.gradient-body", {}, plot);
  const root = el("div.gradients", { role: "group", "aria-label": w.title, hidden: true }, el("div.gradient-head", {}, el("b", {}, w.title), readout, close), body);
  const plane = new Plane([0, 1], 1);
  /** What is chosen: a widget or a point of the curve. */
  const chosen = { widgets: -1, gradient_opacity: -1 };
  let told = null, shades = null, toldOf = null, asked = null, open = false, had = false, hover = null;

  const list = (key) => rest()[key] ?? [];
  const put = (label, key, next) => store.set(label, (s) => {
    const { [key]: _, ...others } = s.tf.rest;
    return { tf: { ...s.tf, rest: next.length ? { ...others, [key]: next } : others } };
  });
  const nameOf = (i) => w.numbered(w.shapes[list("widgets")[i]?.shape] ?? "", i + 1);
  const stepOf = (i) => w.shapes[list("widgets")[i]?.shape];
  const range = () => axis.range[1] - axis.range[0];
  const choose = (key, i) => (Object.assign(chosen, { widgets: -1, gradient_opacity: -1 }, { [key]: i }), store.redraw());
  const change = (i, widget, label = stepOf(i)) => put(label, "widgets", list("widgets").map((old, k) => (k === i ? widget : old)));
  const unit = () => w.per(app.volume.unit, app.volume.spacing_stated === false ? w.voxel : "mm");
  const gradientText = (m) => `${short(m, 3)} ${unit()}`;
  function remove(key, i) {
    const left = list(key).filter((_, k) => k !== i);
    // A curve of one point would be a factor of everything.
    put(w.removed(key === "widgets" ? nameOf(i) : w.curve), key, key === "widgets" || left.length > 1 ? left : []);
    choose(key, -1);
  }
  function addShape(shape) {
    const [lo, hi] = app.windowNow(), middle = (lo + hi) / 2, half = (hi - lo) / 8, { steepest } = plane;
    put(w.added(w.shapes[shape]), "widgets", [...list("widgets"), between(shape, [middle - half, middle + half], [0.06 * steepest, 0.5 * steepest], range(), steepest)]);
    choose("widgets", list("widgets").length - 1);
  }
  function addCurve() {
    const { steepest } = plane;
    put(w.added(w.curve), "gradient_opacity", [{ magnitude: 0, opacity: 0 }, { magnitude: Number((steepest / 4).toPrecision(3)), opacity: 1 }]);
    choose("gradient_opacity", 1);
  }
  const local = (event) => [event.clientX - plot.getBoundingClientRect().left, event.clientY - plot.getBoundingClientRect().top];

  // A drag on the empty plot is a new shape, of the kind that was made last; a click chooses nothing.
  let lastShape = "rectangle";
  draggable(ground, store, () => w.added(w.shapes[lastShape]), (event) => (choose("widgets", -1), { all: list("widgets"), begun: local(event), far: event.pointerType === "touch" ? 2 * far : far }), ({ all, begun: [x, y], far: least }, dx, dy) => {
    if (list("widgets").length === all.length && Math.hypot(dx, dy) < least) return;
    const clampX = (v) => clamp(v, plane.left, plane.left + plane.width), made = between(lastShape, [plane.value(x), plane.value(clampX(x + dx))], [plane.magnitude(y), plane.magnitude(y + dy)], range(), plane.steepest);
    put("", "widgets", [...all, made]);
    choose("widgets", all.length);
  });
  const opacityAt = (x) => clamp((x - sideLeft()) / sideWidth(), 0, 1), sideLeft = () => plane.left + plane.width + 14, sideWidth = () => strip - 20;
  side.addEventListener("click", (event) => {
    const [x, y] = local(event), [next, i] = withBend(list("gradient_opacity"), plane.magnitude(y), opacityAt(x));
    put(w.added(w.point), "gradient_opacity", next);
    choose("gradient_opacity", i);
  });

  const stepsOf = (event) => ({ ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] })[event.key]?.map((n) => n * (event.shiftKey ? 10 : 1));
  /** What keys do on a part: `go` takes steps to the right and up. */
  const keys = (part, go, gone) => part.addEventListener("keydown", (event) => {
    const steps = stepsOf(event);
    if ((event.key === "Delete" || event.key === "Backspace") && gone) gone();
    else if (steps) go(...steps);
    else return;
    event.preventDefault();
    event.stopPropagation();
  });

  function shapePart(i) {
    const part = el("div.shape", { role: "slider", tabIndex: 0 });
    draggable(part, store, () => stepOf(i), () => (choose("widgets", i), part.focus({ preventScroll: true }), list("widgets")[i]), (from, dx, dy) => change(i, moved(from, dx * ((plane.view[1] - plane.view[0]) / plane.width), -dy / plane.height, plane.steepest)));
    part.addEventListener("focus", () => chosen.widgets !== i && choose("widgets", i));
    keys(part, (dv, dq) => change(i, moved(list("widgets")[i], dv * axis.pixel, dq / plane.height, plane.steepest), `${stepOf(i)}…`), () => remove("widgets", i));
    return part;
  }
  /** The four sides of the chosen widget. */
  const grips = [["value", 0], ["value", 1], ["magnitude", 0], ["magnitude", 1]].map(([key, which]) => {
    const grip = el(`div.grip.${key}`, { role: "slider", tabIndex: 0, hidden: true }, el("i")), i = () => chosen.widgets;
    const to = (px) => (key === "value" ? plane.value(px) : plane.magnitude(px)), whole = () => (key === "value" ? range() : plane.steepest), from = () => (key === "value" ? plane.x : plane.y)(list("widgets")[i()][key][which]);
    draggable(grip, store, () => stepOf(i()), () => ({ widget: list("widgets")[i()], px: from() }), ({ widget, px }, dx, dy) => change(i(), resized(widget, key, which, to(px + (key === "value" ? dx : dy)), whole())));
    keys(grip, (x, y) => change(i(), resized(list("widgets")[i()], key, which, to(from() + (key === "value" ? x || y : -(x || y))), whole()), `${stepOf(i())}…`), () => remove("widgets", i()));
    return Object.assign(grip, { key, which });
  });
  function bendPart(i) {
    const part = el("div.point", { role: "slider", tabIndex: 0, "aria-label": w.point, "aria-valuemin": "0", "aria-valuemax": "1" }, el("i"));
    const by = (point, dx, dy, label) => put(label, "gradient_opacity", bent(list("gradient_opacity"), i, plane.magnitude(plane.y(point.magnitude) + dy), point.opacity + dx / sideWidth()));
    draggable(part, store, w.curve, () => (choose("gradient_opacity", i), part.focus({ preventScroll: true }), list("gradient_opacity")[i]), (from, dx, dy) => by(from, dx, dy, w.curve));
    part.addEventListener("focus", () => chosen.gradient_opacity !== i && choose("gradient_opacity", i));
    keys(part, (x, y) => by(list("gradient_opacity")[i], x, -y, `${w.curve}…`), () => remove("gradient_opacity", i));
    return part;
  }

  plot.addEventListener("wheel", (event) => {
    event.preventDefault();
    axis.zoom(axis.x(plane.value(local(event)[0])), 1.0015 ** event.deltaY);
    store.redraw();
  }, { passive: false });
  plot.addEventListener("pointermove", (event) => ((hover = event.pointerType === "mouse" && !event.buttons ? local(event) : null), store.redraw()));
  plot.addEventListener("pointerleave", () => ((hover = null), store.redraw()));

  /** Asks for the histogram of the volume that is shown, once. */
  async function count() {
    const of = app.volume, way = app.link.connections;
    if (toldOf === of || !app.link.open || asked?.of === of && asked.way === way) return;
    let picture = null;
    const job = app.link.ask("gradients", {}, (m, data) => data ? (picture = data) : (waiting.textContent = `${w.counting} ${Math.round(100 * m.fraction)} %`));
    asked = { of, way, id: job.id };
    (waiting.textContent = w.counting), (waiting.hidden = false);
    try {
      const answer = await job, found = picture && (await shadesOf(picture));
      if (app.volume === of) (told = answer), (shades = found), (toldOf = of);
    } catch (error) {
      if (error.code !== "lost" && error.code !== "interrupted") app.fault(error);
    }
    if (asked?.id === job.id) (asked = null), (waiting.hidden = true);
    store.redraw();
  }
  /** Closed it is gone, or where something is shown by it, a line that says so. */
  function toggle(to = !open) {
    open = to;
    if (!open && asked) app.link.cancel(asked.id);
    store.redraw();
    if (open) requestAnimationFrame(() => requestAnimationFrame(() => root.scrollIntoView({ block: "nearest" })));
  }

  const parts = { widgets: [], gradient_opacity: [] };
  const fit = (key, make) => {
    const all = parts[key], { length } = list(key);
    while (all.length > length) all.pop().remove();
    while (all.length < length) layer.insertBefore(all[all.push(make(all.length)) - 1], key === "widgets" ? grips[0] : null);
    if (chosen[key] >= length) chosen[key] = -1;
  };
  layer.append(...grips);
  const rows = makeGradientRows(app, { list, put, change, remove, addShape: (shape) => ((lastShape = shape), addShape(shape)), addCurve, chosen, plane, unit, nameOf, stepOf });
  body.append(waiting, rows.root);

  function draw(state) {
    const has = Boolean(state.tf.rest.widgets || state.tf.rest.gradient_opacity);
    if (has && !had) open = true; // a function that came with shapes: they are shown
    had = has;
    const curve = list("gradient_opacity"), widgets = list("widgets");
    root.hidden = !open && !has;
    body.hidden = !open;
    const does = `${open ? w.close : w.open}: ${w.title}`;
    if (close.title !== does) (close.title = does), close.setAttribute("aria-label", does), close.replaceChildren(icon(open ? "close" : "right"));
    close.setAttribute("aria-expanded", String(open));
    readout.textContent = w.says(widgets.length, curve.length);
    if (!open || !app.volume) return;
    count();
    plane.view = axis.view;
    plane.width = canvas.clientWidth - plane.left - 3 - (curve.length ? strip : 0);
    plane.height = canvas.clientHeight - plane.top - 20;
    if (!store.dragging) plane.steepest = Math.max(toldOf === app.volume ? told.steepest : 0, ...widgets.map((one) => one.magnitude[1]), ...curve.map((p) => p.magnitude)) || 1;
    fit("widgets", shapePart), fit("gradient_opacity", bendPart);
    const box = (part, x, y, width, height) => (part.style.cssText = `transform:translate(${x}px,${y}px);width:${width}px;height:${height}px`);
    const floor = plane.top + plane.height, right = plane.left + plane.width;
    box(ground, plane.left, plane.top, plane.width, plane.height);
    side.hidden = !curve.length;
    box(side, sideLeft(), plane.top, sideWidth(), plane.height);
    widgets.forEach((widget, i) => {
      const part = parts.widgets[i], [x0, x1] = widget.value.map((v) => clamp(plane.x(v), plane.left, right)), [y1, y0] = widget.magnitude.map(plane.y), wide = Math.max(24, x1 - x0), high = Math.max(24, y1 - y0);
      box(part, (x0 + x1 - wide) / 2, (y0 + y1 - high) / 2, wide, high);
      part.hidden = x1 <= x0;
      part.classList.toggle("chosen", chosen.widgets === i);
      part.setAttribute("aria-label", nameOf(i));
      tell(part, (widget.value[0] + widget.value[1]) / 2, w.shapeText(words.range(...widget.value), `${words.range(...widget.magnitude)} ${unit()}`, short(widget.opacity, 3)));
    });
    const own = widgets[chosen.widgets];
    for (const grip of grips) {
      grip.hidden = !own;
      if (!own) continue;
      const [x0, x1] = own.value.map(plane.x), [y1, y0] = own.magnitude.map(plane.y), is = grip.key === "value";
      const x = is ? (grip.which ? x1 : x0) : (x0 + x1) / 2, y = is ? (own.shape === "triangle" ? y0 : (y0 + y1) / 2) : grip.which ? y0 : y1;
      grip.hidden = x < plane.left - 1 || x > right + 1;
      grip.style.transform = `translate(${x}px,${clamp(y, plane.top, floor)}px)`;
      grip.setAttribute("aria-label", w.sideOf(nameOf(chosen.widgets), w.sides[grip.key][grip.which]));
      tell(grip, own[grip.key][grip.which], is ? app.withUnit(own.value[grip.which]) : gradientText(own.magnitude[grip.which]));
    }
    curve.forEach((p, i) => {
      const part = parts.gradient_opacity[i];
      part.style.transform = `translate(${sideLeft() + p.opacity * sideWidth()}px,${plane.y(p.magnitude)}px)`;
      part.style.setProperty("--own", hex([0.6, 0.6, 0.6]));
      part.classList.toggle("chosen", chosen.gradient_opacity === i);
      tell(part, p.opacity, w.pointText(short(p.opacity, 3), gradientText(p.magnitude)));
    });
    const colourAt = (value) => hex(at(state.tf.stops, value, "rgb"));
    drawPlane(canvas, plane, { widgets, curve: curve.length ? { points: curve, left: sideLeft(), width: sideWidth(), at: curveAt } : null, chosen: chosen.widgets, colourAt, shades, told, look: app.theme.colours() });
    if (hover && hover[0] >= plane.left && hover[0] <= right && hover[1] <= floor) readout.textContent = `${app.withUnit(plane.value(hover[0]))}, ${gradientText(plane.magnitude(hover[1]))}`;
    rows.show(["dvr", "additive"].includes(read(state, "mode") ?? "dvr"));
  }
  section.insertBefore(root, section.querySelector(".chips"));
  store.watch(draw, { camera: false });
  store.redraw();
  return { root, toggle };
}
