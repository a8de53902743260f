// Styles of parts that are loaded when first used come with them.
import { el } from "./dom.js";

/** @param {string} name a file beside this one */
export const styled = (name) => new Promise((done) => document.head.append(el("link", { rel: "stylesheet", href: name, onload: done, onerror: done })));
