// Labels: a list that can be searched, with eye, colour, tint and opacity of each. Loaded for scenes that have them.
import { el, fromHex, hex, icon, percent } from "./dom.js";
import { sliderRow } from "./rows.js";
import { read, write } from "./scene.js";
import { styled } from "./styles.js";
import { labelWords as w } from "./part-texts.js";
import { words } from "./texts.js";

const most = 200; // rows at a time: who looks for one of more types a part of its name

/** The labels as the scene's changes leave them; a change without a value is of all but 0. */
export function changed(labels, changes) {
  const looks = new Map(labels.map((label) => [label.value, { ...label }]));
  for (const { value, ...to } of changes)
    for (const label of value === undefined ? [...looks.values()].filter((one) => one.value !== 0) : [looks.get(value)].filter(Boolean)) Object.assign(label, to);
  return [...looks.values()];
}

/** The changes with one more: what it makes needless goes. */
export function withChange(changes, { value, ...to }) {
  const rest = changes.map((one) => (value === undefined ? one.value !== 0 : one.value === value) ? Object.fromEntries(Object.entries(one).filter(([key]) => !(key in to))) : one);
  const last = rest.findLastIndex((one) => one.value === value), after = rest.slice(last + 1);
  // Merged with what was said of it last, where nothing that is of all came after that.
  if (value !== undefined && last >= 0 && !after.some((one) => one.value === undefined)) rest[last] = { ...rest[last], ...to };
  else rest.push(value === undefined ? to : { value, ...to });
  return rest.filter((one) => Object.keys(one).some((key) => key !== "value"));
}

