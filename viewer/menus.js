// Popovers and menus, Save image, About this volume, shortcuts.
import { bytes, chooseFile, download, el, percent, seconds, short } from "./dom.js";
import { words } from "./words.js";

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

  function save(anchor) {
    const w = words.saving, [cw, ch] = app.frame.size(), sizes = [[w.seen, [cw, ch]], [w.twice, [2 * cw, 2 * ch]], [w.uhd, [3840, 2160]], [w.own, null]];
    const kind = el("select", {}, ...["PNG", "EXR"].map((k) => el("option", {}, k))), size = el("select", { onchange: () => show() }, ...sizes.map(([name, s]) => el("option", {}, s && name !== w.uhd ? `${name}, ${s[0]} × ${s[1]}` : name)));
    const wide = el("input", { type: "number", min: "1", max: "16384", value: String(cw), "aria-label": w.width, oninput: () => show() }), high = el("input", { type: "number", min: "1", max: "16384", value: String(ch), "aria-label": w.height, oninput: () => show() });
    const own = el("div.buttons", { hidden: true }, wide, high), behind = el("select", {}, el("option", {}, w.seen), el("option", {}, w.transparent)), keep = el("input", { type: "checkbox", checked: true });
    const takes = el("small"), bar = el("div.progress", { hidden: true }, el("i", { style: "width:0" })), stop = el("button.plain", { type: "button", hidden: true, onclick: () => asked && app.link.cancel(asked.id) }, w.cancel), go = el("button.primary", { type: "submit" }, w.go), wrong = el("div.wrong", { hidden: true, role: "alert" });
    const pixels = () => sizes[size.selectedIndex][1] ?? [Number(wide.value), Number(high.value)];
    let asked = null;
    const show = () => {
      own.hidden = sizes[size.selectedIndex][1] !== null;
      const cast = app.frame.last?.verbs?.find((v) => v.name === "raycast")?.seconds || app.frame.last?.seconds, [a, b] = pixels();
      takes.textContent = cast ? w.takes(seconds(Math.max(0.1, (cast * a * b) / (cw * ch)))) : "";
    };
    const label = (text, field) => el("label.row.choice", {}, el("span", {}, text), field);
    const form = el("form", { onsubmit: async (event) => {
      event.preventDefault();
      const [a, b] = pixels();
      wrong.hidden = a >= 1 && b >= 1 && a <= 16384 && b <= 16384;
      wrong.textContent = words.outOfRange(`1 ${words.to} 16384`);
      if (!wrong.hidden) return;
      const scene = app.scene();
      if (behind.selectedIndex) scene.background = "transparent";
      (go.disabled = true), (bar.hidden = stop.hidden = false);
      asked = app.link.ask("save", { scene, size: [a, b], format: kind.value.toLowerCase(), metadata: keep.checked }, (m) => (bar.firstChild.style.width = `${100 * (m.fraction ?? 0)}%`));
      try {
        const answer = await asked;
        el("a", { href: new URL(answer.url.replace(/^\//, ""), location.href).href, download: answer.name }).click();
        app.states.say(`${w.done}: ${answer.name}, ${bytes(answer.bytes)}`);
        if (open?.box.contains(form)) close();
      } catch (error) {
        if (error.code !== "interrupted") (wrong.hidden = false), (wrong.textContent = error.sentence || String(error));
      }
      (go.disabled = false), (bar.hidden = stop.hidden = true);
    } }, el("h2", {}, w.title), label(w.kind, kind), label(w.size, size), own, label(w.background, behind), el("label.check", {}, keep, w.keep), takes, bar, wrong, el("div.buttons", {}, go, stop));
    show();
    popover(anchor, form);
  }

  function about(anchor) {
    const v = app.volume, w = words.about;
    if (!v) return;
    const rows = [[w.dimensions, v.dimensions.join(" × ")], [w.type, v.type], [w.spacing, `${v.spacing_mm.map((s) => short(s)).join(" × ")} ${v.spacing_stated === false ? w.unitless : "mm"}`], [w.range, `${short(v.range[0])} ${words.to} ${short(v.range[1])} ${v.unit ?? ""}`],
      [w.percentiles, ["1", "50", "99", "99.9"].map((p) => short(v.percentiles[p])).join(", ")], [w.frame, v.world === "unknown" ? w.unknown : v.world], [w.guess, v.modality_guess]];
    if (v.nonfinite) rows.push([w.nonfinite, String(v.nonfinite)]);
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
  const more = (anchor) => menu(anchor, [
    [words.menu.open, app.states.choose, "Ctrl O"],
    // What a narrow bar has no room for.
    ...(app.volume && !app.bar.compare.offsetParent ? [...Object.entries(words.modes).map(([name, [label]]) => [label, () => app.mode(name)]), [words.redo, () => app.store.step("redo")], [words.compare, app.compare.start]] : []),
    ...(app.volume ? [[words.menu.saveScene, saveScene, "Ctrl Shift S"], [words.menu.loadScene, () => chooseFile(".json,.png,.exr", app.take)], [words.menu.loadTf, () => chooseFile("", app.take)], [words.menu.command, command]] : []),
    ...themes.map(([key, name]) => [`${words.menu.theme}: ${name}`, () => app.theme.set(key), app.theme.now === key ? "✓" : ""]),
    [words.menu.shortcuts, () => shortcuts(anchor), "?"], ...(app.volume ? [[words.menu.about, () => about(anchor), "I"]] : [])]);
  return { popover, menu, close, save, about, shortcuts, more, saveScene, command, get open() { return open !== null; } };
}
