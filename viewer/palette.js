// Colours at hand in the system's picker: those of the peaks, and the last eight that were picked.
import { el, hex } from "./dom.js";

export function makePalette(app) {
  const list = el("datalist", { id: "palette" }), kept = JSON.parse(localStorage.getItem("colours") ?? "[]");
  const show = () => list.replaceChildren(...[...new Set([...(app.volume ? app.graph.peaks().map((peak) => hex(peak.rgb)) : []), ...kept])].map((value) => el("option", { value })));
  addEventListener("change", ({ target }) => {
    if (target.type !== "color") return;
    kept.splice(0, kept.length, ...[...new Set([target.value, ...kept])].slice(0, 8));
    localStorage.setItem("colours", JSON.stringify(kept));
    show();
  }, true);
  app.store.watch(show, { camera: false });
  document.body.append(list);
}