export async function makeLabels(app) {
  await styled("parts.css");
  const { store } = app, changes = () => store.state.rest.labels?.changes ?? [], file = () => read(store.state, "labels.file"), table = () => read(store.state, "labels.table");
  let labels = [], looks = [], lookOfValue = new Map(), from = "", seenChanges = null, chosen = -1, voxels = 1;
  const put = (label, ...more) => store.set(label, (s) => {
    const next = more.reduce(withChange, s.rest.labels?.changes ?? []);
    const { labels: _, ...rest } = s.rest;
    return { rest: next.length ? { ...rest, labels: { ...s.rest.labels, changes: next } } : rest };
  });
  const lookOf = (value) => lookOfValue.get(value);
  const ask = (type, more = {}) => app.link.ask(type, { labels: { file: file(), ...(table() ? { table: table() } : {}), ...(changes().length ? { changes: changes() } : {}) }, ...more });

  const search = el("input", { type: "search", placeholder: w.search, "aria-label": w.search, autocomplete: "off", spellcheck: false, oninput: () => ((first = ""), store.redraw()), onkeydown: (e) => e.key === "Escape" && search.value && (e.stopPropagation(), (search.value = ""), store.redraw()) });
  const list = el("div.label-list", { role: "list", "aria-label": w.title }), said = el("p.sentence"), details = el("div", { hidden: true });
  const buttons = el("div.buttons", {}, el("button", { onclick: () => put(w.showAll, { show: true }) }, w.showAll), el("button", { onclick: () => put(w.hideAll, { show: false }) }, w.hideAll), el("button", { onclick: () => put(w.onlyFound, { show: false }, ...found().filter((one) => one.value !== 0).map(({ value }) => ({ value, show: true }))) }, w.onlyFound), el("button", { onclick: () => store.set(w.reset, (s) => { const { labels: _, ...rest } = s.rest; return { rest }; }) }, w.reset));
  const head = el("div.head", {}, el("h2", {}, w.title));
  const root = el("section.section.open.s-labels.s-colour", { hidden: true }, head, search, list, said, details, buttons);
  let first = ""; // of the rows that stand there

  const found = () => {
    const text = search.value.trim().toLowerCase();
    return looks.filter((one) => !text || one.name.toLowerCase().includes(text) || String(one.value) === text);
  };
  const solo = (value) => {
    const alone = looks.every((one) => one.value === 0 || one.show === (one.value === value));
    alone ? put(w.solo, { show: true }) : put(w.solo, { show: false }, { value, show: true });
  };
  function row(one) {
    const { value } = one, now = () => lookOf(value);
    const eye = el("button.tool", { title: w.eyeTip, onclick: (e) => (e.altKey ? solo(value) : put(w.shown, { value, show: !now().show })), onkeydown: (e) => e.key === "Enter" && e.altKey && (e.preventDefault(), solo(value)) }, icon("eye"));
    const swatch = el("input.swatch", { type: "color", "aria-label": `${words.colourField}: ${one.name}`, oninput: () => put(`${words.colourField}…`, { value, rgb: fromHex(swatch.value), ...(now().tint === 0 ? { tint: 1 } : {}) }) });
    const name = el("button.channel-name", { onclick: () => choose(value === chosen ? -1 : value) }, one.name);
    return Object.assign(el("div.label-row", { role: "listitem" }, eye, swatch, name, el("small", {}, percent(one.voxels / voxels))), { value, show() {
      const look = now();
      this.classList.toggle("hidden-one", !look.show);
      eye.setAttribute("aria-pressed", String(look.show));
      eye.setAttribute("aria-label", `${look.show ? w.hide : w.show}: ${one.name}`);
      swatch.value = hex(look.rgb);
      name.setAttribute("aria-pressed", String(value === chosen));
    } });
  }
  const share = (label, key, tip) => sliderRow(app, { label, tip, low: 0, high: 1, step: 0.01, value: () => lookOf(chosen)?.[key] ?? 1, change: (v) => put(`${label}…`, { value: chosen, [key]: v }) });
  const more = [share(w.tint, "tint", w.tintTip), share(words.opacity, "opacity", w.opacityTip)];
  details.append(...more);

  /** Chosen in the list or in the picture: its row is seen, its numbers stand below. */
  function choose(value, { reveal = false } = {}) {
    chosen = value;
    if (reveal && value >= 0 && !found().slice(0, most).some((one) => one.value === value)) (search.value = lookOf(value)?.name ?? ""), (first = "");
    show();
    if (reveal) [...list.children].find((one) => one.value === value)?.scrollIntoView({ block: "nearest" });
  }
  /** Of a place in the world: {value, name}, or nothing where there are no labels. */
  const at = (point) => (root.hidden ? Promise.resolve(null) : ask("label", { at: point }).catch(() => null));
  async function clicked(point) {
    const label = await at(point);
    if (label) choose(label.value, { reveal: true });
  }

  function show() {
    if (seenChanges !== changes()) (seenChanges = changes()), (looks = changed(labels, seenChanges)), (lookOfValue = new Map(looks.map((one) => [one.value, one])));
    const rows = found(), key = rows.slice(0, most).map((one) => one.value).join();
    if (key !== first) (first = key), list.replaceChildren(...rows.slice(0, most).map(row));
    for (const one of list.children) one.show();
    said.textContent = rows.length > most ? w.others(rows.length - most) : rows.length ? "" : w.none;
    said.hidden = !said.textContent;
    details.hidden = chosen < 0 || !lookOf(chosen);
    if (!details.hidden) more.forEach((one) => one.show());
  }
  async function load() {
    const of = JSON.stringify([app.volume.file, file(), table()]);
    if (of === from || !app.link.open) return;
    from = of;
    const answer = await app.link.ask("labels", { labels: { file: file(), ...(table() ? { table: table() } : {}) } }).catch((error) => ((from = ""), app.fault(error)));
    if (!answer || of !== from) return;
    labels = answer.labels;
    voxels = labels.reduce((sum, one) => sum + one.voxels, 0);
    (seenChanges = null), (first = ""), (chosen = -1);
    show();
  }
  store.watch(() => {
    root.hidden = !app.volume || !file();
    if (root.hidden) return;
    load();
    if (labels.length) show();
  }, { camera: false });
  /** A segmentation of the volume, which lies over it from now on. */
  const chooseFile = () => app.states.choose(({ path }) => store.set(words.menu.labels, (s) => {
    const { labels: _, ...rest } = s.rest;
    return { rest, ...write({ ...s, ...write(s, "labels.table", null) }, "labels.file", path) };
  }));
  return { root, at, chooseFile, clicked, choose, open: () => (from = "") };
}
