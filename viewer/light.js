// Light: the method, what one reaches for first, the mirror ball and its probes, and Accuracy.
import { arrow, bytes, chooseFile, el, icon, seconds, short, tell } from "./dom.js";
import { draggable, settingRow, sliderRow } from "./rows.js";
import { method, read, write } from "./scene.js";
import { fold } from "./sections.js";
import { keyOf, placed } from "./table.js";
import { words } from "./texts.js";

const withProbe = ["visibility", "reference", "transport"];

export function makeLight(app) {
  const { store } = app, body = el("div"), sentence = el("p.sentence");
  const eye = el("button.tool", { title: `${words.unlit} (B)`, "aria-label": words.unlit }, icon("eye"));
  const unlit = (on) => store.show(on ? { unlit: true } : null);
  for (const [name, on] of [["pointerdown", true], ["pointerup", false], ["pointerleave", false], ["blur", false]]) eye.addEventListener(name, () => (on || store.preview?.unlit) && unlit(on));
  eye.addEventListener("keydown", (e) => (e.key === " " || e.key === "Enter") && unlit(true));
  eye.addEventListener("keyup", () => unlit(false));
  const methods = el("div.segmented.methods", { role: "radiogroup", "aria-label": words.light });
  const section = el("section.section.s-light.open", {}, el("div.head", {}, el("h2", {}, words.light), el("div.tools-right", {}, eye)), methods, sentence, body);
  let rows = [], shownFor = null, ball = null;

  const set = (label, key, value) => store.set(label, (s) => write(s, key, value));
  const effects = () => String(read(store.state, "histogram:lighting.effects") ?? "ao,bleeding").split(",").filter(Boolean);
  function switches() {
    const box = el("div.switches", { role: "group", "aria-label": words.methods.histogram[0] });
    for (const [name, label] of Object.entries(words.effects)) box.append(el("button.chip.switch", { "data-effect": name, title: `${label}. --hist-effects`, onclick: () => {
      const now = effects(), next = Object.keys(words.effects).filter((e) => (e === name ? !now.includes(e) : now.includes(e)));
      if (!next.length) return;
      store.set(label, (s) => {
        const changed = { ...s, ...write(s, "histogram:lighting.effects", next.join(",")) };
        return next.includes("glow") && !read(changed, "histogram:lighting.glow") ? write(changed, "histogram:lighting.glow", glowText(...firstGlow(), 2)) : changed;
      });
    } }, label));
    return Object.assign(box, { show: () => box.querySelectorAll("button").forEach((b) => b.setAttribute("aria-pressed", String(effects().includes(b.dataset.effect)))) });
  }
  const firstGlow = () => [app.volume.percentiles["99"], Math.max(app.volume.range[1], app.volume.percentiles["99"])];
  const glowText = (lo, hi, strength) => `${lo}:${hi}=${strength}`;
  const glow = () => /^(.+):(.+)=(.+)$/.exec(String(read(store.state, "histogram:lighting.glow") ?? ""))?.slice(1).map(Number);
  app.glowNow = () => (method(store.state) === "histogram" && effects().includes("glow") ? glow()?.slice(0, 2) : undefined);
  const putGlow = (g) => set("Glow…", "histogram:lighting.glow", glowText(...g));
  app.setGlow = (range) => putGlow([...range, glow()[2]]);
  function glowRows() {
    const [low, high] = app.volume.range, now = () => glow() ?? [...firstGlow(), 2], put = putGlow;
    return [sliderRow(app, { label: words.glow[0], two: true, low, high, step: (high - low) / 255, value: () => now().slice(0, 2), change: ([a, b]) => put([a, b, now()[2]]) }),
      sliderRow(app, { label: words.glow[2], low: 1, high: 100, most: 1e6, step: 0.1, log: true, start: 1, value: () => now()[2], change: (v) => put([...now().slice(0, 2), v]) })];
  }

  function build(now) {
    shownFor = `${now}|${effects()}`;
    const parts = placed(app.hello.settings, "light", now).filter((s) => (s.key.startsWith("probe.") ? withProbe.includes(now) : s.flag === "strength" ? !["none", "reference"].includes(now) : s.flag !== "hist-anisotropy" || effects().includes("scattering")));
    const made = parts.map((s) => settingRow(app, s));
    const accuracy = placed(app.hello.settings, "accuracy", now), inner = accuracy.map((s) => settingRow(app, s));
    rows = [...made, ...inner];
    ball = null;
    if (now === "histogram") {
      const buttons = switches(), more = effects().includes("glow") ? glowRows() : [];
      rows.push(buttons, ...more);
      body.replaceChildren(buttons, ...made, ...more);
    } else if (withProbe.includes(now)) {
      ball = makeBall(app);
      const row = probeRow(app);
      rows.push(ball, row);
      body.replaceChildren(el("div.lamp", {}, ball, el("div", {}, ...made.slice(0, 3))), row, ...made.slice(3));
    } else body.replaceChildren(...made);
    if (now === "histogram") inner.push(cacheRow(app));
    if (inner.length) body.append(fold(words.accuracy, () => summary(accuracy), inner, "accuracy"));
  }
  const summary = (settings) => settings.filter((s) => read(store.state, keyOf(s)) !== null).slice(0, 2).map((s) => {
    const v = read(store.state, keyOf(s));
    return s.flag === "transport-grid" ? `grid ${v}` : s.label === "Grid" ? `grid 1:${v}` : s.flag === "sh-bands" ? `${v * v} coefficients` : typeof v === "number" ? `${short(v)} ${s.label.toLowerCase().replace("packed ", "")}` : (words.choices[v] ?? String(v)).toLowerCase();
  }).join(", ");

  /** Seconds that finding local histograms takes the first time: about 2.5 µs of a CPU for each voxel (docs/theory/histogram.md). */
  const preparing = () => (2.5e-6 * app.volume.dimensions.reduce((a, b) => a * b)) / app.hello.device.threads;

  function open() {
    shownFor = null;
    const names = app.hello.methods.map((m) => m.name).filter((name) => name in words.methods);
    methods.replaceChildren(...names.map((name) => el("button", { role: "radio", "data-method": name, title: `${words.methods[name][1]} ${words.methods[name][2]}. --lighting ${name}`, onclick: () => set(`${words.light}: ${words.methods[name][0]}`, "lighting.method", name) }, words.methods[name][0])));
    radios(methods);
  }
  store.watch((state) => {
    if (!app.volume) return;
    const now = method(state);
    for (const b of methods.children) b.setAttribute("aria-checked", String(b.dataset.method === now)), (b.tabIndex = b.dataset.method === now ? 0 : -1);
    sentence.textContent = now === "histogram" && preparing() > 2 ? words.prepares(seconds(preparing())) : (words.methods[now]?.[1] ?? "");
    if (shownFor !== `${now}|${effects()}`) build(now);
    rows.forEach((row) => row.show());
    section.querySelector(".fold")?.show();
  }, { camera: false });
  /** A step that needs an eighth of the memory for light, where the method has one. */
  function coarser() {
    const grid = placed(app.hello.settings, "accuracy", method(store.state)).find((s) => s.label === "Grid");
    if (!grid) return null;
    const key = keyOf(grid), now = Number(read(store.state, key)), next = grid.flag === "transport-grid" ? Math.round(now / 2) : now * 2, most = grid.flag === "transport-grid" ? next >= 16 : next <= 8;
    return most ? () => set(words.states.coarser, key, next) : null;
  }
  return { section, open, unlit, coarser };
}

