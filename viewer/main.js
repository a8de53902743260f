// The page put together: one store, one link, one module a part.
import { boxOf, fromScene, toScene, viewOf } from "./camera.js";
import { makeColour } from "./colour.js";
import { makeCross } from "./orientation.js";
import { el, fromHex, icon, percent, short } from "./dom.js";
import { makeFrame } from "./frame.js";
import { makeGestures } from "./gestures.js";
import { makeKeys } from "./keys.js";
import { makeLight, radios } from "./light.js";
import { Link } from "./link.js";
import { makeLooks } from "./presets.js";
import { makeMenus } from "./menus.js";
import { describe, read, samePicture, sceneOf, stateOf, write } from "./scene.js";
import { makePalette } from "./palette.js";
import { makePlanes } from "./planes.js";
import { makeSections } from "./sections.js";
import { makeStates, mark, recent } from "./states.js";
import { Store } from "./store.js";
import { makeTheme } from "./theme.js";
import { words } from "./texts.js";

const bar = document.getElementById("bar"), area = document.getElementById("area"), stage = document.getElementById("stage"), panel = document.getElementById("panel"), dock = document.getElementById("dock");
const store = new Store({ values: {}, camera: {}, tf: { points: [{ value: 0, opacity: 0 }], stops: [{ value: 0, rgb: [0, 0, 0] }], unit: { key: "opacity_unit_distance", value: 1 }, scale: 1, rest: {} }, threshold: null, iso: [], marks: [], rest: {} });
const link = new Link();
/** Everything the parts share. @type {any} */
const app = { store, link, stage, ui: { points: [], stop: -1, tool: "orbit" }, volume: null, hello: null, box: null, percent, fromHex };
app.theme = makeTheme(store);
app.withUnit = (v) => `${short(v)}${app.volume?.unit ? " " + app.volume.unit : ""}`;
/** A value with the digits that tell it from any other of its type; ≈ where the program holds no more than a float of it. */
app.exactly = (v) => {
  const short_ = [...Array(17).keys()].map((p) => Number(v.toPrecision(p + 1))).find((t) => t === v || (v === Math.fround(v) && Math.fround(t) === v)) ?? v;
  return `${app.volume.exact === false ? "≈ " : ""}${String(short_).replace("-", "−")}${app.volume.unit ? " " + app.volume.unit : ""}`;
};
app.unitOfLength = () => (app.volume?.spacing_stated === false ? words.voxels : "mm");
app.view = () => viewOf(store.state.camera, app.box);
app.keysOn = () => localStorage.getItem("keys") !== "off";
app.sceneWith = (more) => sceneOf({ ...store.state, ...more }, (camera) => toScene(camera, app.box));
app.scene = () => app.sceneWith({});
app.copy = (text, copied = words.copied) => navigator.clipboard.writeText(text).then(() => app.states.say(copied), () => app.states.say(text));
app.fault = (error) => void (error?.sentence && app.states.say(error.sentence, { role: "alert" }));
/** What is to be known about the volume, in About and as a dot at its name. */
app.doubts = () => [...(app.volume.reduced ? [words.reduced(app.volume.reduced)] : []), ...app.volume.notes];
/** Half way into the densest peak. */
app.firstSurface = () => {
  const { points } = store.state.tf, height = (peak) => Math.max(...points.slice(peak.first, peak.last + 1).map((p) => p.opacity));
  const peaks = app.graph.peaks().sort((a, b) => height(b) - height(a)), [peak] = peaks, [low, high] = app.volume.range;
  return peak ? (Math.max(peak.lo, low) + Math.min(peak.hi, high)) / 2 : (low + high) / 2;
};

// The picture.
stage.tabIndex = 0;
app.frame = makeFrame(app);
app.states = makeStates(app, stage);
app.menus = makeMenus(app);
app.save = async (anchor) => (await import("./saving.js")).makeSaving(app)(anchor);
app.popover = app.menus.popover;
app.menu = app.menus.menu;
stage.append(app.frame.canvas, app.frame.pill, app.frame.said);
app.gestures = makeGestures(app, stage);
app.cross = makeCross(app, stage);
app.cutting = makePlanes(app, stage);
let comparing = null;
app.compare = { on: false, stop: () => {}, start: () => (comparing ??= import("./compare.js").then(({ makeCompare }) => (app.compare = makeCompare(app, stage)).start())) };

