// Pictures of the mock: a shaded ball, coloured by the transfer function, as PNG. The same scene gives the same bytes.
import { deflateSync, crc32 as zlibCrc } from "node:zlib";

const table = Array.from({ length: 256 }, (_, n) => { for (let k = 0; k < 8; ++k) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1; return n >>> 0; });
const crc32 = zlibCrc ?? ((data) => { let c = ~0; for (const byte of data) c = table[(c ^ byte) & 255] ^ (c >>> 8); return ~c >>> 0; });

export function png(width, height, rgba) {
  const rows = Buffer.alloc((width * 4 + 1) * height);
  for (let y = 0; y < height; ++y) rgba.copy(rows, y * (width * 4 + 1) + 1, y * width * 4, (y + 1) * width * 4);
  const chunk = (type, data) => {
    const body = Buffer.concat([Buffer.from(type), data]), out = Buffer.alloc(body.length + 8);
    out.writeUInt32BE(data.length, 0);
    body.copy(out, 4);
    out.writeUInt32BE(crc32(body) >>> 0, body.length + 4);
    return out;
  };
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head.set([8, 6], 8);
  return Buffer.concat([Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]), chunk("IHDR", head), chunk("IDAT", deflateSync(rows, { level: 1 })), chunk("IEND", Buffer.alloc(0))]);
}

/** Value of the mock's volume at a point of the ball: 0 at its centre, 255 at the rim. */
export const valueAt = (r) => 255 * r;

export function functionAt(points, value) {
  let i = points.findIndex((p) => p.value > value);
  if (i < 0) return points.at(-1);
  if (i === 0) return points[0];
  const [a, b] = [points[i - 1], points[i]], t = b.value > a.value ? (value - a.value) / (b.value - a.value) : 1;
  return { value, opacity: a.opacity + t * (b.opacity - a.opacity), rgb: a.rgb.map((c, k) => c + t * (b.rgb[k] - c)) };
}

/** Where the ball is: centre and radius in pixels. */
export const ballOf = (scene, width, height) => ({ x: width / 2, y: height / 2, r: (0.4 * Math.min(width, height)) / (scene.camera?.fit_scale ?? 1) });

export function picture(scene, width, height) {
  const rgba = Buffer.alloc(width * height * 4), ball = ballOf(scene, width, height), { points } = scene.transfer_function;
  const lut = Array.from({ length: 256 }, (_, v) => functionAt(points, v));
  const turn = (((scene.camera?.azimuth_deg ?? 35) + (scene.probe?.rotation ?? 0)) * Math.PI) / 180, lit = { none: 1, spao: 0.8, visibility: 0.7, histogram: 0.6, reference: 0.5, transport: 0.55 }[scene.lighting?.method] ?? 1;
  for (let y = 0; y < height; ++y) for (let x = 0; x < width; ++x) {
    const u = (x + 0.5 - ball.x) / ball.r, v = (y + 0.5 - ball.y) / ball.r, r = Math.hypot(u, v), at = 4 * (y * width + x);
    rgba[at + 3] = 255;
    if (r >= 1) continue;
    const f = lut[Math.floor(valueAt(r))], k = Math.sqrt(1 - (1 - f.opacity) ** (scene.transfer_function.opacity_scale ?? 1)) * lit * (0.75 + 0.25 * Math.cos(Math.atan2(v, u) - turn));
    for (let c = 0; c < 3; ++c) rgba[at + c] = Math.min(255, Math.round(255 * k * f.rgb[c]));
  }
  return png(width, height, rgba);
}

/** An equirectangular sky for the probes. */
export function sky(name, width = 128, height = 64) {
  const rgba = Buffer.alloc(width * height * 4, 255), hue = { white: [255, 255, 255], sky: [120, 170, 255], studio: [230, 225, 215], windows: [255, 220, 160] }[name] ?? [200, 140, 220];
  for (let y = 0; y < height; ++y) for (let x = 0; x < width; ++x) for (let c = 0; c < 3; ++c)
    rgba[4 * (y * width + x) + c] = name === "white" ? 255 : hue[c] * (y < height / 2 ? 0.5 + 0.5 * Math.exp(-(((x - 40) / 14) ** 2)) : 0.18);
  return png(width, height, rgba);
}

/** Counts over value and gradient as a picture of 64 × 32: even matter at three values, and the arches of edges between them. */
export function arches() {
  const rgba = Buffer.alloc(64 * 32 * 4, 255);
  for (let y = 0; y < 32; ++y) for (let x = 0; x < 64; ++x) {
    const value = (255 * x) / 63, steep = 40 * ((31 - y) / 31) ** 2, arch = (a, b) => Math.max(0, 1 - Math.abs(steep - 40 * Math.max(0, 1 - ((2 * value - a - b) / (b - a)) ** 2)) / 4);
    const flat = Math.max(...[10, 100, 220].map((at) => Math.exp(-(((value - at) / 12) ** 2)) * Math.exp(-steep / 2)));
    rgba.fill(Math.round(255 * Math.max(flat, 0.6 * arch(10, 100), 0.5 * arch(100, 220))), 4 * (64 * y + x), 4 * (64 * y + x) + 3);
  }
  return png(64, 32, rgba);
}
