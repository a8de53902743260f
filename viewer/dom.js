// Small helpers to build the page: elements, icons, numbers.

/** An element: el("button.primary", {onclick}, "Save"). Keys with "on" are listeners, "aria-…" and "data-…" attributes.
 * @param {string} tag @param {Object<string, any>} [props] @param {...(Node|string|null)} children @returns {any} */
export function el(tag, props = {}, ...children) {
  const [name, ...classes] = tag.split(".");
  const made = document.createElement(name || "div");
  if (classes.length) made.className = classes.join(" ");
  for (const [key, value] of Object.entries(props)) {
    if (value === undefined || value === null) continue;
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (key.includes("-") || key === "role" || key === "for" || key === "list") made.setAttribute(key, value);
    else made[key] = value;
  }
  if (made.type === "color") made.setAttribute("list", "palette");
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

const paths = {
  play: "M5 3l8 5-8 5z", pause: "M5.5 3v10M10.5 3v10", undo: "M6 3 2.8 6.2 6 9.4M3 6.2h6.2a3.6 3.6 0 0 1 0 7.2H7.5", redo: "M10 3l3.2 3.2L10 9.4M13 6.2H6.8a3.6 3.6 0 0 0 0 7.2h1.7",
  compare: "M8 1.5v13M5.5 3.5h-3v9h3M10.5 3.5h3v9h-3z", more: "M3.5 8h0M8 8h0M12.5 8h0M3.2 8h.6M7.7 8h.6M12.2 8h.6", right: "M6 3.5 10.5 8 6 12.5",
  orbit: "M13.5 5.5A6 3.3 0 1 0 14 8.5M14 2.8v3h-3M8 8h.01", adjust: "M8 1.5v13M5.5 4 8 1.5 10.5 4M5.5 12 8 14.5l2.5-2.5M8 8h.01",
  light: "M8 5.3a2.7 2.7 0 1 0 0 5.4 2.7 2.7 0 0 0 0-5.4M8 1v1.5M8 13.5V15M1 8h1.5M13.5 8H15M3 3l1.1 1.1M11.9 11.9 13 13M13 3l-1.1 1.1M4.1 11.9 3 13",
  cut: "M8 1.5 14 4.8v6.4L8 14.5 2 11.2V4.8zM2 4.8l6 3.3 6-3.3M8 8.1v6.4", fit: "M2 5.5V2h3.5M10.5 2H14v3.5M14 10.5V14h-3.5M5.5 14H2v-3.5",
  panel: "M2 3h12v10H2zM10 3v10", shape: "M1.5 12.5c4 0 3.5-9 6.5-9s2.5 9 6.5 9", grow: "M9.5 2H14v4.5M14 2 9 7M6.5 14H2V9.5M2 14l5-5",
  eye: "M1 8c1.8-3 4.2-4.5 7-4.5S13.2 5 15 8c-1.8 3-4.2 4.5-7 4.5S2.8 11 1 8zM8 6a2 2 0 1 0 0 4 2 2 0 0 0 0-4", plus: "M8 3v10M3 8h10",
  looks: "M2 2h5v5H2zM9 2h5v5H9zM2 9h5v5H2zM9 9h5v5H9z", peak: "M1 13h2.5c1.5 0 2-9.5 3-9.5h3c1 0 1.5 9.5 3 9.5H15", rows: "M2 4h7M12 4h2M2 8h2M7 8h7M2 12h6M11 12h3M10.5 2.5v3M5.5 6.5v3M9.5 10.5v3",
  file: "M4 1.5h5l3 3v10H4zM9 1.5v3h3", folder: "M1.5 3.5h4.5l1.5 2h7v8h-13z", wipe: "M6 5 3 8l3 3M10 5l3 3-3 3", info: "M8 1.5a6.5 6.5 0 1 0 0 13 6.5 6.5 0 0 0 0-13M8 7.2v4M8 4.8h.01",
  slices: "M2 2h12v12H2zM8 2v12M2 8h12", measure: "M1.5 11 11 1.5 14.5 5 5 14.5zM4 8.5 5.5 10M6.5 6 8 7.5M9 3.5 10.5 5",
  close: "M4 4l8 8M12 4l-8 8",
};

/** An element of SVG. @param {string} tag @param {Object<string, any>} [attributes] */
export function svg(tag, attributes = {}, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

/** Sets a property, or else an attribute, where it is another: the page would be laid out anew otherwise. */
export function renew(node, key, text) {
  if (key in node) node[key] === text || (node[key] = text);
  else if (node.getAttribute(key) !== text) node.setAttribute(key, text);
}

/** An icon of 16 pixels, stroke 1.5. @param {keyof paths} name */
export const icon = (name) => svg("svg", { viewBox: "0 0 16 16", class: "icon", "aria-hidden": "true" }, svg("path", { d: paths[name] }));

/** What a slider says of itself. */
export function tell(slider, now, text) {
  slider.setAttribute("aria-valuenow", String(now));
  slider.setAttribute("aria-valuetext", text);
}

/** The way an arrow key points: 1 for more, -1 for less. */
export const arrow = ({ key }) => ({ ArrowLeft: -1, ArrowRight: 1, ArrowUp: 1, ArrowDown: -1 })[key];

/** A range of which one end is moved: it stops at the other. */
export const endMoved = (range, which, value) => range.map((v, i) => (i === which ? (i ? Math.max(value, range[0]) : Math.min(value, range[1])) : v));

export const clamp = (value, low, high) => Math.min(high, Math.max(low, value));

/** A number in few characters: about `digits` significant ones, no trailing zeros. */
export function short(value, digits = 4) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e6 || size < 1e-4)) return value.toExponential(2).replace("e+", "e").replace("-", "−");
  return String(Number(value.toPrecision(size >= 1000 ? Math.ceil(Math.log10(size)) : digits))).replace("-", "−");
}

/** What is typed as a number, or NaN. A decimal comma and a true minus are understood. */
export const typed = (text) => (text.trim() === "" ? NaN : Number(text.trim().replace("−", "-").replace(",", ".")));

export const hex = (rgb) => `#${rgb.map((c) => Math.round(clamp(c, 0, 1) * 255).toString(16).padStart(2, "0")).join("")}`;
export const fromHex = (text) => {
  const found = /^#?([0-9a-f]{2})([0-9a-f]{2})([0-9a-f]{2})$/i.exec(text.trim());
  return found ? found.slice(1).map((part) => parseInt(part, 16) / 255) : null;
};
export const percent = (share) => (share > 0 && share < 0.0001 ? "< 0.01 %" : `${short(100 * share, share < 0.1 ? 2 : 3)} %`);
export const seconds = (s) => (s < 10 ? `${s.toFixed(1)} s` : s < 90 ? `${Math.round(s)} s` : `${Math.round(s / 60)} min`);
export const bytes = (n) => (n < 1e6 ? `${Math.round(n / 1e3)} kB` : n < 1e9 ? `${Math.round(n / 1e6)} MB` : `${(n / 1e9).toFixed(1)} GB`);

/** Hands the browser a file. @param {Blob} blob @param {string} name */
export function download(blob, name) {
  const link = el("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** Asks for a file of this computer. @param {string} accept @param {(file: File) => void} take */
export function chooseFile(accept, take) {
  const input = el("input", { type: "file", accept, onchange: () => input.files[0] && take(input.files[0]) });
  input.click();
}
