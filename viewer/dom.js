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
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

const paths = {
  undo: "M6 3 2.8 6.2 6 9.4M3 6.2h6.2a3.6 3.6 0 0 1 0 7.2H7.5", redo: "M10 3l3.2 3.2L10 9.4M13 6.2H6.8a3.6 3.6 0 0 0 0 7.2h1.7",
  compare: "M8 1.5v13M5.5 3.5h-3v9h3M10.500 3.500h3v9h-3z", more: "M3.500 8h0M8 8h0M12.500 8h0M3.200 8h.6M7.700 8h.6M12.200 8h.6", right: "M6 3.500 10.500 8 6 12.500",
  orbit: "M13.500 5.500A6 3.300 0 1 0 14 8.500M14 2.800v3h-3M8 8h.01", adjust: "M8 1.500v13M5.500 4 8 1.500 10.500 4M5.500 12 8 14.500l2.500-2.500M8 8h.01",
  light: "M8 5.300a2.700 2.700 0 1 0 0 5.400 2.700 2.700 0 0 0 0-5.400M8 1v1.500M8 13.500V15M1 8h1.500M13.500 8H15M3 3l1.100 1.100M11.900 11.900 13 13M13 3l-1.100 1.100M4.100 11.900 3 13",
  cut: "M8 1.500 14 4.800v6.400L8 14.500 2 11.200V4.800zM2 4.800l6 3.300 6-3.300M8 8.100v6.400", fit: "M2 5.500V2h3.500M10.500 2H14v3.500M14 10.500V14h-3.500M5.500 14H2v-3.500",
  panel: "M2 3h12v10H2zM10 3v10", shape: "M1.500 12.500c4 0 3.500-9 6.500-9s2.500 9 6.500 9", grow: "M9.500 2H14v4.500M14 2 9 7M6.500 14H2V9.500M2 14l5-5",
  eye: "M1 8c1.800-3 4.200-4.500 7-4.500S13.200 5 15 8c-1.800 3-4.200 4.500-7 4.500S2.800 11 1 8zM8 6a2 2 0 1 0 0 4 2 2 0 0 0 0-4", plus: "M8 3v10M3 8h10",
  looks: "M2 2h5v5H2zM9 2h5v5H9zM2 9h5v5H2zM9 9h5v5H9z", hill: "M1 13h2.500c1.500 0 2-9.500 3-9.500h3c1 0 1.500 9.500 3 9.500H15", rows: "M2 4h7M12 4h2M2 8h2M7 8h7M2 12h6M11 12h3M10.500 2.500v3M5.500 6.500v3M9.500 10.500v3",
  file: "M4 1.500h5l3 3v10H4zM9 1.500v3h3", folder: "M1.500 3.500h4.500l1.500 2h7v8h-13z", wipe: "M6 5 3 8l3 3M10 5l3 3-3 3", info: "M8 1.500a6.500 6.500 0 1 0 0 13 6.500 6.500 0 0 0 0-13M8 7.200v4M8 4.800h.01",
  close: "M4 4l8 8M12 4l-8 8",
};

/** An icon of 16 pixels, stroke 1.5. @param {keyof paths} name */
export function icon(name) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 16 16");
  svg.setAttribute("class", "icon");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS(svg.namespaceURI, "path");
  path.setAttribute("d", paths[name]);
  svg.append(path);
  return svg;
}

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
