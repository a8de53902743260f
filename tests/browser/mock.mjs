// A server that speaks server/PROTOCOL.md and answers with simple pictures: for tests of the page that must be exact
// about time (delays, losses) or errors.
import { createServer } from "node:http";
import { readFileSync } from "node:fs";
import { dirname, extname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { arches, ballOf, functionAt, picture, png, sky, valueAt } from "./mock_picture.mjs";
import { accept } from "./mock_socket.mjs";

const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
const kinds = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css" };

/** The settings as the hello tells them, from docs/options.md. */
export function settings() {
  const groups = [];
  for (const line of readFileSync(join(root, "docs/options.md"), "utf8").split("\n")) {
    if (line.startsWith("## ")) groups.push({ title: line.slice(3), settings: [] });
    const cells = line.split(/(?<!\\)\|/).map((cell) => cell.trim().replaceAll("\\|", "|"));
    const key = /^`(.+)`$/.exec(cells[2] ?? "")?.[1];
    if (!key) continue;
    const [, flag, form = ""] = /^`--(\S+) ?(.*)`$/.exec(cells[1]) ?? [];
    const range = /(above |at most )?(-?[\d.]+)( to (-?[\d.]+))?/.exec(cells[4] ?? "");
    const number = form === "N" || ["STOPS", "DEG"].includes(form), choice = /^[a-z0-9-]+(\|[a-z0-9-]+)+$/.test(form) && !/^\d/.test(form), fallback = cells[5] ?? "";
    const own = /Lighting by (\w+)/.exec(groups.at(-1).title)?.[1], methods = own ? [own] : groups.at(-1).title === "Scattering" ? ["transport", "reference"] : [];
    const value = fallback === "" ? null : /^-?[\d.]+$/.test(fallback) ? Number(fallback) : fallback;
    groups.at(-1).settings.push({ flag: flag ?? null, key, unit: "", sentence: cells[3], lowest: range ? Number(range[2]) : null, highest: range?.[4] ? Number(range[4]) : null, lowest_excluded: Boolean(range?.[1]),
      default: key === "shading.enabled" || key === "slices.outlines" ? true : key === "background" ? [0, 0, 0] : key === "camera.fit_scale" ? 1 : value, default_text: fallback, kind: choice ? "choice" : number ? "number" : form === "" ? "switch" : "form", choices: choice ? form.split("|") : [], form, repeats: false, method: own ?? "", methods });
  }
  return groups;
}

const bump = (i, at, wide, high) => high * Math.exp(-(((i - at) / wide) ** 2));
export const volume = {
  file: "ball.nrrd", name: "ball.nrrd", format: "nrrd", dimensions: [64, 64, 64], type: "uint8", components: 1, spacing_mm: [1, 1, 1], origin_mm: [0, 0, 0], direction: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], world: "unknown", range: [0, 255],
  percentiles: { 1: 0, 50: 40, 99: 220, 99.9: 250 }, nonfinite: 0, modality_guess: "micro-CT", preset_guess: "micro-ct", notes: [], unit: "", spacing_stated: false, bytes: 262144, exact: true,
  sections: [{ name: "z", axis: 2, right: [1, 0, 0], down: [0, 1, 0] }, { name: "y", axis: 1, right: [1, 0, 0], down: [0, 0, -1] }, { name: "x", axis: 0, right: [0, 1, 0], down: [0, 0, -1] }],
  histogram512: { min: 0, max: 255, counts: Array.from({ length: 512 }, (_, i) => Math.round(bump(i, 8, 12, 9e5) + bump(i, 90, 30, 4000) + bump(i, 260, 120, 900) + bump(i, 420, 20, 3000) + 20)) },
};
const looks = {
  "micro-ct": [[0, 0.3, 0.2, 0.1, 0], [30, 0.3, 0.5, 0.15, 0], [42, 0.38, 0.55, 0.2, 0.55], [60, 0.5, 0.4, 0.2, 0], [96, 0.55, 0.33, 0.2, 0], [150, 0.6, 0.38, 0.26, 0.9], [255, 0.85, 0.95, 1, 1]],
  simulation: [[0, 0, 0, 0.3, 0], [128, 0.9, 0.3, 0.1, 0.1], [255, 1, 1, 0.8, 0.6]],
  viridis: [[0, 0.27, 0, 0.33, 0], [128, 0.13, 0.57, 0.55, 0.1], [255, 0.99, 0.91, 0.14, 0.25]],
};
export const transfer = (name) => ({ name, opacity_unit_distance: 1, points: looks[name].map(([value, r, g, b, opacity]) => ({ value, rgb: [r, g, b], opacity })) });
export const scene = { chiaro: 1, volume: { file: "ball.nrrd" }, transfer_function: transfer("micro-ct"), camera: { azimuth_deg: 35, elevation_deg: 25 }, lighting: { method: "spao" }, image: { size: [1024, 768] } };