/** Where local histograms are kept between runs, how much that is, and an end to it. */
function cacheRow(app) {
  const text = el("small"), ask = (clear) => app.link.ask("cache", { clear }).then(({ folder, bytes: size }) => (text.textContent = words.kept(folder, bytes(size)), clear && ask(false)), app.fault);
  const row = el("div.row.choice", { title: "--hist-cache" }, text, el("button", { onclick: () => ask(true) }, words.clear));
  ask(false);
  return row;
}

/** Arrow keys within a group of radio buttons. */
export function radios(group) {
  group.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key], all = [...group.children].filter((b) => b.role === "radio");
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    const next = all[(all.indexOf(document.activeElement) + step + all.length) % all.length];
    next.focus();
    next.click();
  });
}

// Probes: their equirectangular pictures come once from the server.
const pictures = new Map();
function picture(app, probe, done) {
  const key = JSON.stringify(probe);
  if (!pictures.has(key)) pictures.set(key, new Promise((take) => app.link.ask("probe", { probe, size: [128, 64] }, (_, data) => data && createImageBitmap(data).then((bitmap) => {
    const canvas = el("canvas", { width: bitmap.width, height: bitmap.height }), g = canvas.getContext("2d", { willReadFrequently: true });
    g.drawImage(bitmap, 0, 0);
    take(g.getImageData(0, 0, bitmap.width, bitmap.height));
  })).catch(() => (pictures.delete(key), take(null)))));
  pictures.get(key).then((p) => p && done(p));
}

