// Compare: the reference at the right of a wipe line, with its figures.
import { clamp, el, icon, percent, seconds, short } from "./dom.js";
import { method } from "./scene.js";
import { words } from "./texts.js";

export function makeCompare(app, stage) {
  const canvas = el("canvas"), line = el("div.wipe", { role: "slider", tabIndex: 0, "aria-label": words.wipe.line, "aria-valuemin": "0", "aria-valuemax": "100" }, el("i", {}, icon("wipe")));
  const left = el("div.float.label-float.own"), right = el("div.float.label-float"), figures = el("div.float.label-float.figures");
  const difference = el("button.tool", { "aria-pressed": "false", onclick: () => ((differs = !differs), difference.setAttribute("aria-pressed", String(differs)), redraw()) }, words.wipe.difference);
  let asked = null, share = 0.5, differs = false, reference = null, own = null, key = "";

  function place() {
    const x = share * stage.clientWidth;
    line.style.left = `${x}px`;
    line.setAttribute("aria-valuenow", String(Math.round(100 * share)));
    canvas.style.clipPath = `inset(0 0 0 ${x}px)`;
    // The labels stand beside the line as far as the picture reaches.
    const within = (part, at) => (part.style.left = `${clamp(at, 8, Math.max(8, stage.clientWidth - part.offsetWidth - 8))}px`);
    within(left, Math.min(x, stage.clientWidth - right.offsetWidth) - left.offsetWidth - 16);
    within(right, Math.max(x + 16, left.offsetLeft + left.offsetWidth + 8));
    within(figures, x + 16);
  }
  /** The reference as it came, or four times the distance to the page's own picture. */
  function redraw() {
    if (!reference) return;
    const { width, height } = reference, g = canvas.getContext("2d");
    Object.assign(canvas, { width, height });
    g.drawImage(reference, 0, 0);
    if (!differs || !own) return;
    g.globalCompositeOperation = "difference";
    g.drawImage(own, 0, 0, width, height);
    g.globalCompositeOperation = "lighter";
    for (let i = 0; i < 2; ++i) g.drawImage(canvas, 0, 0); // ×2 each
  }
  function start() {
    if (asked) return stop();
    const now = method(app.store.state), begun = performance.now();
    key = JSON.stringify(app.scene());
    left.replaceChildren(el("b", {}, words.methods[now][0]), el("span", {}, seconds(app.frame.last?.seconds ?? 0)));
    right.replaceChildren(el("b", {}, words.wipe.reference), el("span", {}, "…"));
    figures.replaceChildren(difference);
    stage.append(canvas, line, left, right, figures);
    place();
    const job = (asked = app.link.ask("compare", { scene: app.scene(), size: app.frame.size() }, async (message, data) => {
      if (!data) return;
      const picture = await createImageBitmap(data);
      if (asked !== job) return;
      if (message.kind === "method") own = picture;
      else {
        reference = picture;
        right.lastChild.textContent = `${words.wipe.rays(message.samples)}, ${seconds((performance.now() - begun) / 1000)}`;
        tell(message.figures);
      }
      redraw();
    }));
    job.then((answer) => asked === job && tell(answer.figures)).catch((error) => asked === job && (stop(), error.code !== "interrupted" && app.fault(error)));
    line.focus({ preventScroll: true });
    app.bar.compare.setAttribute("aria-pressed", "true");
  }
  function tell(f) {
    if (!f) return;
    const part = (name, value) => el("span", {}, `${name} `, el("b", {}, value));
    figures.replaceChildren(part("RMSE", short(f.rmse, 2)), part("PSNR", `${f.psnr === null ? "–" : f.psnr.toFixed(1)} dB`), part("SSIM", short(f.ssim, 3)), part("Max", short(f.max, 2)), ...(f.noise ? [el("span", {}, words.wipe.noise(percent(f.noise)))] : []), difference);
    if (differs) figures.append(el("span", {}, words.wipe.differenceScale));
    place();
  }
  function stop() {
    if (!asked) return;
    const { id } = asked;
    asked = reference = own = null;
    app.link.cancel(id);
    for (const part of [canvas, line, left, right, figures]) part.remove();
    app.bar.compare.setAttribute("aria-pressed", "false");
  }
  line.addEventListener("pointerdown", (event) => {
    line.setPointerCapture(event.pointerId);
    line.onpointermove = (e) => ((share = clamp((e.clientX - stage.getBoundingClientRect().left) / stage.clientWidth, 0.02, 0.98)), place());
    line.onpointerup = () => (line.onpointermove = null);
  });
  line.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -0.01, ArrowRight: 0.01 }[event.key];
    if (step) event.preventDefault(), event.stopPropagation(), (share = clamp(share + step * (event.shiftKey ? 10 : 1), 0.02, 0.98)), place();
  });
  // A change of the picture ends it: what is compared must be what is seen.
  app.store.watch(() => asked && JSON.stringify(app.scene()) !== key && stop());
  addEventListener("resize", () => asked && place());
  return { start, stop, get on() { return asked !== null; } };
}