// The bar.
const tool = (name, label, act, text) => el(`button.tool${text ? ".wide" : ""}`, { title: label, "aria-label": label, onclick: act }, icon(name), text ? el("span", {}, text) : null);
const modes = el("div.segmented", { role: "radiogroup", "aria-label": words.picture }, ...Object.entries(words.modes).map(([name, [label, tip]], i) => el("button", { role: "radio", title: `${tip} (${i + 1}). --mode ${name}`, onclick: () => app.mode(name) }, label)));
radios(modes);
const undo = tool("undo", words.undo, () => store.step("undo")), redo = tool("redo", words.redo, () => store.step("redo")), compare = tool("compare", `${words.compare} (R)`, () => app.compare.start(), words.compare);
redo.classList.add("wide");
const slicing = tool("slices", `${words.slices.tip} (S)`, () => app.toggleSlices());
const file = el("button.file", { title: `${words.about.title} (I)`, onclick: () => app.menus.about(file) }), save = el("button.primary", { title: `${words.save} (Ctrl S)`, onclick: () => app.save(save) }, el("span.long", {}, words.save), el("span.short", {}, words.saveShort));
const more = tool("more", words.more, () => app.menus.more(more));
const ofVolume = [file, modes, slicing, undo, redo, compare, save];
app.bar = { file, save, more, compare };
bar.append(el("div.brand", {}, mark(), el("span", {}, words.name)), file, el("div.spring"), modes, slicing, undo, redo, compare, save, more);

// The panel.
app.looks = makeLooks(app);
app.colour = makeColour(app);
app.light = makeLight(app);
makePalette(app);
const folded = makeSections(app), sections = el("div", { id: "sections" });
const tabs = el("div.tabs", { role: "tablist" }, ...[["look", "looks"], ["colour", "peak"], ["light", "light"], ["cut", "cut"], ["more", "rows"]].map(([name, picture]) => el("button", { role: "tab", onclick: () => tab(name) }, icon(picture), words.tabs[name])));
const names = ["look", "colour", "light", "cut", "more"];
function tab(name) {
  document.body.dataset.tab = name;
  [...tabs.children].forEach((b, i) => b.setAttribute("aria-selected", String(names[i] === name)));
  // The section of a tab stands open.
  if (innerWidth <= 760 && name === "cut") panel.querySelector(".s-cut .head[aria-expanded=false]")?.click();
  store.redraw();
}
app.showTab = tab;
const handle = el("div.handle");
handle.addEventListener("pointerdown", (event) => {
  handle.setPointerCapture(event.pointerId);
  const from = panel.offsetHeight, put = (h) => (document.body.style.setProperty("--sheet", `${h}px`), app.resized());
  let now = from;
  handle.onpointermove = (e) => put((now = Math.max(84, Math.min(innerHeight * 0.85, from + event.clientY - e.clientY)) - 12));
  handle.onpointerup = () => ((handle.onpointermove = null), put([84, 436, innerHeight * 0.85].reduce((a, b) => (Math.abs(b - now) < Math.abs(a - now) ? b : a))));
});
panel.append(handle, sections, tabs);

app.dock = () => {
  const to = dock.hidden ? dock : app.colour.section;
  dock.hidden = !dock.hidden;
  document.body.classList.toggle("docked", !dock.hidden);
  to === dock ? dock.append(app.graph.root) : app.colour.section.insertBefore(app.graph.root, app.colour.section.querySelector(".chips"));
  app.resized();
};
app.togglePanel = () => ((panel.hidden = !panel.hidden), app.resized());

