// Measuring and notes: places marks on slices and on the volume, draws them, and moves their points. Loaded when first used.
import { add, dot, project, ray } from "./camera.js";
import { download, el, svg } from "./dom.js";
import { draggable } from "./rows.js";
import { angleOf, csvOf, isRegion, kinds, lengthOf, linesOf, pointsOf, regionOf, saysOf } from "./mark-shapes.js";
import { makeMarkRows } from "./mark-rows.js";
import { pixelToWorld, worldToPixel } from "./slice-geometry.js";
import { styled } from "./styles.js";
import { markWords } from "./part-texts.js";

const w = markWords;

export async function makeMarks(app) {
  await styled("marks.css");
  const { store, ui, stage } = app, list = () => store.state.marks ?? [];
  const put = (label, next) => store.set(label, () => ({ marks: next }));
  const units = () => ({ length: app.unitOfLength(), value: app.volume.unit, mean: w.mean.toLowerCase(), frame: app.volume.world });
  let kind = "distance", draft = null, pointer = null, pressed = null, selected = -1, chain = Promise.resolve(), told = new Map();
  let reach = Number(localStorage.getItem("snap") ?? 3);

  // What is drawn on: a slice, or the volume.
  const onPane = (view) => ({ at: (p) => worldToPixel(view, p), width: view.w, mm: () => view.s, away: (p) => dot(add(p, view.middle, -1), view.section.normal), half: 0.5 * Math.hypot(...view.section.step) + 1e-9,
    moved: (p, dx, dy) => add(add(p, view.section.right, dx * view.s), view.section.down, dy * view.s), normal: view.section.normal });
  function onVolume(width = stage.clientWidth, height = stage.clientHeight) {
    const view = app.view(), mm = (p) => (2 * view.half * (view.perspective ? Math.max(dot(add(p, view.eye, -1), view.forward), 1e-9) : 1)) / height;
    return { at: (p) => project(view, p, width, height), width, mm, away: () => 0, half: 1, moved: (p, dx, dy) => add(add(p, view.right, dx * mm(p)), view.up, -dy * mm(p)), normal: null };
  }

  // What the server says of regions and lines, asked once for each.
  function ask(key, type, request, take) {
    if (!told.has(key) && !store.dragging) {
      told.set(key, undefined);
      app.link.ask(type, request).then(take, (error) => ({ sentence: error.sentence ?? "" })).then((answer) => (answer.sentence === "" ? told.delete(key) : told.set(key, answer), store.redraw()));
    }
    return told.get(key);
  }
  const region = (mark) => isRegion(mark) && ask(JSON.stringify(regionOf(mark)), "region", regionOf(mark), (answer) => answer);
  /** Values along a line, half a voxel apart. */
  function profile({ points: [a, b] }) {
    const along = add(b, a, -1), n = Math.min(2000, Math.max(2, Math.ceil((2 * Math.hypot(...along)) / Math.min(...app.volume.spacing_mm)) + 1)), step = along.map((c) => c / (n - 1));
    const down = Math.abs(step[0]) > Math.abs(step[1]) ? [0, 1, 0] : [1, 0, 0];
    return ask(`profile ${JSON.stringify([a, b])}`, "slice", { plane: { centre: add(a, along, 0.5), right: step, down }, size: [n, 1], sampling: "linear", values: true }, ({ values }) => ({ values, step: Math.hypot(...step) }));
  }
  const nameOf = (mark, i) => mark.text || `${w.kinds[mark.kind]} ${list().slice(0, i + 1).filter((m) => m.kind === mark.kind).length}`;

  // Placing.
  async function snapped(point, reach_mm, normal) {
    if (!reach || !reach_mm || ["text", "ball", "box"].includes(kind)) return point;
    const answer = await app.link.ask("snap", { at: point, reach_mm, normal }).catch(() => null);
    return answer?.hit ? answer.at : point;
  }
  /** Of a path the second press of two at one place, with a mouse or a finger. */
  let lastPress = { x: 0, y: 0, at: 0 };
  function isDouble(x, y) {
    const was = lastPress;
    lastPress = { x, y, at: performance.now() };
    return kind === "polyline" && lastPress.at - was.at < 400 && Math.hypot(x - was.x, y - was.y) < 6;
  }
  /** @param {number[]} point @param {{mm: number, least?: number, normal?: any, step?: any}} where */
  const place = (point, where) => (chain = chain.then(async () => {
    const at = await snapped(point, Math.max(reach * where.mm, where.least ?? 0), where.normal ?? null);
    draft ??= { kind, points: [], mm: where.mm, step: where.step };
    draft.points.push(at);
    draft.points.length >= pointsOf[draft.kind][1] ? finish() : store.redraw();
  }));
  function finish() {
    if (!draft) return;
    const { kind: made, points, mm, step } = draft;
    draft = pointer = null;
    // A double click ends a polyline: its second press is not another point.
    const apart = points.filter((p, i) => !i || Math.hypot(...add(p, points[i - 1], -1)) > (made === "polyline" ? 3 * mm : 1e-12));
    if (apart.length < pointsOf[made][0]) return store.redraw();
    // A box that is drawn on a slice is as thick as that slice.
    const whole = made === "box" && step ? [add(apart[0], step, -0.5), add(apart[1], step, 0.5)] : apart;
    selected = list().length;
    put(w.added(w.kinds[made]), [...list(), { kind: made, points: whole }]);
    rows.made();
  }
  const cancel = () => (draft = pointer = pressed = null, store.redraw());
  const api = {
    list, region, profile, nameOf, units, kinds,
    get kind() { return kind; }, set kind(k) { (kind = k), (selected = -1), cancel(); },
    get selected() { return Math.min(selected, list().length - 1); },
    /** The slices go where it is. */
    select(i) {
      selected = i === selected ? -1 : i;
      const points = list()[selected]?.points;
      if (points && app.slices && app.slices.layout() !== "volume") app.slices.moveTo(points.reduce((sum, p) => add(sum, p, 1 / points.length), [0, 0, 0]));
      store.redraw();
    },
    get reach() { return reach; }, set reach(px) { (reach = px), localStorage.setItem("snap", String(px)), store.redraw(); },
    says: (mark) => saysOf(mark, region(mark), units()),
    change: (i, changes, label = w.changed) => put(label, list().map((m, k) => (k === i ? { ...m, ...changes } : m))),
    remove: (i) => ((selected = -1), put(w.removed, list().filter((_, k) => k !== i))),
    clear: () => ((selected = -1), put(w.removed, [])),
    atCrosshair: () => place(app.slices?.at() ?? app.box.centre, { mm: 0 }),
    csv: () => download(new Blob([csvOf(list().map((mark) => ({ mark, region: region(mark) })), { ...units(), names: nameOf })], { type: "text/csv" }), w.file),
    get busy() { return ui.tool === "measure"; },
    get draft() { return draft; },
    end: () => ui.tool === "measure" && (chain.then(() => draft?.kind === "polyline" && finish()), true),
    open: () => ((told = new Map()), (selected = -1), cancel(), rows.open()),
    /** A press on a slice: the first point; a drag from it places the second. */
    pressOn({ view, x, y }) {
      if (ui.tool !== "measure") return null;
      if (isDouble(x, y)) return api.end(), () => {};
      const where = { mm: view.s, normal: view.section.normal, step: view.section.step };
      pressed = { where, moved: false, at: null };
      place(pixelToWorld(view, x, y), where);
      return (e, dx, dy) => {
        if (!pressed) return;
        pressed.moved ||= Math.hypot(dx, dy) > 6;
        pointer = pressed.at = pixelToWorld(view, x + dx, y + dy);
        store.redraw();
      };
    },
    release() {
      if (pressed?.moved && pointsOf[kind][1] > 1) place(pressed.at, pressed.where);
      pressed = null;
    },
    /** A second finger: the first one's press was no point. */
    unpress() {
      if (!pressed) return;
      pressed = null;
      chain = chain.then(() => (draft?.points.pop(), draft?.points.length || (draft = null), store.redraw()));
    },
    hover({ view, x, y }) {
      if (draft) (pointer = pixelToWorld(view, x, y)), store.redraw();
    },
    hoverVolume(x, y) {
      if (!draft?.points.length) return;
      const on = onVolume(), last = draft.points.at(-1), from = on.at(last);
      pointer = on.moved(last, x - from[0], y - from[1]);
      store.redraw();
    },
    clicked(x, y, seen) {
      if (isDouble(x, y)) return api.end();
      if (!seen) return app.states.say(w.nothingThere);
      place(seen.world_mm, { mm: onVolume().mm(seen.world_mm), least: 2 * Math.min(...app.volume.spacing_mm) });
    },
    key(event) {
      if (ui.tool !== "measure") return false;
      if (event.key === " ") return api.atCrosshair(), true;
      if (event.key === "Enter") return api.end();
      if (event.key === "Backspace") return api.unpress(), draft?.points.pop(), draft?.points.length || (draft = null), store.redraw(), true;
      return false;
    },
  };
  addEventListener("keydown", (event) => {
    if (ui.tool !== "measure" || /^(input|select|textarea)$/i.test(event.target.tagName)) return;
    if (event.key === "Escape" && draft) event.preventDefault(), cancel();
    if (event.key === "Enter" && draft?.kind === "polyline" && !event.target.closest?.(".pane, button")) api.end();
  }, true);

  // Drawing: SVG on the page, a canvas in saved figures, of the same lines.
  const shown = () => [...list().map((mark, i) => ({ mark, i, says: saysOf(mark, region(mark), units()) })), ...(draft ? [{ mark: { kind: draft.kind, points: pointer && draft.points.length < pointsOf[draft.kind][1] ? [...draft.points, pointer] : draft.points }, i: -1 }] : [])]
    .map((one) => (one.i < 0 && !isRegion(one.mark) && !(one.mark.kind === "angle" && one.mark.points.length < 3) ? { ...one, says: saysOf(one.mark, null, units()) } : one));
  const drawOn = (on) => svg("g", { class: "marks" }, ...shown().flatMap(({ mark, i, says }) => {
    const { parts, within } = linesOf(mark, on, i >= 0 && (mark.kind === "text" || mark.kind === "arrow") ? "" : says ?? "", app.volume);
    return [svg("g", { class: `${i === api.selected ? "chosen" : ""} ${within ? "" : "away"}` }, ...parts.map(({ line, circle, r, text, at, left }) => {
      if (text) return svg("text", { x: at[0].toFixed(1), y: at[1].toFixed(1), "text-anchor": left ? "end" : "start" }, text);
      if (circle) return svg("circle", { cx: circle[0].toFixed(1), cy: circle[1].toFixed(1), r: r.toFixed(1) });
      return svg("path", { d: `M${line.map((p) => p.map((c) => c.toFixed(1)).join(" ")).join("L")}` });
    }), ...(mark.kind === "text" ? [] : mark.points.map(on.at).map(([x, y]) => svg("circle", { cx: x.toFixed(1), cy: y.toFixed(1), r: 2.5, class: "end" }))))];
  }));
  /** What a figure of w × h pixels carries: {x, y, width, height} in its pixels and draw(g). */
  api.figure = (width, height, ratio) => {
    const on = onVolume(width, height), all = list().map((mark) => linesOf(mark, on, mark.kind === "text" || mark.kind === "arrow" ? "" : api.says(mark), app.volume).parts);
    return figureOf(all.flat(), width, height, ratio);
  };

  /** The same of a slice, where it meets them. */
  api.figureOn = (view, ratio) => {
    const on = onPane(view), all = list().map((mark) => linesOf(mark, on, mark.kind === "text" || mark.kind === "arrow" ? "" : api.says(mark), app.volume)).filter((one) => one.within).flatMap((one) => one.parts), k = (p) => p.map((c) => c * ratio);
    return figureOf(all.map((p) => (p.line ? { line: p.line.map(k) } : p.circle ? { circle: k(p.circle), r: p.r * ratio } : { ...p, at: k(p.at) })), view.w * ratio, view.h * ratio, ratio);
  };

  /** The points of the chosen mark, to be dragged or moved by arrow keys. */
  function makeHandles(host, surface) {
    const layer = el("div.mark-handles"), one = (k) => {
      const handle = el("button.mark-point", { type: "button" }), i = () => api.selected, point = () => list()[i()]?.points[k];
      const moved = (p) => list()[i()].points.map((q, n) => (n === k ? p : q)), move = (p) => api.change(i(), { points: moved(p) }, `${w.moved}…`);
      let far = false;
      draggable(handle, store, w.moved, () => ((far = false), { p: point(), on: surface() }), (start, dx, dy) => {
        far ||= Math.hypot(dx, dy) > 3;
        if (far) move(start.on.moved(start.p, dx, dy));
      });
      handle.addEventListener("pointerup", async () => {
        const mark = list()[i()], on = surface(), p = point();
        // A click on a point while a mark is being placed: that goes on there. It begins no other: a click is a small drag, too.
        if (!far) return void (draft && place(p, { mm: 0 }));
        if (!mark || !reach || isRegion(mark) || mark.kind === "text") return;
        const answer = await app.link.ask("snap", { at: p, reach_mm: reach * on.mm(p), normal: on.normal }).catch(() => null);
        if (answer?.hit && list()[i()] === mark) store.amend({ marks: list().map((m) => (m === mark ? { ...m, points: moved(answer.at) } : m)) });
      });
      handle.addEventListener("keydown", (event) => {
        const [dx, dy] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key] ?? [0, 0], on = surface();
        if (event.key === "Delete") api.remove(i());
        else if (dx || dy) move(on.moved(point(), ...[dx, dy].map((d) => (d * (event.shiftKey ? 0.1 : 1) * Math.min(...app.volume.spacing_mm)) / on.mm(point()))));
        else return;
        event.preventDefault();
        event.stopPropagation();
      });
      return handle;
    };
    host.append(layer);
    return () => {
      const mark = list()[api.selected], count = mark?.points.length ?? 0, on = surface();
      if (layer.children.length !== count) layer.replaceChildren(...[...Array(count).keys()].map(one));
      [...layer.children].forEach((handle, k) => {
        const [x, y] = on.at(mark.points[k]);
        handle.style.transform = `translate(${x}px, ${y}px)`;
        handle.hidden = Math.abs(on.away(mark.points[k])) > Math.max(on.half, isRegion(mark) ? 1e9 : 0);
        handle.setAttribute("aria-label", w.pointOf(api.nameOf(mark, api.selected), k + 1));
      });
    };
  }
  const lines = svg("svg", { "aria-hidden": "true" }), layer = el("div.planes.mark-layer", {}, lines), paneHandles = new Map();
  stage.append(layer);
  const handles = makeHandles(stage, () => onVolume());
  api.drawPane = (i, view, into) => {
    into.append(drawOn(onPane(view)));
    if (!paneHandles.has(i)) paneHandles.set(i, makeHandles(app.slices.panes[i].picture, () => onPane(app.slices.panes[i].view())));
    paneHandles.get(i)();
  };
  stage.addEventListener("pointermove", (event) => event.buttons || (ui.tool === "measure" && api.hoverVolume(event.clientX - stage.getBoundingClientRect().left, event.clientY - stage.getBoundingClientRect().top)));

  const rows = makeMarkRows(app, api);
  api.rows = rows.root;
  store.watch(() => {
    if (!app.volume) return;
    rows.root.hidden = ui.tool !== "measure" && !list().length;
    if (!rows.root.hidden) rows.show();
    layer.hidden = Boolean(app.compare.on);
    lines.replaceChildren(drawOn(onVolume()));
    handles();
  });
  return api;
}

