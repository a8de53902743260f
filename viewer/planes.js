// Cut on the picture: a plane has a handle that pulls it along its normal and a rim that tilts it; faces of the box are pulled.
import { add, cross, dot, project, ray, unit } from "./camera.js";
import { draggable } from "./rows.js";
import { arrow, clamp, el, svg, tell } from "./dom.js";
import { read, write } from "./scene.js";
import { words } from "./texts.js";

const steps = [...Array(129).keys()].map((i) => (i * Math.PI) / 64);
const around = ({ u, v }, t) => add(u.map((c) => c * Math.cos(t)), v, Math.sin(t));

/** A plane's unit normal, its point nearest to the box's centre (mm) and two axes within it. @param {number[]} plane [nx, ny, nz, d] */
export function frameOf([x, y, z, d], box) {
  const length = Math.hypot(x, y, z) || 1, normal = [x, y, z].map((c) => c / length), at = add(box.centre, normal, d / length - dot(normal, box.centre));
  const u = unit(cross(normal, Math.abs(normal[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
  return { normal, at, u, v: cross(normal, u) };
}

/** The plane turned about its point so that the direction `from`, which lies in it, comes to lie along `to`: the smallest
 * rotation between the two, n' = n - (n·to) / (1 + from·to) (from + to). */
export function tilted({ normal, at }, from, to) {
  const n = unit(add(normal, add(from, to), -dot(normal, to) / Math.max(1 + dot(from, to), 1e-6)));
  return [...n, dot(n, at)];
}

/** Where the pointer's ray meets the sphere that a rim turns on, the meeting that is nearer to `last`; beside the sphere its nearest point. */
export function onSphere({ from, along }, at, radius, last) {
  const d = unit(along), to = add(at, from, -1), near = dot(to, d), aside = add(add(from, d, near), at, -1), h = Math.sqrt(Math.max(radius * radius - dot(aside, aside), 0));
  const [a, b] = [-h, h].map((t) => unit(add(aside, d, t)));
  return dot(a, last) >= dot(b, last) ? a : b;
}

/** Millimetres along a direction that a drag of (dx, dy) pixels asks for; of one that points at the eye, upwards. */
export function pulled(view, direction, at, dx, dy, height) {
  const depth = view.perspective ? dot(add(at, view.eye, -1), view.forward) : 1, size = (2 * view.half * depth) / height;
  const u = dot(direction, view.right), v = -dot(direction, view.up), seen = u * u + v * v;
  return seen < 0.04 ? -dy * size : (dx * u + dy * v) * (size / seen);
}

export function makePlanes(app, stage) {
  const { store } = app, drawn = svg("svg"), layer = el("div.planes", { hidden: true }, drawn);
  const planes = () => read(store.state, "clip.planes") ?? [];
  const put = (i, plane, more = "") => store.set(words.cut + more, (s) => write(s, "clip.planes", planes().map((p, k) => (k === i ? plane : p))));
  const move = (i, { normal, at }, by, more) => put(i, [...normal, dot(normal, at) + by], more);
  const radius = () => app.box.radius * 0.75;

  function handle(i) {
    const frame = () => frameOf(planes()[i], app.box);
    const made = el("button", { role: "slider", "aria-label": `${words.plane} ${i + 1}`, title: words.planeTip });
    draggable(made, store, words.cut, () => ({ frame: frame(), view: app.view() }), (start, dx, dy) => move(i, start.frame, pulled(start.view, start.frame.normal, start.frame.at, dx, dy, stage.clientHeight)));
    made.addEventListener("keydown", (event) => {
      const step = arrow(event), now = frame();
      if (!step) return;
      event.preventDefault();
      event.stopPropagation();
      // Arrows move it; with Shift they tilt it, 5° about either axis.
      const axis = event.key === "ArrowUp" || event.key === "ArrowDown" ? now.u : now.v, angle = (step * Math.PI) / 36;
      if (event.shiftKey) put(i, tilted(now, axis, add(axis.map((c) => c * Math.cos(angle)), now.normal, Math.sin(angle))), "…");
      else move(i, now, (step * app.box.radius) / 100, "…");
    });
    return made;
  }
  /** What a drag from (x, y) does: tilts the plane whose rim is within `reach` pixels, pulls a face of the box, or nothing (null). */
  function grab(x, y, reach) {
    const view = app.view(), size = [stage.clientWidth, stage.clientHeight];
    for (const [i, plane] of (layer.hidden ? [] : planes()).entries()) {
      const frame = frameOf(plane, app.box), distance = (r) => Math.hypot(...project(view, add(frame.at, r, radius()), ...size).map((c, k) => c - [x, y][k]));
      const grabbed = steps.map((t) => around(frame, t)).reduce((a, b) => (distance(b) < distance(a) ? b : a));
      let last = grabbed;
      if (distance(grabbed) <= reach) return (_, dx, dy) => put(i, tilted(frame, grabbed, (last = onSphere(ray(view, x + dx, y + dy, ...size), frame.at, radius(), last))));
    }
    return pull(x, y);
  }
  /** Of a press on the cut box: the drag that pulls the face there along its normal. */
  function pull(x, y) {
    const view = app.view(), r = ray(view, x, y, stage.clientWidth, stage.clientHeight), box = read(store.state, "clip.box") ?? [0, 1, 0, 1, 0, 1];
    let face = null, near = -Infinity, far = Infinity;
    app.box.axes.forEach((axis, k) => {
      const l2 = dot(axis, axis) || 1, from = dot(add(r.from, app.box.origin, -1), axis) / l2, along = dot(r.along, axis) / l2;
      if (Math.abs(along) < 1e-12) return void (from < box[2 * k] || from > box[2 * k + 1] ? (far = -Infinity) : 0);
      const t = [(box[2 * k] - from) / along, (box[2 * k + 1] - from) / along], first = t[0] < t[1] ? 0 : 1;
      if (t[first] > near) (near = t[first]), (face = 2 * k + first);
      far = Math.min(far, t[1 - first]);
    });
    if (face === null || near > far) return null;
    const axis = app.box.axes[face >> 1], length = Math.hypot(...axis) || 1, hit = add(r.from, r.along, near);
    return (_, dx, dy) => {
      const by = pulled(view, axis.map((c) => c / length), hit, dx, dy, stage.clientHeight) / length, next = [...box];
      next[face] = clamp(box[face] + by, face % 2 ? box[face - 1] + 0.01 : 0, face % 2 ? 1 : box[face + 1] - 0.01);
      store.set(words.cut, (s) => write(s, "clip.box", next.every((c, i) => c === i % 2) ? null : next));
    };
  }

  let handles = [], rims = [];
  store.watch(() => {
    layer.hidden = !app.volume || app.ui.tool !== "cut" || !planes().length;
    if (layer.hidden) return;
    if (handles.length !== planes().length) {
      handles = planes().map((_, i) => handle(i));
      rims = planes().map(() => svg("path"));
      drawn.replaceChildren(...rims);
      layer.replaceChildren(drawn, ...handles);
    }
    const view = app.view(), on = (point) => project(view, point, stage.clientWidth, stage.clientHeight).map((x) => x.toFixed(1));
    planes().forEach((plane, i) => {
      const frame = frameOf(plane, app.box), { at, normal } = frame, [x, y] = on(at);
      rims[i].setAttribute("d", `M${steps.map((t) => on(add(at, around(frame, t), radius())).join(" ")).join("L")}`);
      handles[i].style.transform = `translate(${x}px, ${y}px)`;
      tell(handles[i], dot(normal, at).toFixed(2), `${dot(normal, at).toFixed(2)} mm, ${normal.map((c) => c.toFixed(2)).join(" ")}`);
    });
  });
  stage.append(layer);
  return grab;
}
