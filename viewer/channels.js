// Several values a voxel: a row for each channel with eye, colour, name, gain and window. Loaded for volumes that have several.
import { el, fromHex, hex, icon, short } from "./dom.js";
import { spanOf, stretched } from "./peaks.js";
import { numberField, sliderRow } from "./rows.js";
import { channelsOf } from "./scene.js";
import { styled } from "./styles.js";
import { channelWords as w } from "./part-texts.js";
import { words } from "./texts.js";

const ofValues = ["range", "percentiles", "histogram512", "type", "unit"];

export async function makeChannels(app) {
  await styled("parts.css");
  const { store } = app, told = () => app.volume.channels, all = () => channelsOf(store.state);
  const root = el("div.channels", { role: "group", "aria-label": w.title });
  let rows = [], edited = -1;

  /** All of them, changed, as a step: the edited one's function is the state's. */
  const put = (label, change) => store.set(label, (s) => {
    const channels = channelsOf(s).map(change);
    return { channels, tf: { ...channels[s.channel].tf, scale: s.tf.scale } };
  });
  const putOne = (i, label, change) => put(label, (own, k) => (k === i ? { ...own, ...change(own) } : own));
  const isShown = (own) => own.show !== false;
  /** Alone; and when it is alone already, all again. */
  const solo = (i) => put(w.solo, (own, k) => ({ ...own, show: k === i || all().every((one, n) => isShown(one) === (n === i)) }));
  const colourOf = (own) => { const densest = own.tf.points.reduce((a, b) => (b.opacity > a.opacity ? b : a)); return own.tf.stops.reduce((a, b) => (Math.abs(b.value - densest.value) < Math.abs(a.value - densest.value) ? b : a)).rgb; };

  /** The graph shows this channel: no step, for the picture stays. */
  function edit(i) {
    if (i !== store.state.channel) store.learn({ channels: all(), channel: i, tf: { ...all()[i].tf, scale: store.state.tf.scale } });
    follow();
  }
  /** What is said of the volume's values is said of the edited channel's. */
  function follow() {
    const i = store.state.channel;
    if (edited === i) return;
    edited = i;
    for (const key of ofValues) app.volume[key] = told()[i][key];
    app.colour.open();
    store.redraw();
  }

  function row(i) {
    const own = () => all()[i], nameOf = () => own().name || w.channel(i + 1), [low, high] = told()[i].range, step = (high - low) / 255 >= 1 ? 1 : (high - low) / 1000;
    const eye = el("button.tool", { onclick: (e) => (e.altKey ? solo(i) : putOne(i, w.shown, (one) => ({ show: !isShown(one) }))), onkeydown: (e) => e.key === "Enter" && e.altKey && (e.preventDefault(), solo(i)) }, icon("eye"));
    const swatch = el("input.swatch", { type: "color", oninput: () => putOne(i, `${words.colourField}…`, ({ tf }) => ({ tf: { ...tf, stops: tf.stops.map((s) => ({ ...s, rgb: fromHex(swatch.value) })) } })) });
    const name = el("button.channel-name", { onclick: () => edit(i) });
    const gain = numberField(app, { label: w.gain, low: 0, high: 1000, step: 0.1, now: () => own().gain ?? 1, text: () => short(own().gain ?? 1, 3), change: (v) => putOne(i, `${w.gain}…`, () => ({ gain: v })) });
    const window_ = sliderRow(app, { label: words.window, tip: w.windowTip, two: true, low, high: high > low ? high : low + 1, least: -1e30, most: 1e30, step, value: () => spanOf(own().tf), change: (to) => to[1] > to[0] && putOne(i, `${words.window}…`, ({ tf }) => ({ tf: stretched(tf, to) })) });
    return Object.assign(el("div.channel", { role: "group" }, el("div.channel-row", {}, eye, swatch, name, el("div.field", {}, gain.input, el("span.unit", {}, "×"))), gain.wrong, window_), { show() {
      const seen = isShown(own()), text = nameOf();
      this.setAttribute("aria-label", text);
      this.classList.toggle("hidden-one", !seen);
      eye.setAttribute("aria-pressed", String(seen));
      eye.setAttribute("aria-label", `${seen ? w.hide : w.show}: ${text}`);
      eye.title = w.eyeTip;
      swatch.value = hex(colourOf(own()));
      swatch.setAttribute("aria-label", `${words.colourField}: ${text}`);
      name.textContent = text;
      name.title = w.editTip;
      name.setAttribute("aria-pressed", String(store.state.channel === i));
      gain.input.setAttribute("aria-label", `${w.gain}: ${text}`);
      gain.show();
      window_.show();
    } });
  }

  store.watch((state) => {
    if (!root.isConnected || !state.channels) return;
    follow();
    rows.forEach((one) => one.show());
  }, { camera: false });
  return { root, edit, solo, open() {
    edited = -1;
    const several = (told()?.length ?? 1) > 1 && Boolean(store.state.channels);
    root.hidden = !several;
    root.parentElement?.classList.toggle("of-channels", several);
    rows = several ? told().map((_, i) => row(i)) : [];
    root.replaceChildren(...rows);
    if (several) follow();
  } };
}