export class Mock {
  /** What the page sent, newest last. */ heard = [];
  /** Milliseconds that a frame is held back. */ delay = (_header) => 0;
  /** Answers in the place of the mock's own: (message) => answer, error or undefined. */ reply = (_message) => undefined;
  /** How the picture of a state at rest ends. */ stage = "final";
  hello = {};
  sockets = new Set();
  #states = new Map();
  #server = null;

  async start(port = 0) {
    this.#server = createServer((request, response) => this.#serve(request, response));
    this.#server.on("upgrade", (request, socket) => this.#upgrade(request, socket));
    await new Promise((done) => this.#server.listen(port, "127.0.0.1", done));
    this.port = this.#server.address().port;
    this.address = `http://127.0.0.1:${this.port}/?token=mock`;
    return this;
  }
  /** Ends as a killed program does; views are forgotten unless `keep`. */
  async stop(keep = false) {
    if (!keep) this.#states.clear();
    for (const socket of this.sockets) socket.drop();
    this.#server.closeAllConnections();
    await new Promise((done) => this.#server.close(done));
  }
  last = (type) => this.heard.filter((m) => m.type === type).at(-1);

  #serve(request, response) {
    const { pathname } = new URL(request.url, "http://mock");
    if (request.method === "POST") {
      const parts = [];
      request.on("data", (part) => parts.push(part)).on("end", () => response.end(JSON.stringify(this.#uploaded(Buffer.concat(parts).toString()))));
      return;
    }
    if (pathname.startsWith("/download/")) return void response.end(picture(this.saved, 64, 48));
    try {
      const name = pathname === "/" ? "/index.html" : pathname;
      response.setHeader("content-type", kinds[extname(name)] ?? "application/octet-stream");
      response.end(readFileSync(join(root, "viewer", name)));
    } catch {
      response.writeHead(404).end();
    }
  }
  #uploaded(text) {
    try {
      const json = JSON.parse(text);
      return json.points ? { kind: "transfer", transfer_function: json } : { kind: "scene", scene: json, unknown: [], needs_volume: null };
    } catch {
      return { type: "error", code: "input", sentence: '"scan.json" is no JSON: it ends after 3 of 9 bytes.', field: null };
    }
  }

  #upgrade(request, socket) {
    const view = new URL(request.url, "http://mock").searchParams.get("view"), kept = this.#states.get(view);
    const peer = accept(request, socket, (text) => this.#hear(peer, view, JSON.parse(text)), () => this.sockets.delete(peer));
    peer.view = view;
    this.sockets.add(peer);
    const infos = Object.keys(looks).map((name) => ({ name, modality: { "micro-ct": "micro-CT", simulation: "simulation" }[name] ?? "", sentence: "a look", stretched: true, is_map: name === "viridis" }));
    const methods = ["none", "spao", "visibility", "histogram", "transport", "reference"].map((name) => ({ name, sentence: name }));
    peer.send(JSON.stringify({ type: "hello", version: "0.2.0", protocol: 1, view, restored: Boolean(kept), device: { name: "cpu", isa: "mock", threads: 1 }, settings: settings(), methods, presets: infos,
      probes: ["white", "sky", "studio", "windows"].map((name) => ({ name, sentence: name })), samples: [{ name: "cornell", sentence: "walls and two bodies", size: 128 }], formats: [], films: ["png"], volume, scene: kept ?? scene, error: null, ...this.hello }));
  }

  async #hear(peer, view, message) {
    if (message.type === "got") return; // this way is always quick
    this.heard.push(message);
    const own = this.reply(message);
    if (own !== undefined) return own && peer.send(JSON.stringify({ re: message.id ?? null, ...own }));
    const answer = (fields) => peer.send(JSON.stringify({ type: "answer", re: message.id, ...fields }));
    const frame = (header, data) => new Promise((sent) => setTimeout(() => {
      const head = Buffer.from(JSON.stringify(header)), size = Buffer.alloc(4);
      size.writeUInt32LE(head.length);
      peer.send(Buffer.concat([Buffer.from("CHF1"), size, head, data]));
      sent();
    }, this.delay(header)));
    const state = this.#states.get(view) ?? scene;
    switch (message.type) {
      case "state": {
        if (!message.preview) this.#states.set(view, message.scene);
        // Only the newest counts, as with the real server.
        peer.newest = message;
        await new Promise((done) => setImmediate(done));
        if (peer.newest !== message) return;
        const [w, h] = message.canvas, base = { n: message.n, kind: "state", type: "png", canvas: [w, h], moving: message.moving, preview: message.preview, seconds: 0.9, verbs: [{ name: "raycast", seconds: 0.4 }], notes: [], light: { coarse: false, method: "spao" } };
        // A quarter of the pixels is enough for a test and takes a quarter of the time.
        const half = [w >> 3, h >> 3], full = [w >> 1, h >> 1];
        frame({ ...base, stage: "draft", size: half }, picture(message.scene, ...half));
        if (!message.moving) frame({ ...base, stage: message.preview ? "full" : this.stage, size: full }, picture(message.scene, ...full));
        return;
      }
      case "pick": {
        const [w, h] = this.last("state").canvas, ball = ballOf(state, w, h), r = Math.hypot(message.x - ball.x, message.y - ball.y) / ball.r, value = valueAt(r);
        const f = functionAt(state.transfer_function.points, value);
        return answer(r < 1 ? { hit: true, value, world_mm: [32, 32, 32], voxel: [32, 32, 32], opacity: f.opacity, rgb: f.rgb, share: 1, depth_mm: 100 } : { hit: false });
      }
      case "look": await frame({ n: message.id, kind: "look", type: "png", size: message.size }, picture(message.scene, ...message.size)); return answer({});
      case "slice":
        if (message.values) return answer({ values: Array(message.size[0] * message.size[1]).fill(42) });
        await frame({ n: message.id, kind: "slice", type: "png", size: message.size }, png(1, 1, Buffer.from([90, 90, 90, 255])));
        return answer({});
      case "gradients": await frame({ n: message.id, kind: "gradients", type: "png", size: [64, 32] }, arches()); return answer({ values: volume.range, steepest: 40 });
      case "snap": return answer({ hit: false });
      case "region": return answer({ count: 8, mean: 42, deviation: 2, min: 40, max: 45, percentiles: { 1: 40, 5: 40, 25: 41, 50: 42, 75: 43, 95: 44, 99: 45 }, histogram: Array(64).fill(1), volume_mm3: 8, exact_mm3: 7.5 });
      case "probe": await frame({ n: message.id, kind: "probe", type: "png", size: [128, 64] }, sky(message.probe.preset ?? "own")); return answer({});
      case "resolve": return answer({ transfer_function: message.transfer_function.preset ? transfer(message.transfer_function.preset) : message.transfer_function });
      case "cache": return answer({ folder: "/home/me/.cache/chiaro", bytes: this.heard.some((m) => m.type === "cache" && m.clear) ? 0 : 12e6 });
      case "measure": return answer({ percent: 1.8, points: 1024, interval: [1.6, 2.0], largest: 22 });
      case "save": (this.saved = message.scene), answer({ url: "/download/1", name: "ball.png", bytes: 12345 }); return;
      case "export": return answer({ text: JSON.stringify(message.scene, null, 2), name: "ball.json" });
      case "command": return answer({ text: `chiaro render ball.nrrd -o ${message.output}` });
      case "folder": return answer({ path: message.path, parent: null, entries: [{ name: "ball.nrrd", path: "/data/ball.nrrd", kind: "volume", bytes: 262144 }] });
      case "open": return answer({ volume, scene });
      case "compare": {
        const [w, h] = message.size;
        frame({ n: message.id, kind: "method", type: "png", size: [w, h] }, picture(message.scene, w, h));
        frame({ n: message.id, kind: "reference", type: "png", size: [w, h], samples: 256, figures: { rmse: 0.018, psnr: 34.9, ssim: 0.972, max: 0.11, noise: 0.004 } }, picture({ ...message.scene, lighting: { method: "reference" } }, w, h));
        return;
      }
      default: return answer({});
    }
  }
}

if (process.argv[1] === fileURLToPath(import.meta.url)) console.log((await new Mock().start(Number(process.argv[2] ?? 8600))).address);
