// The picture and what is said about it: frames in order on one rectangle, and the pill.
import { bytes, el, percent, seconds } from "./dom.js";
import { method, read, sceneOf } from "./scene.js";
import { words } from "./texts.js";

/** Shares of the ring that the stages end at. */
const ends = { draft: 0.15, full: 0.25, light: 0.6, reading: 0.9, accumulate: 1, final: 1 };
const starts = { draft: 0, full: 0.15, light: 0.25, reading: 0.25, accumulate: 0.6, final: 1 };

export function makeFrame(app) {
  const canvas = el("canvas", { role: "img", "aria-label": words.picture });
  const ring = el("i.ring"), what = el("b"), more = el("span"), far = el("span");
  const pill = el("button.float.pill", { "aria-haspopup": "dialog", onclick: () => tell() }, ring, what, more, far);
  const said = el("div.hidden-colour", { role: "status" });
  let drawn = 0, received = 0, ringOf = 0, ringPart = 0, last = null, measured = null, measuring = null, timer = 0;

  const size = () => [canvas.parentElement.clientWidth, canvas.parentElement.clientHeight].map((x) => Math.max(16, Math.round(x * devicePixelRatio)));
  const turn = (n, part) => {
    if (n !== ringOf) (ringOf = n), (ringPart = 0);
    ring.style.setProperty("--part", String((ringPart = Math.max(ringPart, part))));
  };

  /** Draws a frame, unless a newer one was drawn while it was decoded. */
  async function show(header, blob) {
    const order = ++received;
    const bitmap = await createImageBitmap(blob, { colorSpaceConversion: "none" });
    if (order < drawn || header.n < (last?.n ?? 0)) return bitmap.close();
    drawn = order;
    const [w, h] = header.size;
    if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, { width: w, height: h });
    const g = canvas.getContext("2d", { willReadFrequently: true });
    g.clearRect(0, 0, w, h);
    g.drawImage(bitmap, 0, 0, w, h);
    bitmap.close();
    last = { ...header, at: performance.now() };
    Object.assign(canvas.dataset, { n: header.n, stage: header.stage });
    app.shown?.(header);
    tellStage(header.stage, header.stage === "final" ? 1 : 0);
  }

  function tellStage(stage, fraction, left) {
    turn(last.n, starts[stage] + (ends[stage] - starts[stage]) * fraction);
    const light = method(app.store.state), done = stage === "final" || (stage === "full" && last.preview);
    const name = done ? words.pill.final : stage === "light" ? words.pill.light : stage === "accumulate" ? words.pill.picture : stage === "reading" ? words.pill.reading : words.pill.draft;
    what.textContent = name;
    said.textContent = done ? name : "";
    more.textContent = done ? seconds(last.seconds) : fraction ? percent(Math.round(fraction * 100) / 100) : "";
    if (left > 10) more.textContent += `, ${words.states.left(Math.round(left))}`;
    const grid = light === "visibility" && stage === "light" ? words.pill.grid(read(app.store.state, "visibility:lighting.subsample") * (last.light?.coarse ? 2 : 1)) : "";
    far.textContent = last.preview ? [words.pill.preview, app.store.preview?.name].filter(Boolean).join(": ") : done && light !== "none" ? distance() : grid;
    schedule();
  }
  /** Measures when nothing else was asked for during a second. */
  function schedule() {
    clearTimeout(timer);
    if (last?.stage === "final" && !last.preview && !["none", "reference"].includes(method(app.store.state))) timer = setTimeout(measure, 1000);
  }
  const distance = () => (method(app.store.state) === "reference" ? "" : Number.isFinite(measured?.percent) ? `${measured.percent > 5 ? "△ " : ""}${words.pill.fromReference(percent(measured.percent / 100))}` : words.pill.notMeasured);

  async function measure() {
    if (measured || measuring || last?.stage !== "final") return;
    const asked = app.link.ask("measure", { scene: app.scene(), size: size() });
    measuring = asked.id;
    const answer = await asked.catch(() => null);
    if (measuring === asked.id) measuring = null;
    if (answer && last?.stage === "final") (measured = answer), (far.textContent = distance());
  }

  const stop = () => {
    clearTimeout(timer);
    if (measuring) app.link.cancel(measuring);
    measuring = null;
  };
  /** An edit: what was measured holds no more. */
  const forget = () => (stop(), (measured = null));
  /** Something is wanted at once, with all the server has. */
  const postpone = () => (stop(), schedule());

  function tell() {
    const rows = (last?.verbs ?? []).map((v) => [v.name, seconds(v.seconds)]);
    if (last?.fps) rows.push([words.pill.frames, last.fps.toFixed(0)]);
    rows.push([words.pill.device, `${app.hello.device.name}, ${app.hello.device.isa}, ${app.hello.device.threads}`], [words.pill.leaves, words.leftOut[method(app.store.state)]]);
    if (measured) rows.push([words.wipe.reference, measured.sentence ?? words.measured(percent(measured.percent / 100), measured)]);
    if (measured?.percent > 5) rows.push([words.pill.lower, words.lowers[method(app.store.state)]]);
    app.popover(pill, el("div", {}, el("h2", {}, words.pill.stages), el("dl", {}, ...rows.flatMap(([k, v]) => [el("dt", {}, k), el("dd", {}, v)])), ...(last?.notes ?? []).map((note) => el("p", {}, el("small", {}, note)))));
  }

  return { canvas, pill, said, show, forget, postpone, progress: (m) => last && m.n === app.link.n && last.stage !== "final" && tellStage(m.stage === "bricks" ? "reading" : last.stage === "light" || /light|level|visib|histogram|direction|cluster/i.test(m.stage) ? "light" : "accumulate", m.fraction, m.remaining_s),
    reset: () => (last = null), get last() { return last; }, size };
}
