// The pointer on the picture: orbit, pan, zoom, adjust, light, cut, window, density, and the read-out.
import { add, scaleOf, viewOf } from "./camera.js";
import { clamp, el, hex, icon, short } from "./dom.js";
import { inserted, moved, spanOf, stretched } from "./peaks.js";
import { method, read, write } from "./scene.js";
import { words } from "./texts.js";

const wrapped = (degrees) => ((((degrees + 180) % 360) + 360) % 360) - 180;

export function makeGestures(app, stage) {
  const { store, ui } = app;
  const camera = () => store.state.camera, cam = (key, otherwise) => camera()[`camera.${key}`] ?? otherwise;
  const setCamera = (changes, label = words.camera) => store.set(label, (s) => ({ camera: { ...s.camera, ...changes } }), "camera");
  const view = () => viewOf(camera(), app.box);
  const at = (event) => [event.clientX - stage.getBoundingClientRect().left, event.clientY - stage.getBoundingClientRect().top];
  const pick = (x, y) => app.link.ask("pick", { x: Math.round(x * devicePixelRatio), y: Math.round(y * devicePixelRatio) });

  const orbit = (start, dx, dy) => setCamera({ "camera.azimuth_deg": wrapped(start.azimuth - dx * 0.4), "camera.elevation_deg": clamp(start.elevation + dy * 0.4, -90, 90) });
  const pan = (start, dx, dy) => {
    const size = scaleOf(start.view, stage.clientHeight);
    setCamera({ "camera.target": add(add(start.view.target, start.view.right, -dx * size), start.view.up, dy * size) });
  };
  function zoom(factor, x, y) {
    const now = view(), fit = clamp(cam("fit_scale", 1) * factor, 0.001, 100), f = fit / cam("fit_scale", 1), size = scaleOf(now, stage.clientHeight);
    const point = add(add(now.target, now.right, (x - stage.clientWidth / 2) * size), now.up, (stage.clientHeight / 2 - y) * size);
    setCamera({ "camera.fit_scale": fit, "camera.target": add(point, add(now.target, point, -1), f) });
  }

  /** A drag of the window: right widens, up raises the centre, by 1/400 of it a pixel. */
  function window_(start, dx, dy) {
    const [lo, hi] = start.span, width = (hi - lo) * Math.max(0.01, dx >= 0 ? 1 + dx / 400 : 1 / (1 - dx / 400)), centre = (lo + hi) / 2 - (dy / 400) * (hi - lo);
    store.set(words.window, () => ({ tf: stretched(start.tf, [centre - width / 2, centre + width / 2]) }));
  }
  const density = (start, _dx, dy) => store.set(words.density, (s) => ({ tf: { ...s.tf, scale: clamp(start.tf.scale * 10 ** (-dy / 200), 0.01, 100) } }));

  function turnLight(start, dx, dy) {
    const probe = ["visibility", "reference", "transport"].includes(method(store.state));
    if (probe) return store.set(words.ball, (s) => write(s, "probe.rotation", wrapped(start.rotation + dx * 0.5)));
    store.set(words.keyLight[0], (s) => write(s, "shading.light", [wrapped(start.light[0] + dx * 0.5), clamp(start.light[1] - dy * 0.5, -90, 90), ...start.light.slice(2)]));
  }

  /** Adjust: the point of the value that is seen there follows the pointer. */
  function adjust(start, dx, dy) {
    if (!start.found) return;
    const { from, index } = start.found, dv = (dx * (start.span[1] - start.span[0])) / 400;
    app.graph.setPoints(start.label, moved(from, [index], dv, (o) => Math.max(o, 0.001) * 10 ** (-dy / 200)));
  }
  async function beginAdjust(start, x, y) {
    const seen = await pick(x, y).catch(() => null);
    if (!seen?.hit || start.over) return;
    const { points } = store.state.tf, close = (start.span[1] - start.span[0]) / 50;
    let index = points.findIndex((p) => p.opacity > 0 && Math.abs(p.value - seen.value) <= close), from = points;
    if (index < 0) ({ points: from, index } = inserted(points, { value: seen.value, opacity: seen.opacity }));
    start.found = { from, index };
    if (!start.pressed) take(start);
    showSeen(x, y, seen);
  }
  const take = ({ label, found: { from, index } }) => (app.graph.choose([index]), app.graph.setPoints(label, from));
  /** A finger that rests reads the value there; dragged on from there it adjusts. */
  function press(x, y) {
    if (!start || pointers.size !== 1) return;
    store.cancel();
    start = { ...start, pressed: true, move: (s, dx, dy) => s.found && Math.hypot(dx, dy) > 8 && (take(s), adjust(s, dx, dy), (s.move = adjust)) };
    store.begin(start.label);
    beginAdjust(start, x, y);
  }

  const pointers = new Map();
  let start = null, resting = 0;
  function begin(event) {
    const [x, y] = at(event), tool = ui.tool;
    const light = read(store.state, "shading.light");
    start = { x: event.clientX, y: event.clientY, azimuth: cam("azimuth_deg", 35), elevation: cam("elevation_deg", 25), view: view(), tf: store.state.tf, span: spanOf(store.state.tf),
      rotation: read(store.state, "probe.rotation") ?? 0, light: typeof light?.[0] === "number" ? light : [cam("azimuth_deg", 35), cam("elevation_deg", 25)], label: words.tools.adjust.split(":")[0], over: false };
    if (event.button === 2) (start.move = event.ctrlKey ? density : window_), (start.track = "design");
    else if (event.button === 1 || event.shiftKey) (start.move = pan), (start.track = "camera");
    else if (tool === "adjust") (start.move = adjust), (start.track = "design"), beginAdjust(start, x, y);
    else if (tool === "light") (start.move = turnLight), (start.track = "design");
    else if (tool === "cut" && (start.move = app.cutting(x, y, event.pointerType === "touch" ? 22 : 12))) start.track = "design";
    else (start.move = orbit), (start.track = "camera");
    store.begin({ [density.name]: words.density, [window_.name]: words.window, [adjust.name]: start.label, [turnLight.name]: words.light }[start.move.name] ?? (start.track === "camera" ? words.camera : words.cut), start.track);
  }
  stage.addEventListener("pointerdown", (event) => {
    if (event.target !== app.frame.canvas || !app.volume || app.wiping?.(event)) return;
    stage.focus({ preventScroll: true });
    hideSeen();
    stage.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    clearTimeout(resting);
    if (pointers.size === 1) {
      begin(event);
      if (event.pointerType === "touch") resting = setTimeout(press, 450, ...at(event));
    } else if (pointers.size === 2) {
      store.cancel();
      const [a, b] = [...pointers.values()];
      start = { pinch: { gap: Math.hypot(a[0] - b[0], a[1] - b[1]), middle: [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2] } };
      store.begin(words.camera, "camera");
    }
  });
  stage.addEventListener("pointermove", (event) => {
    if (!pointers.has(event.pointerId)) return event.pointerType === "mouse" && event.target === app.frame.canvas ? rest(...at(event)) : hideSeen();
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (start?.pinch && pointers.size === 2) {
      const [a, b] = [...pointers.values()], gap = Math.hypot(a[0] - b[0], a[1] - b[1]), middle = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], box = stage.getBoundingClientRect();
      pan({ view: view() }, middle[0] - start.pinch.middle[0], middle[1] - start.pinch.middle[1]);
      zoom(start.pinch.gap / Math.max(gap, 1), middle[0] - box.left, middle[1] - box.top);
      start.pinch = { gap, middle };
    } else if (start?.move) {
      if (Math.hypot(event.clientX - start.x, event.clientY - start.y) > 8) clearTimeout(resting);
      start.move(start, event.clientX - start.x, event.clientY - start.y);
    }
  });
  const up = (event) => {
    if (!pointers.delete(event.pointerId)) return;
    // A press that moved nothing is a click: the crosshair of the slices goes there.
    const isClick = event.type === "pointerup" && start && !start.pinch && start.move === orbit && Math.hypot(event.clientX - start.x, event.clientY - start.y) < 4;
    clearTimeout(resting);
    const start_pressed = Boolean(start?.pressed), read_ = start?.move !== adjust && start?.pressed; // stays until the next touch
    if (start) start.over = true;
    start = null;
    store.end();
    if (isClick && !start_pressed) app.clicked(...at(event));
    if (!read_) hideSeen();
  };
  for (const name of ["pointerup", "pointercancel"]) stage.addEventListener(name, up);
  addEventListener("keydown", (event) => event.key === "Escape" && start && ((start = null), store.cancel()));
  stage.addEventListener("contextmenu", (event) => event.preventDefault());
  let wheeling = 0;
  stage.addEventListener("wheel", (event) => {
    if (!app.volume || event.target !== app.frame.canvas) return;
    event.preventDefault();
    hideSeen();
    if (!wheeling && !store.dragging) store.begin(words.camera, "camera");
    clearTimeout(wheeling);
    wheeling = setTimeout(() => ((wheeling = 0), store.end()), 150);
    zoom(1.0015 ** clamp(event.deltaY, -300, 300), ...at(event));
  }, { passive: false });
  stage.addEventListener("dblclick", async (event) => {
    if (event.target !== app.frame.canvas || app.marks?.end()) return;
    const seen = await pick(...at(event)).catch(() => null);
    if (seen?.hit) fly({ "camera.target": seen.world_mm });
  });
  stage.addEventListener("keydown", (event) => {
    if (event.target !== stage || !app.volume || event.ctrlKey || event.altKey) return;
    const [dx, dy] = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key] ?? [0, 0];
    const factor = { "+": 0.9, "=": 0.9, "-": 1 / 0.9 }[event.key];
    if (factor) zoom(factor, stage.clientWidth / 2, stage.clientHeight / 2);
    else if (dx || dy) event.shiftKey ? pan({ view: view() }, 20 * dx, 20 * dy) : orbit({ azimuth: cam("azimuth_deg", 35), elevation: cam("elevation_deg", 25) }, 12.5 * dx, 12.5 * dy);
    else return;
    event.preventDefault();
  });

  /** Turns there in 250 ms; at once where motion is not wanted. */
  function fly(to, label = words.camera) {
    const from = { "camera.azimuth_deg": cam("azimuth_deg", 35), "camera.elevation_deg": cam("elevation_deg", 25), "camera.fit_scale": cam("fit_scale", 1), "camera.target": view().target };
    const began = performance.now(), still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const goal = Object.fromEntries(Object.entries(to).map(([key, v]) => [key, key === "camera.azimuth_deg" ? from[key] + wrapped(v - from[key]) : v]));
    store.begin(label, "camera");
    const step = () => {
      if (!store.dragging) return;
      const t = still ? 1 : Math.min(1, (performance.now() - began) / 250), s = t * t * (3 - 2 * t), mixed = (a, b) => (Array.isArray(a) ? a.map((x, i) => x + s * (b[i] - x)) : a + s * (b - a));
      setCamera(t === 1 ? to : Object.fromEntries(Object.entries(goal).map(([key, v]) => [key, v === null ? null : mixed(from[key], v)])), label);
      t < 1 ? requestAnimationFrame(step) : store.end();
    };
    step();
  }
  const fit = (what) => {
    const { "camera.target": _, "camera.fit_scale": __, "camera.fit_centre": ___, "camera.fit_radius": ____, ...rest } = camera();
    store.set(words.tools.fit, () => ({ camera: { ...rest, "camera.fit": what ?? cam("fit", "visible") } }), "camera");
  };

  // Resting: what is seen there, beside the pointer and as a tick in the graph.
  const seen = el("div.seen", { hidden: true });
  let timer = 0;
  function showSeen(x, y, found) {
    ui.seen = found.value;
    seen.hidden = false;
    seen.style.transform = `translate(${x}px, ${y}px)`;
    const box = el("div", {}, el("i.blob", { style: `--own:${hex(found.rgb)};position:static;margin:0;border:0;box-shadow:none;width:8px;height:8px` }), el("b", {}, app.withUnit(found.value)), el("span", {}, `${words.opacity.toLowerCase()} ${short(found.opacity, 3)}`));
    if (x > stage.clientWidth - 220) box.style.cssText = "left:auto;right:16px";
    seen.replaceChildren(el("i"), box);
    store.redraw();
  }
  function hideSeen() {
    clearTimeout(timer);
    if (seen.hidden) return;
    seen.hidden = true;
    ui.seen = undefined;
    store.redraw();
  }
  function rest(x, y) {
    hideSeen();
    if (app.marks?.draft) return; // whose number stands there
    timer = setTimeout(async () => {
      const asked = timer, found = await pick(x, y).catch(() => null);
      if (found?.hit && asked === timer && !pointers.size) showSeen(x, y, found);
    }, 150);
  }
  stage.addEventListener("pointerleave", hideSeen);

  const tools = el("div.float.tools", { role: "toolbar", "aria-label": "Tools" });
  const kinds = ["orbit", "adjust", "light", "cut", "measure"];
  const buttons = kinds.map((name) => el("button.tool", { title: `${words.tools[name]} (${name[0].toUpperCase()})`, "aria-label": words.tools[name], onclick: () => choose(name) }, icon(name)));
  tools.append(...buttons, el("hr"), el("button.tool", { title: `${words.tools.fit} (F)`, "aria-label": words.tools.fit, onclick: () => fit() }, icon("fit")),
    el("button.tool", { title: words.tools.panel, "aria-label": words.tools.panel, onclick: () => app.togglePanel() }, icon("panel")));
  function choose(name) {
    if (name === "measure") app.showTab("more"); // where its table is, on a phone
    ui.tool = name;
    store.redraw();
    buttons.forEach((button, i) => button.setAttribute("aria-pressed", String(kinds[i] === name)));
    stage.style.cursor = { orbit: "grab", adjust: "ns-resize", light: "move", cut: "crosshair", measure: "crosshair" }[name];
  }
  choose("orbit");
  stage.append(tools, seen);
  app.clicked = async (x, y) => {
    const measures = ui.tool === "measure" && app.marks;
    if (!measures && !app.embed && !app.labels && (!app.slices || app.slices.layout() === "volume")) return;
    const found = await pick(x, y).catch(() => null);
    if (measures) return app.marks.clicked(x, y, found?.hit ? found : null);
    if (!found?.hit) return;
    app.embed?.picked(found);
    app.labels?.clicked(found.world_mm);
    app.slices?.moveTo(found.world_mm);
  };
  return { choose, fly, fit, zoom };
}
