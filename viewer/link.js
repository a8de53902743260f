// The socket: requests with answers, the newest state only, frames in order, and trying again when it is lost.
const waits = [1, 2, 4, 8, 15];

const viewId = () => {
  // The tab's own: a duplicated tab has the same one and is told so by the server, a new tab draws another.
  let id = sessionStorage.getItem("view");
  if (!id) sessionStorage.setItem("view", (id = Array.from(crypto.getRandomValues(new Uint8Array(12)), (b) => b.toString(16).padStart(2, "0")).join("")));
  return id;
};

export class Link {
  view = viewId();
  /** Of the address, or where that was good for one visit, the page's own. */
  token = new URLSearchParams(location.search).get("token") ?? document.querySelector("meta[name=chiaro-visit]")?.getAttribute("content") ?? "";
  open = false;
  /** How often it was connected. */ connections = 0;
  n = 0;
  /** @type {(message: any) => void} */ onmessage = () => {};
  /** @type {(frame: any, data: Blob) => void} */ onframe = () => {};
  /** @type {(state: "open"|"lost"|"taken"|"refused", seconds?: number) => void} */ onstate = () => {};
  #socket = null;
  #waiting = new Map();
  #id = 0;
  #tries = 0;
  #timer = 0;
  #pending = null;
  #inFlight = 0;
  #scheduled = false;

  /** A tab that was here before takes its view back: the server may not know yet that the old socket is gone. A duplicated tab does not. */
  connect(take = this.#tries > 0 || performance.getEntriesByType("navigation")[0]?.type === "reload") {
    clearTimeout(this.#timer);
    // One socket at a time: a try that is still under way must not open later.
    if (this.#socket) Object.assign(this.#socket, { onopen: null, onmessage: null, onclose: null }).close();
    const address = new URL("socket", location.href);
    address.protocol = address.protocol.replace("http", "ws");
    address.search = new URLSearchParams({ token: this.token, view: this.view, ...(take ? { take: "1" } : {}) }).toString();
    const socket = (this.#socket = new WebSocket(address));
    socket.binaryType = "arraybuffer";
    socket.onopen = () => ((this.open = true), this.connections++, (this.#tries = 0), (this.#inFlight = 0));
    socket.onmessage = ({ data }) => (typeof data === "string" ? this.#text(JSON.parse(data)) : this.#frame(data));
    socket.onclose = ({ code }) => socket === this.#socket && this.#lost(code);
  }

  #lost(code) {
    this.open = false;
    for (const { fail } of this.#waiting.values()) fail({ code: "lost", sentence: "" });
    this.#waiting.clear();
    if (code === 4001) return this.onstate("taken");
    const wait = waits[Math.min(this.#tries++, waits.length - 1)];
    this.onstate("lost", wait);
    this.#timer = setTimeout(() => this.connect(), wait * 1000);
  }

  /** A request: resolves with its answer, rejects with its error. `progress` hears of both progress and frames.
   * @returns {Promise<any> & {id: number}} */
  ask(type, fields = {}, progress = (_message, _data) => {}) {
    const id = ++this.#id;
    const answer = new Promise((done, fail) => {
      if (!this.open) return fail({ code: "lost", sentence: "" });
      this.#waiting.set(id, { done, fail, progress });
      this.#socket.send(JSON.stringify({ type, id, ...fields }));
    });
    return Object.assign(answer, { id });
  }

  cancel(id) {
    this.ask("cancel", { re: id }).catch(() => {});
  }

  /** Sends a state in the next animation frame: the newest only, and while moving one at a time. */
  send(make, options) {
    this.#pending = { make, options };
    if (this.#scheduled) return;
    this.#scheduled = true;
    requestAnimationFrame(() => ((this.#scheduled = false), this.#flush()));
  }

  #flush() {
    if (!this.#pending || !this.open) return;
    const { make, options } = this.#pending;
    if (options.moving && this.#inFlight && performance.now() - this.#inFlight < 1000) return;
    this.#pending = null;
    this.#inFlight = performance.now();
    this.#socket.send(JSON.stringify({ type: "state", n: ++this.n, ...make(), ...options }));
  }

  #text(message) {
    const waiting = this.#waiting.get(message.re);
    if (waiting && message.type === "progress") return waiting.progress(message);
    if (waiting && (message.type === "answer" || message.type === "error")) {
      this.#waiting.delete(message.re);
      return message.type === "answer" ? waiting.done(message) : waiting.fail(message);
    }
    if (message.type === "hello") this.onstate("open");
    if (message.n === this.n && message.type === "error") this.#free();
    this.onmessage(message);
  }

  #frame(data) {
    const length = new DataView(data).getUint32(4, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 8, length)));
    const picture = new Blob([new Uint8Array(data, 8 + length)], { type: `image/${header.type}` });
    if (header.kind && header.kind !== "state") return this.#waiting.get(header.n)?.progress(header, picture);
    if (header.n === this.n) this.#free();
    this.onframe(header, picture);
  }

  #free() {
    this.#inFlight = 0;
    this.#flush();
  }

  /** A file of this computer, handed to the server. */
  async upload(file) {
    const query = new URLSearchParams({ token: this.token, view: this.view, name: file.name });
    const answer = await fetch(`upload?${query}`, { method: "POST", body: file });
    const told = await answer.json().catch(() => ({ sentence: `${file.name} was refused.` }));
    if (!answer.ok || told.type === "error") throw told;
    return told;
  }
}
