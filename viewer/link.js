// The socket: requests with answers, the newest state only, frames in order, and trying again when it is lost.
const waits = [1, 2, 4, 8, 15];
// Milliseconds: a way that takes longer is far, where states follow each other so closely at most.
const near = 25, spacing = 20;

const drawnId = () => Array.from(crypto.getRandomValues(new Uint8Array(12)), (b) => b.toString(16).padStart(2, "0")).join("");
const viewId = () => {
  // The tab's own: a duplicated tab has the same one and is told so by the server, a new tab draws another.
  let id = sessionStorage.getItem("view");
  if (!id) sessionStorage.setItem("view", (id = drawnId()));
  return id;
};

/** Asks for the newest: what came meanwhile replaces what waits. One at a time on a short way; on a long one as many as keep it busy, evenly.
 * @param {Link} link @param {(what: any) => Promise<any>} ask */
export function newestOnly(link, ask) {
  let busy = 0, next = null, last = 0, timer = 0;
  function want(what) {
    const most = link.way > near ? 1 + Math.ceil(link.way / 75) : 1, wait = most > 1 ? last + link.way / most - performance.now() : 0;
    if (busy >= most || wait > 0) {
      next = what;
      if (busy < most) timer ||= setTimeout(() => ((timer = 0), again()), wait);
      return;
    }
    next = null;
    busy++;
    last = performance.now();
    ask(what).catch(() => {}).finally(() => (busy--, again()));
  };
  const again = () => next && want(next);
  return want;
}

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
  #inFlight = []; // states that no frame has answered yet: [n, when it was sent]
  #scheduled = false;
  #bytes = 0; // of pictures, as they came
  #parts = [];
  /** Milliseconds from a state to the frame that answers it, without the time the server took: the way there and back. */
  way = 0;

  /** A tab that was here before takes its view back: the server may not know yet that the old socket is gone. A duplicated tab does not. */
  connect(take = this.#tries > 0 || performance.getEntriesByType("navigation")[0]?.type === "reload") {
    clearTimeout(this.#timer);
    // One socket at a time: a try that is still under way must not open later.
    if (this.#socket) Object.assign(this.#socket, { onopen: null, onmessage: null, onclose: null }).close();
    const address = new URL("socket", location.href);
    address.protocol = address.protocol.replace("http", "ws");
    address.search = new URLSearchParams({ token: this.token, view: this.view, paced: "1", ...(take ? { take: "1" } : {}) }).toString();
    const socket = (this.#socket = new WebSocket(address));
    socket.binaryType = "arraybuffer";
    socket.onopen = () => ((this.open = true), this.connections++, (this.#tries = 0), (this.#inFlight = []), (this.#bytes = 0), (this.#parts = []));
    socket.onmessage = ({ data }) => (typeof data === "string" ? this.#text(JSON.parse(data)) : this.#took(data));
    socket.onclose = ({ code }) => socket === this.#socket && this.#lost(code);
  }

  /** Goes on as a view of its own: frames within one page share what a tab keeps. */
  renew() {
    this.view = drawnId();
    this.connect(false);
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

  /** Whether what is sent goes out: a socket that closes is not yet told to be lost. */
  get #ready() {
    return this.open && this.#socket.readyState === WebSocket.OPEN;
  }

  /** A request: resolves with its answer, rejects with its error. `progress` hears of both progress and frames.
   * @returns {Promise<any> & {id: number}} */
  ask(type, fields = {}, progress = (_message, _data) => {}) {
    const id = ++this.#id;
    const answer = new Promise((done, fail) => {
      if (!this.#ready) return fail({ code: "lost", sentence: "" });
      this.#waiting.set(id, { done, fail, progress });
      this.#socket.send(JSON.stringify({ type, id, ...fields }));
    });
    return Object.assign(answer, { id });
  }

  cancel(id) {
    this.ask("cancel", { re: id }).catch(() => {});
  }

  /** Sends a state in the next animation frame: the newest only, and while moving no more than are needed for the server to have
   * one whenever it can draw: one at a time on a short way, as many as are under way at 50 a second on a long one. */
  send(make, options) {
    this.#pending = { make, options };
    if (this.#scheduled) return;
    this.#scheduled = true;
    requestAnimationFrame(() => ((this.#scheduled = false), this.#flush()));
  }

  #flush() {
    if (!this.#pending || !this.#ready) return;
    const { make, options } = this.#pending;
    const now = performance.now(), far = this.way > near, last = this.#inFlight.at(-1)?.[1] ?? 0, oldest = this.#inFlight[0]?.[1] ?? now;
    if (options.moving && this.#inFlight.length >= (far ? Math.min(12, 2 + Math.ceil(this.way / spacing)) : 1) && now - oldest < 1000) return;
    if (options.moving && far && now - last < spacing) return void (this.#later ||= setTimeout(() => ((this.#later = 0), this.#flush()), spacing - (now - last)));
    if (now - oldest >= 1000) this.#inFlight = [];
    this.#pending = null;
    this.#inFlight.push([++this.n, now]);
    this.#socket.send(JSON.stringify({ type: "state", n: this.n, ...make(), ...options }));
  }
  #later = 0;

  #text(message) {
    const waiting = this.#waiting.get(message.re);
    if (waiting && message.type === "progress") return waiting.progress(message);
    if (waiting && (message.type === "answer" || message.type === "error")) {
      this.#waiting.delete(message.re);
      return message.type === "answer" ? waiting.done(message) : waiting.fail(message);
    }
    if (message.type === "hello") this.onstate("open");
    if (message.n && message.type === "error") this.#free(message.n);
    this.onmessage(message);
  }

  /** What comes of pictures: whole ones, or parts of them ("CHFP"), told as they come, so that the server knows how quick the way is. */
  #took(data) {
    this.#bytes += data.byteLength;
    if (this.#ready) this.#socket.send(JSON.stringify({ type: "got", bytes: this.#bytes }));
    const view = new DataView(data);
    if (view.getUint8(3) !== 80) return this.#frame(data);
    const [lane, whole, begin] = [4, 8, 12].map((at) => view.getUint32(at, true)), part = new Uint8Array(data, 16);
    if (!whole) return;
    if (!begin) this.#parts[lane] = { bytes: new Uint8Array(whole), came: 0 };
    const picture = this.#parts[lane];
    picture.bytes.set(part, begin);
    if ((picture.came += part.length) === whole) this.#frame(picture.bytes.buffer);
  }

  #frame(data) {
    const length = new DataView(data).getUint32(4, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 8, length)));
    const picture = new Blob([new Uint8Array(data, 8 + length)], { type: `image/${header.type}` });
    if (header.kind && header.kind !== "state") return this.#waiting.get(header.n)?.progress(header, picture);
    this.#free(header.n, header.seconds);
    this.onframe(header, picture);
  }

  /** What answers a state answers those before it too. */
  #free(n, seconds) {
    const sent = this.#inFlight.find(([of]) => of === n)?.[1];
    if (sent && seconds !== undefined) {
      const way = Math.max(0, performance.now() - sent - 1000 * seconds);
      this.way = this.way ? 0.8 * this.way + 0.2 * way : way;
    }
    this.#inFlight = this.#inFlight.filter(([of]) => of > n);
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
