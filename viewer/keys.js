// Shortcuts. Single keys act only outside text fields and can be switched off.
import { words } from "./texts.js";

const springs = { o: "orbit", a: "adjust", l: "light", c: "cut", m: "measure" };

export function makeKeys(app) {
  const { store } = app, held = new Map();
  const inText = (target) => /^(input|select|textarea)$/i.test(target.tagName) && !["checkbox", "color", "range"].includes(target.type);
  const mode = (name) => store.set(words.modes[name][0], (s) => ({ values: { ...s.values, mode: name }, ...(name === "iso" && !s.iso.length ? { iso: [{ value: app.firstSurface() }] } : {}) }));
  app.mode = mode;

  const withCtrl = { z: (e) => store.step(e.shiftKey ? "redo" : "undo"), y: () => store.step("redo"), s: (e) => (e.shiftKey ? app.menus.saveScene() : app.save(app.bar.save)), o: () => app.states.choose() };
  const single = { 1: () => mode("dvr"), 2: () => mode("iso"), 3: () => mode("mip"), f: () => app.gestures.fit(), h: () => (document.body.classList.toggle("bare"), app.resized()), i: () => app.menus.about(app.bar.file),
    s: () => app.toggleSlices(), k: () => app.addKey(), e: () => app.dock(), r: () => app.compare.start(), w: () => app.fitWindow(), "[": () => app.colour.density(1 / 1.1), "]": () => app.colour.density(1.1), "?": () => app.menus.shortcuts(app.bar.more),
    0: () => ((app.graph.axis.view = [...app.graph.axis.range]), store.redraw()) };

  addEventListener("keydown", (event) => {
    const key = event.key.toLowerCase();
    if (key === "escape" && !event.defaultPrevented) return app.compare.on ? app.compare.stop() : document.body.classList.remove("bare");
    if ((event.ctrlKey || event.metaKey) && withCtrl[key] && !(inText(event.target) && key === "z")) {
      if (!app.volume && key !== "o") return;
      event.preventDefault();
      return withCtrl[key](event);
    }
    if (!app.volume || event.ctrlKey || event.metaKey || inText(event.target) || app.menus.open) return;
    if (event.altKey) return key === "z" ? (event.preventDefault(), store.step(event.shiftKey ? "redo" : "undo", "camera")) : undefined;
    if (!app.keysOn()) return;
    const view = event.shiftKey && app.cross.key(key);
    if (view) return app.turnTo(view);
    if (event.repeat && !"[]".includes(key)) return;
    if (key === "b") return held.set(key, null), app.light.unlit(true);
    if (key in springs) {
      // A press switches; held, the tool is borrowed until the key is let go.
      held.set(key, { before: app.ui.tool, at: event.timeStamp });
      return app.gestures.choose(springs[key]);
    }
    if (key in single) event.preventDefault(), single[key]();
  });
  addEventListener("pointerdown", () => held.forEach((spring) => spring && (spring.used = true)), true);
  addEventListener("keyup", (event) => {
    const key = event.key.toLowerCase(), spring = held.get(key);
    if (!held.delete(key)) return;
    if (key === "b") app.light.unlit(false);
    else if (spring && (spring.used || event.timeStamp - spring.at > 350)) app.gestures.choose(spring.before);
  });
}