function open(volume, scene, restored) {
  app.volume = volume;
  app.box = boxOf(volume);
  app.frame.reset();
  stage.classList.remove("empty");
  document.body.classList.remove("none");
  app.states.clear();
  store.replace(stateOf(scene, null, (camera) => fromScene(camera, app.box, volume.world)), { silent: true });
  file.replaceChildren(el("b", {}, volume.name ?? volume.file), el("span", {}, `${volume.dimensions.join(" × ")}, ${words.types[volume.type] ?? volume.type}`), ...(app.doubts().length ? [el("i.dot", { title: app.doubts()[0] })] : []));
  document.title = `${volume.name ?? volume.file} – Chiaro`;
  sections.replaceChildren(app.looks.section, app.colour.section, app.light.section);
  app.colour.open();
  app.light.open();
  app.cross.open();
  sections.append(...folded().map((part) => part));
  app.channels ? app.channels.open() : volume.channels && needChannels();
  app.labels?.open();
  if (app.labels) app.colour.section.after(app.labels.root);
  app.film?.open();
  app.moments ? app.moments.open() : volume.moments && needMoments();
  if (app.marks) sections.prepend(app.marks.rows), app.marks.open();
  if (app.slices) sections.append(app.slices.rows), app.slices.open();
  app.looks.open();
  for (const part of [...ofVolume, panel]) part.hidden = false;
  if (volume.reduced) app.states.say(words.reduced(volume.reduced), { acts: [[words.states.details, () => app.menus.about(file)]], role: "alert" });
  changed({ moving: false });
  app.embed?.opened();
  if (linked) follow();
  goOnFilming();
}
/** A film whose writing broke off, by a reload or a lost server. */
const goOnFilming = () => sessionStorage.getItem("film") && needFilm().then((film) => film.goOn());
/** A link to a state: of this volume, or of one that is opened for it. */
let linked = location.hash.startsWith("#state=") ? import("./share.js").then((share) => share.linked()) : null;
async function follow() {
  const scene = await linked, file = scene?.volume?.file;
  linked = null;
  if (!scene) return;
  if (file && file !== app.volume?.file) await app.open({ volume: file });
  if (file === app.volume?.file) take(scene);
}

/** Slices beside the volume, or none. */
app.toggleSlices = () => store.set(words.slices.layout, (s) => write(s, "slices.layout", read(s, "slices.layout") === "volume" ? "linked" : "volume"));
/** What slices need comes when they are first shown. */
async function needSlices() {
  const { makeSlices } = await import("./slices.js");
  app.slices = await makeSlices(app, area);
  if (app.volume) sections.append(app.slices.rows);
  store.redraw();
}
/** So does what measuring needs. */
async function needMarks() {
  const { makeMarks } = await import("./marks.js");
  app.marks = await makeMarks(app);
  if (app.volume) sections.prepend(app.marks.rows);
  store.redraw();
}
/** And channels, and labels. */
let channelsAsked = null, labelsAsked = null, slicesAsked = null, marksAsked = null;
const needChannels = () => (channelsAsked ??= import("./channels.js").then(({ makeChannels }) => makeChannels(app)).then((channels) => {
  app.channels = channels;
  app.colour.section.querySelector(".head").after(channels.root);
  channels.open();
  store.redraw();
}));
const needLabels = async () => {
  const { makeLabels } = await import("./labels.js");
  app.labels = await makeLabels(app);
  if (app.volume) app.colour.section.after(app.labels.root);
  store.redraw();
  return app.labels;
};
/** And moments. */
const needMoments = async () => (app.moments = await import("./moments.js").then(({ makeMoments }) => makeMoments(app, stage)));
/** And the strip of keyframes. */
let filmAsked = null;
const needFilm = () => (filmAsked ??= import("./film.js").then(({ makeFilm }) => makeFilm(app)).then((film) => (app.film = film)));
app.toggleFilm = async () => app.volume && (await needFilm()).toggle();
/** A file of keyframes: the server says what is wrong with it. */
async function needFilmOf(file) {
  const json = await file.text().then(JSON.parse).catch(() => null);
  if (json?.film !== 1) return false;
  const told = await link.ask("film_frame", { film: json, seconds: 0 }).catch(app.fault);
  if (told) (await needFilm()).take(json);
  return true;
}
app.addKey = async () => {
  const film = await needFilm();
  if (film.root.hidden) film.toggle(true);
  film.add();
};
function layOut(state) {
  if (app.volume && (app.ui.tool === "measure" || state.marks?.length)) marksAsked ??= needMarks();
  if (app.volume && read(state, "labels.file")) labelsAsked ??= needLabels();
  const layout = (app.volume && read(state, "slices.layout")) || "volume";
  if (layout !== "volume") slicesAsked ??= needSlices();
  area.dataset.layout = app.slices?.layout() ?? "volume";
  slicing.setAttribute("aria-pressed", String(layout !== "volume"));
}

