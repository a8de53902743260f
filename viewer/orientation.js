// The orientation cross and the scale bar.
import { dot, namedView } from "./camera.js";
import { scaleBar } from "./captions.js";
import { el, renew, svg } from "./dom.js";
import { words } from "./texts.js";

const colours = ["#f07b6d", "#8dc063", "#7aa7f0"];

export function makeCross(app, stage) {
  const cross = el("div.cross", { role: "group", "aria-label": words.camera }), lines = svg("svg");
  const text = el("span"), scale = el("div.scale", { role: "img" }, text);
  let letters = [];
  /** Named sides where the file states its frame (LPS: +x is left), else the axes. */
  function open() {
    const world = app.volume.world, sign = world === "RAS" ? -1 : 1;
    letters = world === "unknown" ? [["x", [1, 0, 0], "+x"], ["y", [0, 1, 0], "+y"], ["z", [0, 0, 1], "+z"]]
      : [["L", [sign, 0, 0], "left"], ["R", [-sign, 0, 0], "right"], ["P", [0, sign, 0], "posterior"], ["A", [0, -sign, 0], "anterior"], ["S", [0, 0, 1], "superior"], ["I", [0, 0, -1], "inferior"]];
    cross.replaceChildren(lines, ...letters.map(([letter, , view]) => el("button", { title: words.views[view] ?? view, "aria-label": words.views[view] ?? view, onclick: () => app.turnTo(view) }, letter)));
  }
  app.turnTo = (view) => app.gestures.fly(namedView(view, app.volume.world));
  app.store.watch(() => {
    if (!app.volume) return;
    const height = stage.clientHeight; // before anything is written: else the page is laid out twice
    const view = app.view(), mid = 36, length = letters.length > 3 ? 24 : 26;
    let paths = "";
    letters.forEach(([, axis], i) => {
      const x = mid + length * dot(axis, view.right), y = mid - length * dot(axis, view.up), depth = dot(axis, view.forward), colour = colours[axis.findIndex((a) => a)];
      paths += `<path d="M${mid} ${mid}L${x.toFixed(1)} ${y.toFixed(1)}" stroke="${colour}" stroke-width="1.5" opacity="${depth > 0.1 ? 0.4 : 1}"/>`;
      const button = cross.children[i + 1];
      button.style.cssText = `left:${x}px;top:${y}px;--own:${colour};z-index:${depth > 0 ? 0 : 1};${depth > 0.1 ? "opacity:.75" : ""}`;
    });
    lines.innerHTML = paths;
    const bar = scaleBar(app, view, height);
    scale.style.width = `${bar.pixels}px`;
    renew(text, "textContent", bar.text);
    scale.title = view.perspective ? "Holds at the centre" : "";
  });
  stage.append(cross, scale);
  return { open, key: (letter) => letters.find(([l]) => l.toLowerCase() === letter)?.[2] };
}
