// What stands in the picture's place or over it: no volume, reading, errors, banners; and opening files.
import { bytes, el, icon, percent, svg } from "./dom.js";
import { words } from "./texts.js";

const w = words.states;
export const mark = () => svg("svg", { viewBox: "0 0 20 20", fill: "none", "aria-hidden": "true" }, svg("circle", { cx: 10, cy: 10, r: 8.75, stroke: "currentColor", "stroke-width": 1.5 }), svg("path", { d: "M10 4a6 6 0 0 1 0 12z", fill: "var(--accent)" }));

/** Volumes that were open here, newest first, with a small picture of each: of this browser, for this address. */
export const recent = {
  list: () => JSON.parse(localStorage.getItem("recent") ?? "[]"),
  remember(file, name, picture) {
    if (/\/chiaro-view-/.test(file)) return; // what was sent goes with the server
    localStorage.setItem("recent", JSON.stringify([{ file, name, picture }, ...recent.list().filter((one) => one.file !== file)].slice(0, 8)));
  },
};

export function makeStates(app, stage) {
  let shown = null, banner = null, timer = 0;
  const show = (...children) => {
    shown?.remove();
    shown = el("div.state", {}, ...children);
    stage.append(shown);
  };
  const clear = () => (shown?.remove(), (shown = null), clearTimeout(timer));

  function empty() {
    document.body.classList.add("none");
    stage.classList.add("empty");
    const sample = el("button.plain", { onclick: () => app.menu(sample, app.hello.samples.map((s) => [s.name, () => app.open({ volume: `sample:${s.name}` }), s.sentence])) }, w.sample);
    const known = recent.list();
    show(mark(), el("h1", {}, w.open), el("p", {}, w.formats), el("div.pair", {}, el("button.primary", { onclick: () => sendFile() }, w.send), el("button.plain", { onclick: () => sendFolder() }, w.sendFolder), el("button.plain", { onclick: () => choose() }, w.choose), sample),
      el("small", {}, w.dropHere),
      ...(known.length ? [el("h2", {}, w.recent), el("div.recent", {}, ...known.map((one) => el("button", { title: one.file, onclick: () => app.open({ volume: one.file }) }, el("img", { src: one.picture, alt: "" }), el("span", {}, one.name))))] : []));
  }
  /** Shown after 400 ms, so that nothing flashes. */
  function reading(name, cancel, heading = w.reading(name)) {
    clear();
    const bar = el("i", { style: "width:0" }), text = el("p", { role: "status" });
    timer = setTimeout(() => show(el("h1", {}, heading), el("div.progress", { role: "progressbar", "aria-label": heading }, bar), text, cancel ? el("button", { onclick: cancel }, w.cancel) : null), 400);
    return (m) => {
      bar.style.width = `${100 * (m.fraction ?? 0)}%`;
      text.textContent = [percent(Math.round(100 * (m.fraction ?? 0)) / 100), m.bytes ? bytes(m.bytes) : "", m.seconds > 2 && m.remaining_s ? w.left(Math.round(m.remaining_s)) : ""].filter(Boolean).join(", ");
    };
  }
  /** An error of a file: the library's sentence. A volume already open stays open. */
  function failed(sentence, heading = w.unreadable) {
    show(el("h1", {}, heading), el("p", { role: "alert" }, sentence), el("div.pair", {}, el("button.plain", { onclick: () => choose() }, w.another), el("button", { onclick: () => app.copy(sentence) }, w.copyMessage), app.volume ? el("button", { onclick: clear }, w.back) : null));
  }

  /** One at a time, 40 high, over the picture's top. */
  function say(text, { role = "status", acts = [], keep = false } = {}) {
    hush();
    banner = el("div.float.banner", { role }, icon("info"), el("span", { title: text }, text), ...acts.map(([name, act]) => el("button", { onclick: act }, name)), keep ? null : el("button", { "aria-label": words.close, onclick: hush }, icon("close")));
    stage.append(banner);
    const mine = banner;
    if (!keep && role === "status") setTimeout(() => mine === banner && hush(), 4000);
    return { change: (next) => (mine.querySelector("span").textContent = next) };
  }
  const hush = () => (banner?.remove(), (banner = null));

  const sendFile = () => el("input", { type: "file", multiple: true, onchange: (e) => e.target.files.length && app.sendVolume(chosen(e.target.files)) }).click();
  const sendFolder = () => el("input", { type: "file", webkitdirectory: true, onchange: (e) => e.target.files.length && app.sendVolume(chosen(e.target.files)) }).click();
  const chosen = (files) => [...files].map((file) => ({ file, name: file.webkitRelativePath || file.name }));
  const choose = async (take = app.openEntry) => (await import("./choosing.js")).chooseFile(app, take);
  return { empty, reading, failed, clear, say, hush, choose, sendFile, sendFolder, get blocking() { return shown !== null; } };
}