/** Sends the newest state; wheels and keys that follow each other closely count as moving. */
function changed({ moving }) {
  if (!app.volume) return;
  keep();
  if (!store.preview) keepThere();
  const shown = store.preview, [w, h] = app.frame.size(), size = `${w} ${h}`;
  if (sent && !shown && !sent.shown && sent.link === link.connections && sent.size === size && samePicture(sent.state, store.state) && (moving || !sent.moving)) return;
  sent = { state: store.state, shown, size, moving, link: link.connections };
  app.frame.forget();
  app.looks.pause();
  link.send(() => {
    if (shown?.scene) return { scene: shown.scene, canvas: [w, h] };
    const scene = app.sceneWith(shown?.tf ? { tf: shown.tf } : {});
    if (shown?.unlit) scene.lighting = { method: "none" };
    return { scene, canvas: [w, h] };
  }, { moving: moving || Boolean(shown?.moving), preview: shown !== null, ...(shown?.next !== undefined ? { next: shown.next } : {}) });
}
/** What was sent last; nothing is sent again that makes the same picture. */
let sent = null;
store.onchange = changed;
let keeping = 0, keptSteps = -1;
/** The server keeps the state and its steps, for a reload, and for the server that comes after it. */
const keepThere = () => {
  clearTimeout(keeping);
  keeping = setTimeout(tellToKeep, 300);
};
const tellToKeep = () => {
  keeping = 0;
  if (!app.volume || store.dragging) return;
  const undo = keptSteps === store.steps ? {} : { undo: { ...store.history(), film: store.state.film } };
  keptSteps = store.steps;
  link.ask("keep", { scene: app.scene(), ...undo }).catch(() => (keptSteps = -1));
};
app.shown = (header) => {
  // What the camera fits is found once: from then on the state has it.
  const { camera } = store.state;
  if (header.fit && header.n === link.n && !camera["camera.fit_centre"]) store.learn({ camera: { ...camera, "camera.fit_centre": header.fit.centre, "camera.fit_radius": header.fit.radius } });
  app.moments?.shown(header);
  if (header.stage !== "draft" && !header.moving) app.looks.rest();
  if (header.stage === "final" && !header.preview) remember(), app.embed?.shown();
};
/** A small picture for the page that has no volume yet. */
function remember() {
  const { canvas } = app.frame, small = el("canvas", { width: 128, height: 96 }), k = Math.max(128 / canvas.width, 96 / canvas.height), [w, h] = [canvas.width * k, canvas.height * k];
  small.getContext("2d").drawImage(canvas, (128 - w) / 2, (96 - h) / 2, w, h);
  recent.remember(app.volume.file, app.volume.name ?? app.volume.file, small.toDataURL("image/jpeg", 0.8));
}
let kept = 0;
const keep = () => {
  clearTimeout(kept);
  kept = setTimeout(keepNow, 500);
};
const keepNow = () => {
  kept = 0;
  sessionStorage.setItem("state", JSON.stringify({ file: app.volume.file, state: store.state, history: store.history() }));
};
/** A page that goes away loses no step that waited for its moment. */
addEventListener("pagehide", () => {
  clearTimeout(kept), clearTimeout(keeping);
  if (kept) keepNow();
  if (keeping) tellToKeep();
});
app.resized = () => {
  store.redraw();
  changed({ moving: false });
};
new ResizeObserver(() => app.volume && app.resized()).observe(stage);

