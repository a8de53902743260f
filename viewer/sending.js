// A volume of this computer, sent to the server: one file, or a folder of slices. Loaded when first used.
import { bytes } from "./dom.js";
import { words } from "./texts.js";

const w = words.states, atOnce = 3;

/** Files below what was dropped, each with the path below its folder. @param {any} entry of a DataTransferItem */
async function filesBelow(entry, path = "") {
  if (entry.isFile) return [{ file: await new Promise((done, fail) => entry.file(done, fail)), name: path + entry.name }];
  const reader = entry.createReader(), found = [];
  for (;;) {
    const some = await new Promise((done, fail) => reader.readEntries(done, fail));
    if (!some.length) return found;
    for (const inner of some) found.push(...(await filesBelow(inner, `${path}${entry.name}/`)));
  }
}
/** What a drop brings; entries must be asked for before anything else happens. @param {DataTransfer} transfer */
export const dropped = (transfer) => {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean), files = [...transfer.files];
  return entries.length ? Promise.all(entries.map((entry) => filesBelow(entry))).then((all) => all.flat()) : Promise.resolve(files.map((file) => ({ file, name: file.name })));
};

/** Sends one file; hears of the bytes that went. */
function send(app, volume, { file, name }, request, told) {
  return new Promise((done, fail) => {
    const query = new URLSearchParams({ token: app.link.token, view: app.link.view, volume, name: name.split("/").slice(name.includes("/") ? 1 : 0).join("/") });
    request.open("POST", `volume?${query}`);
    request.upload.onprogress = (event) => told(event.loaded);
    request.onload = () => (request.status === 200 ? (told(file.size), done()) : fail({ sentence: request.responseText.trim() || w.refused }));
    request.onerror = () => fail({ sentence: w.notSent(file.name) });
    request.onabort = () => fail({ code: "interrupted" });
    request.send(file);
  });
}

/** Sends the files, some at once, and opens what they are. @param {any} app @param {{file: File, name: string}[]} given */
export async function openFiles(app, given) {
  const files = given.filter(({ name }) => !name.split("/").at(-1).startsWith("."));
  if (!files.length) return app.states.say(w.nothingSent, { role: "alert" });
  const volume = Array.from(crypto.getRandomValues(new Uint8Array(9)), (b) => b.toString(16).padStart(2, "0")).join("");
  const called = files.length === 1 ? files[0].file.name : files[0].name.includes("/") ? files[0].name.split("/")[0] : w.files(files.length);
  const total = files.reduce((sum, { file }) => sum + file.size, 0), went = files.map(() => 0), running = new Set(), began = performance.now();
  let over = false;
  const stop = () => ((over = true), running.forEach((request) => request.abort()));
  const show = app.states.reading(called, stop, w.sending(called)), tell = () => {
    const sent = went.reduce((a, b) => a + b, 0), fraction = total ? Math.min(1, sent / total) : 1, seconds = (performance.now() - began) / 1000;
    show({ fraction, seconds, bytes: sent, remaining_s: fraction > 0.02 ? (seconds * (1 - fraction)) / fraction : null });
  };
  let next = 0;
  const worker = async () => {
    while (!over && next < files.length) {
      const i = next++, request = new XMLHttpRequest();
      running.add(request);
      await send(app, volume, files[i], request, (n) => ((went[i] = Math.min(n, files[i].file.size)), tell()));
      running.delete(request);
    }
  };
  try {
    await app.link.ask("room", { bytes: total, files: files.length });
    await Promise.all([...Array(atOnce)].map(worker));
    if (over) throw { code: "interrupted" };
    app.states.clear();
    await app.open({ uploaded: volume }, called);
  } catch (error) {
    stop();
    app.states.clear();
    app.link.ask("discard", { uploaded: volume }).catch(() => {});
    if (error.code === "interrupted") app.volume || app.states.empty();
    else app.states.failed(error.sentence || w.notSent(called), w.notTaken(bytes(total)));
  }
}
