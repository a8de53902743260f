// The upright lines of the graph that are dragged: shutters of the threshold, surfaces, the ends of what glows.
import { arrow, clamp, el, endMoved, tell } from "./dom.js";
import { draggable } from "./rows.js";
import { read } from "./scene.js";
import { words } from "./texts.js";

export function makeMarkers(app, axis, plot) {
  const { store } = app;
  let lines = [], made = "";

  /** @param {{kind: string, label: string, tip: string, step: string, now: () => number, put: (value: number) => void, clear?: () => void}} o */
  function line(o) {
    const part = el(`div.shutter.${o.kind}`, { role: "slider", tabIndex: 0, "aria-label": o.label, title: o.tip }, el("i"));
    draggable(part, store, o.step, o.now, (start, dx) => o.put(clamp(start + dx * axis.pixel, ...axis.range)));
    if (o.clear) part.addEventListener("dblclick", o.clear);
    part.addEventListener("keydown", (event) => {
      const step = arrow(event);
      if (!step) return;
      event.preventDefault();
      o.put(clamp(o.now() + step * axis.pixel * (event.shiftKey ? 10 : 1), ...axis.range));
    });
    return Object.assign(part, { now: o.now });
  }
  const limits = () => store.state.threshold ?? axis.range;
  const shutter = (which) => line({ kind: "limit", label: words.shutter[which], tip: `${words.threshold}: what lies outside is transparent. --threshold`, step: words.threshold, now: () => limits()[which],
    put: (value) => store.set(`${words.threshold}…`, () => {
      const next = endMoved(limits(), which, value);
      return { threshold: next[0] <= axis.range[0] && next[1] >= axis.range[1] ? null : next };
    }), clear: () => store.set(words.threshold, () => ({ threshold: null })) });
  const surface = (i) => line({ kind: "value", label: words.surfaceValue, tip: `${words.surfaceValue}. --iso`, step: words.surface, now: () => store.state.iso[i]?.value ?? 0,
    put: (value) => store.set(`${words.surface}…`, (s) => ({ iso: s.iso.map((one, k) => (k === i ? { ...one, value } : one)) })) });
  const glow = (which) => line({ kind: "value", label: which ? `${words.effects.glow} ${words.to}` : words.glow[0], tip: `${words.effects.glow}. --glow`, step: words.effects.glow, now: () => app.glowNow()?.[which] ?? 0, put: (value) => app.setGlow(endMoved(app.glowNow(), which, value)) });

  return { draw(state) {
    const surfaces = read(state, "mode") === "iso" ? state.iso.length : 0, glows = Boolean(app.glowNow?.()), wanted = `${surfaces} ${glows}`;
    if (made !== wanted) {
      made = wanted;
      lines.forEach((part) => part.remove());
      lines = [shutter(0), shutter(1), ...state.iso.slice(0, surfaces).map((_, i) => surface(i)), ...(glows ? [glow(0), glow(1)] : [])];
      plot.append(...lines);
    }
    for (const part of lines) {
      const value = part.now(), x = clamp(axis.x(value), axis.left, axis.left + axis.width), is = part.classList.contains("limit");
      part.style.cssText = `transform:translate(${x}px,${axis.top}px);height:${axis.height}px;${!is && x !== axis.x(value) ? "visibility:hidden" : ""}`;
      part.classList.toggle("drawn", is && Boolean(state.threshold));
      tell(part, value, app.withUnit(value));
    }
  } };
}