// Opening: a file below the server's folders, a sample, a scene, or what was dropped on the page.
app.open = async (what, called = what.volume ?? what.scene) => {
  const asked = link.ask("open", what, (m) => told(m)), told = app.states.reading(called, () => link.cancel(asked.id));
  try {
    const { volume, scene } = await asked;
    app.states.hush(); // what was said was about another volume
    if (app.volume && store.steps) left.set(app.volume.file, { state: store.state, history: store.history(), at: Date.now() });
    open(volume, scene);
    offerLeft(left.get(volume.file));
  } catch (error) {
    app.states.clear();
    if (error.code === "interrupted") app.volume || app.states.empty();
    else if (error.sentence) app.states.failed(error.sentence);
  }
};
app.openEntry = (entry) => (entry.kind === "transfer" ? link.ask("resolve", { transfer_function: { file: entry.path } }).then((a) => app.setTransfer(a.transfer_function, words.importTf), app.fault) : app.open(entry.kind === "scene" ? { scene: entry.path } : { volume: entry.path }));
app.chooseLabels = async () => (await (labelsAsked ??= needLabels())).chooseFile();
app.take = async (given) => {
  if (app.volume && /\.json$/i.test(given.name) && (await needFilmOf(given))) return;
  const found = await link.upload(given).catch(app.fault);
  if (!found) return;
  if (found.kind === "transfer") app.setTransfer(found.transfer_function, words.importTf);
  else if (found.kind === "probe") (app.ownProbe = found.source), store.set(words.light, (s) => ({ values: { ...s.values, "probe.file": found.source, "probe.preset": undefined } })), app.light.open();
  else if (found.needs_volume) app.states.say(`${words.about.dimensions}: ${found.needs_volume}`, { role: "alert" });
  else take(found.scene);
};
/** The look of a scene for the volume that is shown: a step that can be undone. */
const take = (scene) => app.volume && store.set(words.menu.loadScene, (s) => ({ film: s.film, ...stateOf({ ...scene, volume: s.rest.volume, image: s.rest.image }, s, (camera) => fromScene(camera, app.box, app.volume.world)), look: undefined }));
/** Volumes are streamed to a folder of the server's; scenes, pictures, functions and probes are taken as they are. */
const isSmall = (files) => files.length === 1 && /\.(json|png|exr|hdr|vp|itf|tfi)$/i.test(files[0].name);
app.sendVolume = async (files) => (await import("./sending.js")).openFiles(app, files);
for (const name of ["dragover", "drop"]) addEventListener(name, (event) => {
  event.preventDefault();
  document.body.classList.toggle("dropping-file", name === "dragover");
  if (name !== "drop" || !event.dataTransfer.items.length) return;
  const entries = [...event.dataTransfer.items].map((item) => item.webkitGetAsEntry?.()), { files } = event.dataTransfer;
  if (files[0] && isSmall(files) && !entries.some((e) => e?.isDirectory)) return app.take(files[0]);
  const transfer = { items: entries.map((entry) => ({ webkitGetAsEntry: () => entry })), files: [...files] };
  import("./sending.js").then(({ dropped, openFiles }) => dropped(transfer).then((given) => openFiles(app, given)));
});
addEventListener("dragleave", (event) => event.relatedTarget || document.body.classList.remove("dropping-file"));

