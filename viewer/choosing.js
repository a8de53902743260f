// A file of the computer that runs Chiaro, from its folders or by its path. Loaded when first used.
import { bytes, el } from "./dom.js";
import { openWords as w } from "./part-texts.js";
import { words } from "./texts.js";

/** The folders of the computer that runs Chiaro; `take` gets the file that is chosen. @param {any} app @param {(entry: any) => void} take */
export function chooseFile(app, take) {
  const list = el("div.list"), head = el("h2", {}, words.states.open), path = el("input", { type: "text", "aria-label": w.path, placeholder: w.pathHint, autocomplete: "off", spellcheck: false });
  const typed = el("form", { onsubmit: (event) => (event.preventDefault(), path.value.trim() && choice(path.value.trim())) }, path), wrong = el("div.wrong", { role: "alert", hidden: true }), note = el("small", {}, w.otherFolders);
  const box = el("dialog", { "aria-label": words.states.open }, head, typed, wrong, list, note, el("div.buttons", {}, el("button", { onclick: () => box.close() }, words.states.cancel)));
  const go = async (path) => {
    const answer = await app.link.ask("folder", { path }).catch(app.fault);
    if (!answer) return;
    head.textContent = answer.path || words.states.open;
    note.hidden = answer.path !== "";
    wrong.hidden = true;
    const up = answer.path ? [el("button.item", { onclick: () => go(answer.parent ?? "") }, "…")] : [];
    list.replaceChildren(...up, ...answer.entries.map((e) => el("button.item", { onclick: () => (e.kind === "folder" ? go(e.path) : (box.close(), take(e))) }, e.name + (e.kind === "folder" ? " ›" : ""), el("span", {}, e.kind === "folder" ? "" : e.bytes ? bytes(e.bytes) : ""))));
    list.querySelector("button")?.focus();
  };
  /** A folder is shown; else it is a file, or a sample. */
  async function choice(name) {
    const file = { path: name, kind: /\.(vp|itf|tfi)$/i.test(name) ? "transfer" : /\.(json|png)$/i.test(name) ? "scene" : "volume" };
    const answer = name.startsWith("sample:") ? null : await app.link.ask("folder", { path: name }).catch((error) => error);
    if (answer?.entries) return go(name);
    if (/outside the folders/.test(answer?.sentence ?? "")) return void ((wrong.hidden = false), (wrong.textContent = answer.sentence));
    box.close();
    take(file);
  }
  box.className = "popover";
  box.style.cssText = "left:50%;top:96px;transform:translateX(-50%)";
  box.addEventListener("close", () => box.remove());
  document.body.append(box);
  box.showModal();
  go("");
}
