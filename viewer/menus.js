// Popovers and menus, About this volume, shortcuts.
import { chooseFile, download, el, short } from "./dom.js";
import { words } from "./texts.js";

export function makeMenus(app) {
  let open = null;
  const close = () => {
    if (!open) return;
    const { box, anchor, away } = open;
    open = null;
    removeEventListener("pointerdown", away, true);
    box.remove();
    anchor.setAttribute("aria-expanded", "false");
    anchor.focus({ preventScroll: true });
  };
  /** A float beside its button; Esc and a press elsewhere close it. */
  function popover(anchor, content, role = "dialog") {
    const again = open?.anchor === anchor;
    close();
    if (again) return;
    const box = el("div.popover", { role, tabIndex: -1, style: "visibility:hidden;z-index:9" }, content), at = anchor.getBoundingClientRect();
    if (role === "dialog") box.setAttribute("aria-label", anchor.title || anchor.textContent || words.more);
    document.body.append(box);
    const left = Math.max(8, Math.min(at.right - box.offsetWidth, innerWidth - box.offsetWidth - 8)), below = at.bottom + 6 + box.offsetHeight < innerHeight;
    box.style.cssText = `left:${at.left + box.offsetWidth < innerWidth - 8 ? Math.max(8, at.left) : left}px;top:${below ? at.bottom + 6 : Math.max(8, at.top - box.offsetHeight - 6)}px;z-index:9`;
    const away = (event) => !box.contains(event.target) && !anchor.contains(event.target) && close();
    addEventListener("pointerdown", away, true);
    box.addEventListener("keydown", (event) => {
      if (event.key === "Escape") event.stopPropagation(), close();
      const items = [...box.querySelectorAll(".item")], step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
      if (role === "menu" && step) event.preventDefault(), items[(items.indexOf(document.activeElement) + step + items.length) % items.length].focus();
    });
    anchor.setAttribute("aria-expanded", "true");
    open = { box, anchor, away };
    (box.querySelector("button, input, select") ?? box).focus(); // which hears Esc
    return box;
  }
  /** A menu of [name, act, note?]. */
  const menu = (anchor, items) => popover(anchor, el("div", {}, ...items.map(([name, act, note]) => el("button.item", { role: "menuitem", title: note ?? "", onclick: () => (close(), act()) }, name, note && note.length < 16 ? el("span", {}, note) : null))), "menu");

  function about(anchor) {
    const v = app.volume, w = words.about;
    if (!v) return;
    const rows = [[w.dimensions, v.dimensions.join(" × ")], [w.type, v.type], [w.spacing, `${v.spacing_mm.map((s) => short(s)).join(" × ")} ${v.spacing_stated === false ? w.unitless : "mm"}`], [w.range, [short(v.range[0]), words.to, short(v.range[1]), v.unit, v.statistics === "sampled" && w.sampled].filter(Boolean).join(" ")],
      [w.percentiles, ["1", "50", "99", "99.9"].map((p) => short(v.percentiles[p])).join(", ")], [w.frame, v.world === "unknown" ? w.unknown : v.world], [w.guess, v.modality_guess]];
    if (v.levels) rows.push([w.bricks, w.levels(v.levels)]);
    if (v.nonfinite) rows.push([w.nonfinite, String(v.nonfinite)]);
    rows.push([w.use, w.notForDiagnosis]);
    for (const note of app.doubts()) rows.push([w.notes, note]);
    popover(anchor, el("div", {}, el("h2", {}, v.name), el("dl", {}, ...rows.flatMap(([k, x]) => [el("dt", {}, k), el("dd", {}, x)])), el("div.buttons", {}, el("button", { onclick: () => app.copy(JSON.stringify(v, null, 1)) }, w.copy))));
  }
  const shortcuts = (anchor) => popover(anchor, el("div", {}, el("h2", {}, words.menu.shortcuts), el("dl", {}, ...words.shortcuts.flatMap(([k, what]) => [el("dt", {}, k), el("dd", {}, what)])),
    el("label.check", {}, el("input", { type: "checkbox", checked: app.keysOn(), onchange: (e) => localStorage.setItem("keys", e.target.checked ? "on" : "off") }), words.menu.keys)));

  const themes = [["dark", words.menu.dark], ["light", words.menu.lightTheme], ["system", words.menu.system]];
  const saveScene = async () => {
    const answer = await app.link.ask("export", { what: "scene", scene: app.scene() }).catch(app.fault);
    if (answer) download(new Blob([answer.text], { type: "application/json" }), answer.name ?? "scene.json");
  };
  const command = async () => {
    const answer = await app.link.ask("command", { scene: app.scene(), output: "picture.png" }).catch(app.fault);
    if (answer) app.copy(answer.text);
  };
  const link = async () => app.copy(await (await import("./share.js")).linkOf(app.scene()), words.link.copied);
  const more = (anchor) => menu(anchor, [
    [words.menu.open, () => app.states.choose(), "Ctrl O"], [words.menu.send, app.states.sendFile], [words.menu.sendFolder, app.states.sendFolder],
    // What a narrow bar has no room for.
    ...(app.volume && !app.bar.compare.offsetParent ? [...Object.entries(words.modes).map(([name, [label]]) => [label, () => app.mode(name)]), [words.redo, () => app.store.step("redo")], [words.compare, app.compare.start]] : []),
    ...(app.volume ? [[words.menu.film, app.toggleFilm], [words.tools.measure, () => app.gestures.choose("measure"), "M"], [words.menu.saveScene, saveScene, "Ctrl Shift S"], [words.menu.loadScene, () => chooseFile(".json,.png,.exr", app.take)], [words.menu.loadTf, () => chooseFile("", app.take)], [words.menu.labels, app.chooseLabels], [words.menu.command, command], [words.link.copy, link]] : []),
    ...themes.map(([key, name]) => [`${words.menu.theme}: ${name}`, () => app.theme.set(key), app.theme.now === key ? "✓" : ""]),
    [words.menu.shortcuts, () => shortcuts(anchor), "?"], ...(app.volume ? [[words.menu.about, () => about(anchor), "I"]] : [])]);
  return { popover, menu, close, about, shortcuts, more, saveScene, command, get open() { return open !== null; } };
}