// The server.
let wasLost = false, counting = 0, reading = null;
link.onstate = (state, wait = 0) => {
  clearInterval(counting);
  stage.classList.toggle("lost", state !== "open");
  if (state === "open") return app.states.hush();
  const w = words.states;
  if (state === "taken" && isEmbedded) return link.renew();
  if (state === "taken") return app.states.say(w.elsewhere, { acts: [[w.takeOver, () => link.connect(true)]], keep: true });
  wasLost = true;
  let left = wait;
  const banner = app.states.say(w.lost(left), { acts: [[w.tryNow, () => link.connect()]], keep: true });
  counting = setInterval(() => banner.change(w.lost(Math.max(0, --left))), 1000);
};
const isEmbedded = new URLSearchParams(location.search).has("embed");
let makeEmbed = null;
const hello = (m) => {
  const updated = app.hello && app.hello.version !== m.version;
  app.hello = m;
  app.embed ??= makeEmbed?.(app, take);
  describe(m.settings);
  if (updated) return app.states.say(words.states.updated, { acts: [[words.states.reload, () => location.reload()]], keep: true });
  if (app.volume) {
    // Page state is the truth: it goes to the new server, which shows the same again.
    if (wasLost && !m.restored) app.states.say(words.states.restarted);
    wasLost = false;
    link.n = Math.max(link.n, 0);
    return m.volume && m.volume.file === app.volume.file ? (changed({ moving: false }), goOnFilming()) : m.reading ? undefined : reopen();
  }
  if (m.error) return app.states.failed(m.error);
  if (m.reading) return (reading = app.states.reading(m.reading, () => link.cancel("open")));
  if (!m.volume) return linked ? follow() : app.states.empty();
  open(m.volume, m.scene);
  const last = JSON.parse(sessionStorage.getItem("state") ?? "null");
  if (!m.restored && last?.file === m.volume.file) store.restore(last.state, last.history);
  else if (m.undo) store.restore({ ...store.state, film: m.undo.film }, m.undo);
  else if (m.earlier && !last) offerEarlier(m.earlier);
};
/** A page that was closed: another one of the same volume may go on where it was. */
function offerEarlier({ view, seconds }) {
  const w = words.states, takeUp = async () => {
    app.states.hush();
    const answer = await link.ask("earlier", { view }).catch(app.fault);
    if (answer) take(answer.scene);
  };
  app.states.say(w.earlier(ago(seconds)), { acts: [[w.takeUp, takeUp]], role: "alert" });
}
/** Volumes that this page showed before, as they were left. */
const left = new Map();
function offerLeft(before) {
  if (!before) return;
  const w = words.states, takeUp = () => (app.states.hush(), store.restore(before.state, before.history));
  app.states.say(w.leftAgo(ago((Date.now() - before.at) / 1000)), { acts: [[w.takeUp, takeUp]], role: "alert" });
}
const ago = (seconds) => (seconds < 5400 ? `${Math.max(1, Math.round(seconds / 60))} min` : seconds < 129600 ? `${Math.round(seconds / 3600)} h` : `${Math.round(seconds / 86400)} days`);
/** Opens the page's own volume again, all settings kept: the server came back with another or none, or it is to be smaller. */
async function reopen(what = { volume: app.volume.file }) {
  const { state } = store, answer = await link.ask("open", what).catch(app.fault);
  if (!answer) return;
  open(answer.volume, answer.scene);
  store.replace(state);
}
/** The two things that would help. */
function outOfMemory(sentence) {
  const again = (act) => () => (app.states.hush(), act()), coarser = app.light.coarser();
  app.states.say(sentence, { role: "alert", acts: [...(coarser ? [[words.states.coarser, again(coarser)]] : []), [words.states.halfSize, again(() => reopen({ half: true }))]] });
}
link.onmessage = (m) => {
  if (m.type === "hello") hello(m);
  else if (m.type === "progress") m.re === "open" ? reading?.(m) : app.frame.progress(m);
  else if (m.type === "opened") !app.volume ? (open(m.volume, m.scene), m.undo && store.restore({ ...store.state, film: m.undo.film }, m.undo)) : m.volume.file === app.volume.file ? (changed({ moving: false }), goOnFilming()) : reopen();
  else if (m.type === "error") m.re === "open" ? (app.states.clear(), m.code === "interrupted" ? app.volume || app.states.empty() : app.states.failed(m.sentence)) : m.code === "memory" && m.n ? outOfMemory(m.sentence) : app.states.say(m.sentence, { role: "alert" });
  else if (m.type === "put") take(m.scene);
  else if (m.type === "note") app.states.say(m.sentence, { keep: false });
};
link.onframe = (header, data) => app.frame.show(header, data);

store.watch((state) => {
  layOut(state);
  const mode = read(state, "mode") ?? "dvr";
  [...modes.children].forEach((b, i) => {
    const on = Object.keys(words.modes)[i] === mode;
    b.setAttribute("aria-checked", String(on));
    b.tabIndex = on ? 0 : -1;
  });
  for (const [button, which, name, none] of [[undo, "undo", words.undo, words.nothingToUndo], [redo, "redo", words.redo, words.nothingToRedo]]) {
    const next = store.next(which);
    button.disabled = !next;
    button.title = next ? `${name}: ${next}` : none;
  }
  stage.classList.toggle("transparent", read(state, "background") === "transparent");
});
makeKeys(app);
for (const part of ofVolume) part.hidden = true;
tab("colour");
Object.assign(window, { chiaro: app });
if (isEmbedded) import("./embed.js").then((module) => ((makeEmbed = module.makeEmbed), link.connect()));
else link.connect();
