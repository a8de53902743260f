// Save image: a popover that stays while the picture is made.
import { captions } from "./captions.js";
import { bytes, el, seconds } from "./dom.js";
import { words } from "./texts.js";

const most = 16384, w = words.saving;

export const makeSaving = (app) => (anchor) => {
  const [cw, ch] = app.frame.size(), sizes = [[w.seen, [cw, ch]], [w.twice, [2 * cw, 2 * ch]], [w.uhd, [3840, 2160]], [w.own, null]];
  const side = (value, name) => el("input", { type: "number", min: "1", max: String(most), value: String(value), "aria-label": name, oninput: () => show() });
  const tick = (checked = false) => el("input", { type: "checkbox", checked });
  const kind = el("select", {}, ...["PNG", "EXR"].map((k) => el("option", {}, k))), size = el("select", { onchange: () => show() }, ...sizes.map(([name, s]) => el("option", {}, s && name !== w.uhd ? `${name}, ${s[0]} × ${s[1]}` : name)));
  const wide = side(cw, w.width), high = side(ch, w.height), own = el("div.buttons", { hidden: true }, wide, high), behind = el("select", {}, el("option", {}, w.seen), el("option", {}, w.transparent));
  const scale = tick(), legend = tick(), keep = tick(true), marks = tick(true), measured = Boolean(app.marks?.list().length);
  const takes = el("small"), bar = el("div.progress", { hidden: true }, el("i", { style: "width:0" })), wrong = el("div.wrong", { hidden: true, role: "alert" });
  const stop = el("button.plain", { type: "button", hidden: true, onclick: () => asked && app.link.cancel(asked.id) }, w.cancel), go = el("button.primary", { type: "submit" }, w.go);
  const pixels = () => sizes[size.selectedIndex][1] ?? [Number(wide.value), Number(high.value)];
  let asked = null;
  const show = () => {
    own.hidden = sizes[size.selectedIndex][1] !== null;
    const cast = app.frame.last?.verbs?.find((v) => v.name === "raycast")?.seconds || app.frame.last?.seconds, [a, b] = pixels();
    takes.textContent = cast ? w.takes(seconds(Math.max(0.1, (cast * a * b) / (cw * ch)))) : "";
  };
  async function save(event) {
    event.preventDefault();
    const [a, b] = pixels();
    wrong.hidden = a >= 1 && b >= 1 && a <= most && b <= most;
    wrong.textContent = words.outOfRange(`1 ${words.to} ${most}`);
    if (!wrong.hidden) return;
    const scene = app.scene();
    if (behind.selectedIndex) scene.background = "transparent";
    (go.disabled = true), (bar.hidden = stop.hidden = false);
    const overlays = await captions(app, { scale: scale.checked, legend: legend.checked, marks: measured && marks.checked }, a, b);
    asked = app.link.ask("save", { scene, size: [a, b], format: kind.value.toLowerCase(), metadata: keep.checked, overlays }, (m) => (bar.firstChild.style.width = `${100 * (m.fraction ?? 0)}%`));
    try {
      const answer = await asked;
      el("a", { href: new URL(answer.url.replace(/^\//, ""), location.href).href, download: answer.name }).click();
      app.states.say(`${w.done}: ${answer.name}, ${bytes(answer.bytes)}`);
      if (form.isConnected) app.menus.close();
    } catch (error) {
      if (error.code !== "interrupted") (wrong.hidden = false), (wrong.textContent = error.sentence || String(error));
    }
    (go.disabled = false), (bar.hidden = stop.hidden = true);
  }
  const label = (text, field) => el("label.row.choice", {}, el("span", {}, text), field), check = (field, text) => el("label.check", {}, field, text);
  const form = el("form", { onsubmit: save }, el("h2", {}, w.title), label(w.kind, kind), label(w.size, size), own, label(w.background, behind), check(scale, w.scale), check(legend, w.legend), measured ? check(marks, words.inFigure) : null, check(keep, w.keep), takes, bar, wrong, el("div.buttons", {}, go, stop));
  show();
  app.menus.popover(anchor, form);
};
