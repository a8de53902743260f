// Keyframes of everything in the state: a strip of them below the picture, played, and written as a film. Loaded when first used.
import { fromScene } from "./camera.js";
import { bytes, clamp, download, el, icon, percent, short } from "./dom.js";
import { newestOnly } from "./link.js";
import { draggable } from "./rows.js";
import { stateOf } from "./scene.js";
import { filmWords as w } from "./part-texts.js";
import { styled } from "./styles.js";
import { words } from "./texts.js";

const largest = 900_000;

export async function makeFilm(app, area) {
  await styled("film.css");
  const { store } = app, film = () => store.state.film ?? { fps: 25, size: [1280, 720], keys: [] }, keys = () => film().keys;
  const put = (label, changes) => store.set(label, (s) => ({ film: { ...film(), ...changes } }));
  let now = 0, chosen = -1, playing = null, exporting = null;
  const end = () => keys().at(-1)?.at ?? 0, span = () => Math.max(4, end() * 1.15), rounded = (t) => Math.round(t * 100) / 100;
  /** What a key keeps: all that makes the picture. */
  const sceneNow = () => {
    const { marks, slices, image, ...scene } = app.scene();
    return scene;
  };
  const told = (more = {}) => ({ film: 1, fps: film().fps, size: film().size, keys: keys(), ...more });
  const fits = () => JSON.stringify(told()).length < largest || (app.states.say(w.tooMany, { role: "alert" }), false);

  function add() {
    const taken = (t) => keys().some((key) => Math.abs(key.at - t) < 0.005), at = rounded(!keys().length ? 0 : taken(now) || now >= end() ? end() + 2 : now);
    now = at;
    const next = [...keys(), { at, scene: sceneNow() }].sort((a, b) => a.at - b.at);
    put(w.add, { keys: next });
    chosen = next.findIndex((key) => key.at === at);
    leave();
  }
  const remove = (i) => ((chosen = -1), put(w.removed, { keys: keys().filter((_, k) => k !== i) }));
  /** A key stops at its neighbours. */
  const move = (i, t) => put(`${w.moved}…`, { keys: keys().map((key, k) => (k === i ? { ...key, at: rounded(clamp(t, (keys()[i - 1]?.at ?? -0.05) + 0.05, (keys()[i + 1]?.at ?? 1e5) - 0.05)) } : key)) });
  /** Once around in eight seconds, from here. */
  function turntable() {
    const scene = sceneNow(), from = store.state.camera["camera.azimuth_deg"] ?? 35, { eye, target, view, ...camera } = scene.camera ?? {};
    const turned = [0, 120, 240, 360].map((angle, i) => ({ at: (8 * i) / 3, scene: { ...scene, camera: { ...camera, azimuth_deg: ((from + angle + 180) % 360) - 180 } } }));
    now = 0;
    put(w.turntable, { keys: turned.map((key) => ({ ...key, at: rounded(key.at) })) });
  }
  /** The page takes over what a key has: a step that can be undone. */
  const go = (i) => (leave(), (now = keys()[i].at), store.set(w.go, (s) => {
    const { scene } = keys()[i], next = stateOf({ ...scene, volume: s.rest.volume, image: s.rest.image }, s, (camera) => fromScene(camera, app.box, app.volume.world));
    return { ...next, film: s.film, marks: s.marks, values: { ...next.values, ...Object.fromEntries(Object.entries(s.values).filter(([key]) => key.startsWith("slices."))) }, look: undefined };
  }), store.set(`${words.camera}…`, (s) => ({ camera: { ...fromScene(Object.fromEntries(Object.entries(keys()[i].scene.camera ?? {}).map(([key, v]) => [`camera.${key}`, v])), app.box, app.volume.world), ...Object.fromEntries(Object.entries(s.camera).filter(([key]) => key.startsWith("slices."))) } }), "camera"));
  const update = (i) => put(w.update, { keys: keys().map((key, k) => (k === i ? { ...key, scene: sceneNow() } : key)) });

  // Looking at a moment: a preview, as a look on trial is.
  const look = newestOnly(app.link, async ({ t }) => {
    const answer = await app.link.ask("film_frame", { film: told(), seconds: t }).catch((error) => (stop(), app.fault(error)));
    if (answer && root.isConnected && !root.hidden && looking) store.show({ scene: answer.scene, moving: playing !== null });
  });
  let looking = false;
  function seek(t) {
    now = clamp(t, 0, Math.max(end(), 0));
    store.redraw();
    looking = keys().length > 1;
    if (looking) look({ t: now });
  }
  const leave = () => (stop(), (looking = false), store.show(null));
  function stop() {
    if (playing === null) return;
    cancelAnimationFrame(playing);
    playing = null;
    store.redraw();
  }
  function play() {
    if (playing !== null) return stop(), seek(now);
    if (keys().length < 2 || !fits()) return app.states.say(w.needsTwo);
    const from = now >= end() ? 0 : now, began = performance.now();
    const step = () => {
      const t = from + (performance.now() - began) / 1000;
      playing = t >= end() ? null : requestAnimationFrame(step);
      seek(Math.min(t, end()));
    };
    playing = requestAnimationFrame(step);
  }

  async function write(format) {
    if (keys().length < 2 || !fits()) return app.states.say(w.needsTwo);
    leave();
    sessionStorage.setItem("film", format); // goes on after a reload, and when the server is there again
    const asked = app.link.ask("export_film", { film: told(), format }, (m) => ((exporting = { ...exporting, ...m }), store.redraw()));
    exporting = { id: asked.id, fraction: 0 };
    store.redraw();
    try {
      const answer = await asked;
      el("a", { href: new URL(answer.url.replace(/^\//, ""), location.href).href, download: answer.name }).click();
      app.states.say(`${words.saving.done}: ${answer.name}, ${bytes(answer.bytes)}`);
    } catch (error) {
      if (error.code === "lost") return void (exporting.id = null);
      if (error.code !== "interrupted") app.fault(error);
    }
    sessionStorage.removeItem("film");
    exporting = null;
    store.redraw();
  }
  /** What broke off: the server has its frames. */
  function goOn() {
    const format = sessionStorage.getItem("film");
    if (!format || exporting?.id || keys().length < 2) return;
    api.toggle(true);
    write(format);
  }
  function cancelWriting() {
    if (exporting?.id) app.link.cancel(exporting.id);
    else sessionStorage.removeItem("film"), (exporting = null), store.redraw();
  }

  const playButton = el("button.plain", { onclick: play }), time = el("span.film-time"), line = el("div.film-line"), heads = el("div.film-keys"), head = el("div.film-head", { role: "slider", tabIndex: 0, "aria-label": w.time }, el("i"));
  const hint = el("small.film-hint", {}, w.hint), track = el("div.film-track", {}, line, heads, head, hint), more = el("div.buttons"), bar = el("div.progress", { role: "progressbar", "aria-label": w.writing }, el("i")), cancel = el("button.plain", { onclick: cancelWriting }, words.states.cancel), at = el("small", {});
  const writing = el("div.film-writing", { hidden: true }, bar, at, cancel);
  const fps = el("select", { "aria-label": w.fps, onchange: () => put(w.fps, { fps: Number(fps.value) }) }, ...[24, 25, 30, 50, 60].map((n) => el("option", { value: String(n) }, w.perSecond(n)))), sizes = [[1280, 720], [1920, 1080], [3840, 2160], [1080, 1080]];
  const size = el("select", { "aria-label": words.saving.size, onchange: () => put(words.saving.size, { size: sizes[size.selectedIndex] }) }, ...sizes.map((s) => el("option", {}, s.join(" × "))));
  const save = el("button.plain", { "aria-haspopup": "menu", onclick: () => app.menu(save, [...app.hello.films.map((format) => [w.formats[format], () => write(format)]), [w.file, () => download(new Blob([JSON.stringify(told(), null, 1)], { type: "application/json" }), "film.json")]]) }, w.save);
  const root = el("section", { id: "film", "aria-label": w.title, hidden: true }, el("div.film-bar", {}, playButton, time, el("button.plain", { title: `${w.add} (K)`, onclick: add }, w.add), el("button.plain", { onclick: turntable }, w.turntable), more, el("div.spring"), fps, size, writing, save, el("button.tool", { "aria-label": words.close, onclick: () => api.toggle() }, icon("close"))), track);
  const x = (t) => `${(100 * t) / span()}%`, perPixel = () => span() / Math.max(1, track.clientWidth);
  draggable(head, store, w.time, () => (stop(), now), (start, dx) => seek(start + dx * perPixel()));
  line.addEventListener("pointerdown", (event) => (stop(), seek(event.offsetX * perPixel())));
  head.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -1, ArrowRight: 1, PageDown: -10, PageUp: 10 }[event.key], to = { Home: 0, End: end() }[event.key];
    if (step === undefined && to === undefined) return;
    event.preventDefault();
    stop();
    seek(to ?? now + step / film().fps);
  });
  function keyHandle(i) {
    const handle = el("button.film-key", { role: "slider" }, el("i"));
    draggable(handle, store, w.moved, () => ((chosen = i), keys()[i].at), (start, dx) => Math.abs(dx) > 2 && move(i, start + dx * perPixel()));
    handle.addEventListener("focus", () => ((chosen = i), store.redraw()));
    handle.addEventListener("dblclick", () => go(i));
    handle.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -0.1, ArrowRight: 0.1 }[event.key];
      if (step) move(i, keys()[i].at + step * (event.shiftKey ? 10 : 1));
      else if (event.key === "Delete") remove(i);
      else if (event.key === "Enter") go(i);
      else return;
      event.preventDefault();
      event.stopPropagation();
    });
    return handle;
  }
  function show() {
    const all = keys(), playingNow = playing !== null;
    hint.hidden = all.length > 1;
    playButton.textContent = playingNow ? w.pause : w.play;
    time.textContent = `${now.toFixed(1)} / ${end().toFixed(1)} s`;
    if (heads.children.length !== all.length) heads.replaceChildren(...all.map((_, i) => keyHandle(i)));
    all.forEach((key, i) => {
      const handle = heads.children[i];
      handle.style.left = x(key.at);
      handle.classList.toggle("chosen", i === chosen);
      handle.setAttribute("aria-label", w.key(i + 1));
      handle.setAttribute("aria-valuenow", String(key.at));
      handle.setAttribute("aria-valuetext", `${short(key.at)} s`);
    });
    head.style.left = x(now);
    head.setAttribute("aria-valuenow", now.toFixed(2));
    head.setAttribute("aria-valuetext", `${now.toFixed(2)} s`);
    const shown = all[chosen] ? `${chosen}` : "";
    if (more.dataset.of !== shown) {
      more.dataset.of = shown;
      more.replaceChildren(...(shown ? [el("button", { onclick: () => go(chosen) }, w.go), el("button", { onclick: () => update(chosen) }, w.update), el("button", { onclick: () => remove(chosen) }, words.remove)] : []));
    }
    fps.value = String(film().fps);
    size.selectedIndex = Math.max(0, sizes.findIndex((s) => String(s) === String(film().size)));
    writing.hidden = !exporting;
    fps.hidden = size.hidden = save.hidden = Boolean(exporting);
    if (exporting) bar.firstChild.style.width = percent(exporting.fraction ?? 0).replace(" ", ""), (at.textContent = `${percent(Math.round(100 * (exporting.fraction ?? 0)) / 100)}${exporting.remaining_s > 2 ? `, ${words.states.left(Math.round(exporting.remaining_s))}` : ""}`);
  }
  /** Of a file: a step. */
  const take = ({ fps: rate = 25, size: pixels = [1280, 720], keys: given }) => {
    put(w.loaded, { fps: rate, size: pixels, keys: given.map(({ at, scene }, i) => ({ at: at ?? i, scene })) });
    now = 0;
    api.toggle(true);
  };
  const api = { goOn, take, add, play, root, seek, write, get now() { return now; }, get playing() { return playing !== null; },
    toggle(on = root.hidden) {
      root.hidden = !on;
      document.body.classList.toggle("filming", on);
      if (!on) leave();
      app.resized();
    },
    open: () => ((now = 0), (chosen = -1), leave()) };
  document.body.append(root);
  store.watch(() => root.hidden || show());
  return api;
}
