// Looks: colour, opacity and surface at a click. Thumbnails come from this volume at the present camera, at rest.
import { el, icon } from "./dom.js";
import { spanOf } from "./peaks.js";
import { sceneOf, split, transferOf } from "./scene.js";
import { words } from "./texts.js";

const size = [128, 96];

/** The looks of this browser, as presets that bring their own function. They are in the data's values, as CT looks are. */
const mine = {
  all: () => JSON.parse(localStorage.getItem("looks") ?? "[]"),
  keep: (looks) => localStorage.setItem("looks", JSON.stringify(looks)),
  presets: () => mine.all().map(({ name, transfer_function }) => ({ name: `mine:${name}`, own: transfer_function, modality: "mine", sentence: "", stretched: false, is_map: false })),
};

export function makeLooks(app) {
  const { store } = app, resolved = new Map(), thumbs = new Map();
  const row = el("div.looks", { role: "group", "aria-label": words.look });
  const says = el("button.says.tool", { "aria-haspopup": "dialog", title: words.allLooks, onclick: () => all() });
  const section = el("section.section.s-look", {}, el("div.head", {}, el("h2", {}, words.look), says), row);
  const label = (preset) => (preset.own ? preset.name.slice(5) : undefined) ?? words.looks[preset.name] ?? (preset.name.startsWith("sample:") ? words.groups.sample : preset.name[0].toUpperCase() + preset.name.slice(1));
  let first = [], drawnAt = "", queue = [], busy = false, timer = 0;

  /** The function of a look for this volume. A colour map keeps the opacity and spans the window. */
  async function functionOf(preset) {
    if (preset.own) return split(preset.own);
    if (!resolved.has(preset.name)) resolved.set(preset.name, split((await app.link.ask("resolve", { transfer_function: { preset: preset.name } })).transfer_function));
    const tf = resolved.get(preset.name);
    if (!preset.is_map) return tf;
    const now = store.state.tf, [a, b] = spanOf({ points: [], stops: tf.stops }), [lo, hi] = spanOf(now);
    return { ...now, stops: tf.stops.map((s) => ({ ...s, value: lo + ((s.value - a) / (b - a || 1)) * (hi - lo) })) };
  }
  const same = (a, b) => JSON.stringify({ ...transferOf(a), name: 0 }) === JSON.stringify({ ...transferOf(b), name: 0 });

  async function take(preset) {
    const tf = await functionOf(preset).catch(app.fault);
    if (!tf) return;
    store.preview = null;
    store.set(`${words.look}: ${label(preset)}`, () => ({ tf, look: preset.name }));
  }
  let resting = 0;
  function trial(preset) {
    clearTimeout(resting);
    resting = setTimeout(async () => {
      const tf = await functionOf(preset).catch(() => null), asked = resting;
      if (tf && asked === resting) store.show({ tf, name: label(preset) });
    }, 300);
  }
  const leave = () => (clearTimeout(resting), (resting = 0), store.show(null));

  function button(preset) {
    const canvas = el("canvas", { width: size[0], height: size[1] });
    const made = el("button", { title: preset.sentence, onclick: () => (leave(), take(preset)), onpointerenter: (e) => e.pointerType === "mouse" && trial(preset), onpointerleave: leave }, canvas, el("span", {}, label(preset)));
    made.dataset.look = preset.name;
    thumbs.set(preset.name, { preset, canvas, made });
    return made;
  }

  function open() {
    resolved.clear();
    thumbs.clear();
    drawnAt = "";
    const { modality_guess: kind, preset_guess: guess } = app.volume;
    const fits = (p) => (p.name === guess ? 3 : p.modality === kind ? 2 : p.is_map || !p.stretched ? 0 : 1);
    const presets = [...app.hello.presets];
    if (!presets.some((p) => p.name === guess) && guess) presets.unshift({ name: guess, modality: kind, sentence: "", is_map: false });
    app.presets = presets;
    first = presets.map((p, i) => [p, i]).sort(([a, i], [b, k]) => fits(b) - fits(a) || i - k).map(([p]) => p).slice(0, 10);
    refill();
    functionOf(first[0]).then((tf) => same(tf, store.state.tf) && ((store.state.look = first[0].name), store.redraw())).catch(() => {});
  }

  /** The row: what fits the data, and one's own. */
  function refill() {
    app.presets = [...app.presets.filter((p) => !p.own), ...mine.presets()];
    const before = new Map(thumbs);
    thumbs.clear();
    row.replaceChildren(...[...first, ...mine.presets()].map((p) => before.has(p.name) && !p.own ? (thumbs.set(p.name, before.get(p.name)), before.get(p.name).made) : button(p)));
    drawnAt = "";
    rest();
  }
  /** "Save as…": kept by this browser, under Mine; a name that is taken is replaced. */
  function saveAs(name) {
    const transfer_function = transferOf(store.state.tf);
    mine.keep([...mine.all().filter((look) => look.name !== name), { name, transfer_function }]);
    store.set(words.saveLook, () => ({ look: `mine:${name}` }));
    refill();
  }

  /** Renders thumbnails once the picture is at rest, and again when the camera has moved. They need no light, and do not wait for it. */
  function rest() {
    timer ||= setTimeout(() => {
      timer = 0;
      const camera = JSON.stringify([store.state.camera, store.state.values["clip.box"], store.state.values["clip.planes"], app.volume?.name]);
      if (store.dragging) return;
      if (camera !== drawnAt) (drawnAt = camera), (queue = [...thumbs.values()]);
      next(); // or goes on where a change stopped it
    }, 400);
  }
  async function next() {
    if (busy || store.dragging) return;
    const thumb = queue.shift();
    if (!thumb?.canvas.isConnected) return thumb && next();
    busy = true;
    const tf = await functionOf(thumb.preset).catch(() => null);
    if (tf) await app.link.ask("look", { scene: app.sceneWith({ tf }), size }, (frame, data) => data && createImageBitmap(data).then((b) => thumb.canvas.getContext("2d").drawImage(b, 0, 0, ...size))).catch(() => {});
    busy = false;
    next();
  }

  function all() {
    const find = el("input", { type: "search", placeholder: words.findLook, "aria-label": words.findLook, oninput: () => fill() }), list = el("div.list");
    const fill = () => {
      const groups = new Map();
      for (const p of app.presets) if (`${p.name} ${label(p)} ${p.sentence}`.toLowerCase().includes(find.value.toLowerCase())) {
        const group = p.is_map ? words.groups.map : words.groups[p.modality.toLowerCase()] ?? p.modality;
        groups.set(group, [...(groups.get(group) ?? []), p]);
      }
      list.replaceChildren(...[...groups].flatMap(([group, presets]) => [el("h2", {}, group), ...presets.map((p) => el("div.line-of", {}, el("button.item", { onclick: () => take(p), title: p.sentence }, label(p)),
        p.own ? el("button", { title: words.remove, "aria-label": `${words.remove}: ${label(p)}`, onclick: () => (mine.keep(mine.all().filter((look) => `mine:${look.name}` !== p.name)), refill(), fill()) }, icon("close")) : null))]));
    };
    fill();
    const reset = store.state.look && edited() ? el("button.plain", { onclick: () => take(app.presets.find((p) => p.name === store.state.look)) }, words.resetLook) : null;
    const name = el("input", { type: "text", placeholder: words.lookName, "aria-label": words.lookName, maxLength: 40, required: true });
    const save = el("form.line-of", { onsubmit: (e) => (e.preventDefault(), saveAs(name.value.trim()), app.menus.close()) }, name, el("button.plain", { type: "submit" }, words.saveLook));
    app.popover(says, el("div.stack", {}, find, list, save, reset));
    find.focus();
  }
  const edited = () => {
    const preset = app.presets?.find((p) => p.name === store.state.look), tf = preset?.own ? split(preset.own) : resolved.get(store.state.look);
    return preset && tf && !same(preset.is_map ? { ...store.state.tf, stops: tf.stops } : tf, store.state.tf) && !preset.is_map;
  };
  store.watch(() => {
    if (!app.presets) return;
    const preset = app.presets.find((p) => p.name === store.state.look), name = preset ? label(preset) : words.ownLook;
    says.replaceChildren(edited() ? words.edited(name) : name, icon("right"));
    for (const [key, { made }] of thumbs) made.setAttribute("aria-pressed", String(key === store.state.look));
  }, { camera: false });
  return { section, open, rest, pause: () => (clearTimeout(timer), (timer = 0)), take };
}
