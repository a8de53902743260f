// What changes with time: a slider over the moments, and play. Loaded for volumes that have several.
import { el, icon, short } from "./dom.js";
import { momentWords as w } from "./part-texts.js";
import { styled } from "./styles.js";

/** The longest that a moment stays while playing, at least, in seconds: as films have them. */
const frame = 1 / 25;

/** @param {any} app @param {HTMLElement} stage */
export async function makeMoments(app, stage) {
  await styled("moments.css");
  const { store } = app, told = () => app.volume.moments;
  let playing = false, asked = 0, began = 0, timer = 0;
  const now = () => store.state.rest.volume?.time ?? 0, next = (i) => (i + 1) % told().count;
  const at = (s, i) => ({ rest: { ...s.rest, volume: { ...s.rest.volume, time: i } } });
  const when = (i) => (told().times.length ? `${told().unit === "file" ? "" : `${short(told().times[i])} ${told().unit}`}`.trim() : "");
  /** A step that can be undone; sliding is one. */
  const go = (i) => store.set(`${w.went}…`, (s) => at(s, i));

  /** Each moment is shown once it is whole, in its own light; the one after it is read meanwhile. */
  function ask(i) {
    asked = i;
    began = performance.now();
    const { marks, slices, ...scene } = app.sceneWith(at(store.state, i));
    store.show({ scene, moving: false, next: next(i) });
    store.redraw();
  }
  function stop() {
    if (!playing) return;
    playing = false;
    clearTimeout(timer);
    store.show(null);
    go(asked);
  }
  const toggle = () => (playing ? stop() : ((playing = true), ask(next(now()))));
  /** A frame came: the next may be asked for. */
  function shown(header) {
    if (!playing || header.n !== app.link.n || header.stage === "draft" || header.moment?.voxels !== asked || header.moment.light !== asked) return;
    clearTimeout(timer);
    timer = setTimeout(() => playing && ask(next(asked)), Math.max(0, 1000 * frame - (performance.now() - began)));
  }

  const play = el("button.tool", { onclick: toggle }), said = el("span");
  const slider = el("input", { type: "range", min: "0", step: "1", "aria-label": w.title, oninput: () => ((playing = false), store.show(null), go(Number(slider.value))) });
  const root = el("div.float.moments", { role: "group", "aria-label": w.title }, play, slider, said);
  store.watch(() => {
    if (!root.isConnected) return;
    const i = playing ? asked : now();
    const mark = playing ? "pause" : "play";
    if (play.dataset.of !== mark) (play.dataset.of = mark), play.replaceChildren(icon(mark)), play.setAttribute("aria-label", playing ? w.pause : w.play), (play.title = playing ? w.pause : w.play);
    slider.max = String(told().count - 1);
    slider.value = String(i);
    said.textContent = [w.of(i, told().count), when(i)].filter(Boolean).join(", ");
    slider.setAttribute("aria-valuetext", said.textContent);
  });
  const api = { root, shown, toggle, stop, get playing() { return playing; },
    open() {
      (playing = false), clearTimeout(timer);
      (app.volume.moments?.count ?? 1) > 1 ? stage.append(root) : root.remove();
      store.redraw();
    } };
  api.open();
  return api;
}
