// Asks for the token: of a link that carries none, or an old one.
import { words } from "./texts.js";

const field = /** @type {HTMLInputElement} */ (document.getElementById("token"));
document.documentElement.dataset.theme = matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
document.querySelector("form")?.addEventListener("submit", (event) => {
  event.preventDefault();
  const token = /(?:^|token=)([0-9a-f]{32})(?:$|&|#)/.exec(field.value.trim())?.[1], query = new URLSearchParams(location.search);
  query.delete("key");
  if (token) query.set("token", token), location.replace(`?${query}${location.hash}`);
  else document.getElementById("wrong").textContent = words.embed.noToken;
});