/** Lines and texts, in a picture's pixels, as one piece with a margin: white over a dark rim. */
function figureOf(parts, width, height, ratio) {
  const points = parts.flatMap((p) => (p.text ? [p.at, [p.at[0] + (p.left ? -9 : 9) * p.text.length * ratio, p.at[1] - 16 * ratio]] : p.circle ? [[p.circle[0] - p.r, p.circle[1] - p.r], [p.circle[0] + p.r, p.circle[1] + p.r]] : p.line));
  if (!points.length) return null;
  const edge = 8 * ratio, range = (k, most) => [Math.max(0, Math.floor(Math.min(...points.map((p) => p[k])) - edge)), Math.min(most, Math.ceil(Math.max(...points.map((p) => p[k])) + edge))];
  const [x, x1] = range(0, width), [y, y1] = range(1, height);
  if (x1 <= x || y1 <= y) return null;
  const draw = (g) => {
    const path = (p) => {
      g.beginPath();
      if (p.circle) g.arc(p.circle[0] - x, p.circle[1] - y, p.r, 0, 7);
      else p.line.forEach((q, i) => (i ? g.lineTo : g.moveTo).call(g, q[0] - x, q[1] - y));
      g.stroke();
    };
    g.font = `600 ${13 * ratio}px ${getComputedStyle(document.body).fontFamily}`;
    Object.assign(g, { lineJoin: "round", lineCap: "round" });
    for (const [colour, wide] of [["rgba(0,0,0,.75)", 4.5], ["#F2B84B", 2]]) {
      Object.assign(g, { strokeStyle: colour, lineWidth: wide * ratio });
      parts.filter((p) => !p.text).forEach(path);
    }
    Object.assign(g, { strokeStyle: "rgba(0,0,0,.8)", lineWidth: 3.5 * ratio, fillStyle: "#fff" });
    for (const p of parts.filter((p) => p.text)) (g.textAlign = p.left ? "right" : "left"), g.strokeText(p.text, p.at[0] - x, p.at[1] - y), g.fillText(p.text, p.at[0] - x, p.at[1] - y);
  };
  return { x, y, width: x1 - x, height: y1 - y, draw };
}
