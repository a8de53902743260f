// The folded sections: Surface, Cut, Camera, Picture. Each tells its state in a few words.
import { el, fromHex, hex, icon, short } from "./dom.js";
import { choiceRow, colourRow, settingRow, sliderRow } from "./rows.js";
import { read, write } from "./scene.js";
import { placed } from "./table.js";
import { words } from "./texts.js";

/** A folded part: head with its words, body built once. */
export function fold(title, says, rows, kind = "", at = "div") {
  const told = el("span.says"), body = el("div", { hidden: true }, ...rows);
  const head = el(`button.head.${kind || "part"}`, { "aria-expanded": "false", onclick: () => {
    body.hidden = !body.hidden;
    head.setAttribute("aria-expanded", String(!body.hidden));
    made.classList.toggle("open", !body.hidden);
    if (!body.hidden) made.scrollIntoView({ block: "nearest" }), head.scrollIntoView({ block: "nearest" });
  } }, icon("right"), el("h2", {}, title), told);
  const made = Object.assign(el(at, {}, head, body), { show: () => {
    told.textContent = says();
    rows.forEach((row) => row.show?.());
  } });
  made.classList.add("fold");
  return made;
}

const grey = (n) => (Array.isArray(n) ? n : fromHex(String(n)) ?? [0, 0, 0]);