/** The probe in a mirror ball that is seen from the camera's side: rotation turns what it shows. */
function mirror(canvas, { data, width, height }, turned) {
  const n = canvas.width, g = canvas.getContext("2d"), out = g.createImageData(n, n);
  for (let y = 0; y < n; ++y) for (let x = 0; x < n; ++x) {
    const u = (2 * x + 1) / n - 1, v = 1 - (2 * y + 1) / n, r2 = u * u + v * v;
    if (r2 >= 1) continue;
    // The normal (u, v, w) sends the view along -z to 2 w n - z; azimuth 0 is towards the viewer.
    const w = Math.sqrt(1 - r2), azimuth = Math.atan2(2 * w * u, 2 * w * w - 1) + turned;
    const s = (((0.5 - azimuth / (2 * Math.PI)) % 1) + 1) % 1, t = Math.acos(Math.max(-1, Math.min(1, 2 * w * v))) / Math.PI;
    const from = 4 * (Math.min(height - 1, Math.floor(t * height)) * width + Math.min(width - 1, Math.floor(s * width)));
    out.data.set(data.subarray(from, from + 4), 4 * (y * n + x));
  }
  g.putImageData(out, 0, 0);
}

const probeOf = (state) => (state.values["probe.file"] ? { file: state.values["probe.file"] } : { preset: state.values["probe.preset"] ?? "white" });

function makeBall(app) {
  const { store } = app, canvas = el("canvas", { width: 152, height: 152 }), rim = el("i");
  const turn = () => read(store.state, "probe.rotation") ?? 0, put = (v) => store.set(`${words.ball}…`, (s) => write(s, "probe.rotation", (((v % 360) + 360) % 360)));
  const ball = el("div.ball", { role: "slider", tabIndex: 0, "aria-label": words.ball, "aria-valuemin": "0", "aria-valuemax": "360", title: `${words.ball}. --probe-rotation` }, canvas, rim);
  draggable(ball, store, words.ball, turn, (start, dx) => put(Math.round(start + dx * 2)));
  ball.addEventListener("keydown", (e) => {
    const step = arrow(e);
    if (step) e.preventDefault(), e.stopPropagation(), put(turn() + step * (e.shiftKey ? 15 : 5));
  });
  return Object.assign(ball, { show() {
    const angle = ((turn() - 90) * Math.PI) / 180;
    rim.style.transform = `translate(${41 * Math.cos(angle)}px, ${41 * Math.sin(angle)}px)`;
    tell(ball, turn(), `${short(turn(), 3)}°`);
    picture(app, probeOf(store.state), (p) => mirror(canvas, p, (((store.state.camera["camera.azimuth_deg"] ?? 35) - turn()) * Math.PI) / 180));
  } });
}

function probeRow(app) {
  const { store } = app, row = el("div.probes", { role: "radiogroup", "aria-label": words.light });
  const take = (probe) => store.set(words.light, (s) => ({ values: { ...write({ ...s, ...write(s, "probe.file", probe.file ?? null) }, "probe.preset", probe.preset ?? null).values } }));
  const own = el("button", { title: words.ownProbe, "aria-label": words.ownProbe, onclick: () => chooseFile(".hdr,.exr", app.take) }, icon("plus"));
  const add = (probe, name) => {
    const canvas = el("canvas", { width: 72, height: 72 }), button = el("button", { role: "radio", title: `${name}. --probe`, "aria-label": name, onclick: () => take(probe) }, canvas);
    button.dataset.probe = JSON.stringify(probe);
    picture(app, probe, (p) => mirror(canvas, p, 0));
    return button;
  };
  row.append(...app.hello.probes.map((p) => add({ preset: p.name }, words.probes[p.name] ?? p.name)));
  if (app.ownProbe) row.append(add({ file: app.ownProbe }, app.ownProbe));
  row.append(own);
  radios(row);
  return Object.assign(row, { show: () => row.querySelectorAll("[role=radio]").forEach((b) => {
    const on = b.dataset.probe === JSON.stringify(probeOf(store.state));
    b.setAttribute("aria-checked", String(on));
    b.tabIndex = on ? 0 : -1;
  }) });
}