export function makeSections(app) {
  const { store } = app, state = () => store.state;
  const set = (label, key, value, track) => store.set(label, (s) => write(s, key, value), track);
  const get = (key) => read(state(), key);
  let made = [], ofCamera = null;

  function surface() {
    const fixed = () => typeof get("shading.light")?.[0] === "number", light = () => (fixed() ? get("shading.light") : [35, 45]);
    const rows = placed(app.hello.settings, "surface").map((s) => settingRow(app, s));
    const part = (i, o) => Object.assign(sliderRow(app, { ...o, label: words.keyLight[i], unit: "°", step: 1, value: () => light()[i - 1], change: (v) => set("Key light…", "shading.light", light().map((x, k) => (k === i - 1 ? v : x))) }));
    const turned = [part(1, { low: -180, high: 180 }), part(2, { low: -90, high: 90 })];
    const tint = colourRow(app, { label: words.keyLight[3], value: () => (light().length > 2 ? light().slice(2) : [1, 1, 1]), change: (rgb) => set("Key light…", "shading.light", [...light().slice(0, 2), ...rgb]) });
    const kind = choiceRow(app, { label: words.keyLight[0], tip: "Direction towards the light. --light", options: [["headlight", words.choices.headlight], ["fixed", words.choices.fixed]], value: () => (fixed() ? "fixed" : "headlight"), change: (v) => set(words.keyLight[0], "shading.light", v === "fixed" ? light() : null) });
    const free = el("div", {}, ...turned, tint);
    return fold(words.surface, () => (get("shading.enabled") === false || get("shading.enabled") === "none" ? words.choices.none : `${words.shineOf(get("shading.specular"))} ${short(get("shading.specular"), 2)}`),
      [...rows, kind, Object.assign(free, { show: () => ((free.hidden = !fixed()), [...turned, tint].forEach((r) => r.show())) })], "", "section.section.s-surface");
  }

  function cut() {
    const box = () => get("clip.box") ?? [0, 1, 0, 1, 0, 1], n = app.volume.dimensions, planes = () => get("clip.planes") ?? [];
    const sides = words.axes.map((name, k) => sliderRow(app, { label: name, tip: "Keeps a part of the volume, in slices. --clip-box", two: true, low: 0, high: Math.max(1, n[k] - 1), step: 1, value: () => [0, 1].map((i) => Math.round(box()[2 * k + i] * (n[k] - 1))), change: (v) => {
      if (v[1] <= v[0]) return;
      const next = box().map((x, i) => (i >> 1 === k ? v[i % 2] / Math.max(1, n[k] - 1) : x));
      set(`${words.cut}…`, "clip.box", next.every((x, i) => x === i % 2) ? null : next);
    } }));
    const put = (list) => set(`${words.cut}…`, "clip.planes", list.length ? list : null), list = el("div"), replace = (i, plane) => put(planes().map((p, k) => (k === i ? plane : p)));
    list.show = () => {
      if (list.children.length !== planes().length) list.replaceChildren(...planes().map((_, i) => {
        const reach = app.box.radius, shift = () => planes()[i][3] - planes()[i].slice(0, 3).reduce((sum, x, k) => sum + x * app.box.centre[k], 0);
        const row = sliderRow(app, { label: `${words.plane} ${i + 1}`, tip: "Removes what lies beyond the plane. --clip-plane", low: -reach, high: reach, step: reach / 200, unit: "mm", value: shift, change: (v) => replace(i, [...planes()[i].slice(0, 3), planes()[i][3] + v - shift()]) });
        return Object.assign(el("div", {}, row, el("div.buttons", {}, el("button", { onclick: () => replace(i, planes()[i].map((x) => -x)) }, words.flip), el("button", { onclick: () => put(planes().filter((_, k) => k !== i)) }, words.remove))), { show: row.show });
      }));
      for (const row of list.children) row.show();
    };
    const fresh = () => {
      // Through the centre, facing the camera.
      const normal = app.view().forward.map((x) => Number((-x).toFixed(4))), d = normal.reduce((sum, x, k) => sum + x * app.box.centre[k], 0);
      put([...planes(), [...normal, d]]);
      app.gestures.choose("cut"); // which shows its handle and rim
    };
    const largest = choiceRow(app, { label: words.largest, tip: "Leaves out what is not connected to the largest piece of what is visible. --largest", options: [[false, words.choices.off], [true, words.choices.on]], value: () => get("clip.largest") ?? false, change: (v) => set(words.largest, "clip.largest", v || null) });
    const buttons = el("div.buttons", {}, el("button", { onclick: fresh }, words.addPlane), el("button", { onclick: () => store.set(words.cutReset, (s) => ({ values: { ...s.values, "clip.box": undefined, "clip.planes": undefined, "clip.largest": undefined } })) }, words.cutReset));
    return fold(words.cut, () => [get("clip.box") ? words.box : "", planes().length ? words.planes(planes().length) : "", get("clip.largest") ? words.largest : ""].filter(Boolean).join(", ") || words.cutNone, [...sides, list, largest, buttons], "", "section.section.s-cut");
  }

  function camera() {
    const framed = app.volume.world !== "unknown", names = framed ? words.views : words.axisViews;
    const views = el("div.buttons", {}, ...Object.entries(names).map(([key, name]) => el("button", { onclick: () => app.turnTo(key) }, name)));
    const begin = () => store.set(words.startView, (s) => ({ camera: Object.fromEntries(Object.entries(s.camera).filter(([key]) => key.startsWith("slices."))) }), "camera");
    const copy = el("div.buttons", {}, el("button", { onclick: begin }, words.startView), el("button", { title: words.copyCamera, onclick: () => app.copy(JSON.stringify(app.scene().camera, null, 1)) }, words.copy));
    return fold(words.camera, () => `${words.choices[get("camera.projection")] ?? words.perspective} ${short(get("camera.view_angle_deg"), 3)}°`, [...placed(app.hello.settings, "camera").map((s) => settingRow(app, s)), views, copy], "", "section.section.s-camera");
  }

  function picture() {
    const behind = () => (get("probe.background") ? "probe" : get("background") === "transparent" ? "transparent" : "colour");
    const kind = choiceRow(app, { label: words.saving.background, tip: "Behind the volume. --background", options: Object.entries(words.backgroundKinds), value: behind, change: (v) => store.set(words.saving.background, (s) => {
      const next = { ...s, ...write(s, "background", v === "transparent" ? v : null) };
      return { values: write(next, "probe.background", v === "probe" ? true : null).values };
    }) });
    const colour = colourRow(app, { label: words.colourField, value: () => grey(get("background")), change: (rgb) => set("Background…", "background", rgb) });
    const rows = placed(app.hello.settings, "picture").map((s) => settingRow(app, s));
    const name = () => (behind() === "colour" ? (hex(grey(get("background"))) === "#000000" ? words.black : hex(grey(get("background")))) : words.backgroundKinds[behind()]);
    return fold(words.picture, () => `${name()}, ${get("output.tone") === "aces" ? words.choices.aces : words.noTone}`, [kind, colour, ...rows], "", "section.section.s-picture");
  }

  store.watch(() => app.volume && made.forEach((part) => part.show()), { camera: false });
  store.watch(() => app.volume && ofCamera?.show());
  return () => {
    ofCamera = camera();
    made = [surface(), cut(), picture()];
    return [made[0], made[1], ofCamera, made[2]];
  };
}

