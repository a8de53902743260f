// A slow way between a page and its server: TCP through a queue of limited rate and length for each direction, then a delay.
import net from "node:net";

/** One direction: bytes wait for the narrow part (at most `buffer` of them, then the sender is held up), then travel.
 * @param {import("node:net").Socket} from @param {import("node:net").Socket} to @param {any} way */
function carry(from, to, way) {
  const pieces = []; // in their order: [when the narrow part is done with it, when it is there, bytes]
  let free = 0, arrived = 0, waiting = 0, timer = null, passed = 0;
  const move = () => {
    timer = null;
    const now = performance.now();
    for (; passed < pieces.length && pieces[passed][0] <= now; ++passed) waiting -= pieces[passed][2].length;
    for (; pieces.length && pieces[0][1] <= now; --passed) to.writable ? to.write(pieces.shift()[2]) : pieces.shift();
    if (waiting < way.buffer) from.resume();
    const next = Math.min(pieces[0]?.[1] ?? Infinity, pieces[passed]?.[0] ?? Infinity);
    if (next < Infinity) timer = setTimeout(move, Math.max(1, next - now));
  };
  from.on("data", (data) => {
    for (let at = 0; at < data.length; at += 2048) {
      const piece = data.subarray(at, at + 2048), now = performance.now();
      free = Math.max(free, now) + (8 * piece.length) / way.bits_per_ms;
      waiting += piece.length;
      way.longest_queue_ms = Math.max(way.longest_queue_ms, free - now);
      arrived = Math.max(arrived, free + way.round_trip_ms / 2 + way.jitter_ms * (Math.random() - 0.5)); // TCP keeps the order
      pieces.push([free, arrived, piece]);
    }
    if (waiting >= way.buffer) from.pause();
    timer ??= setTimeout(move, 1);
  });
  from.on("end", () => setTimeout(() => to.end(), Math.max(0, arrived - performance.now()) + 5));
  from.on("error", () => to.destroy());
}

/** Listens on a port of its own; `way` may be changed at any time: {round_trip_ms, bits_per_ms (5000: 5 Mbit/s), jitter_ms (each direction ± half of it),
 * buffer}; `longest_queue_ms` tells how long the last byte had to wait at most. */
export async function relay(port, way) {
  Object.assign(way, { buffer: 256 << 10, jitter_ms: 0, longest_queue_ms: 0, ...way });
  const sockets = new Set(), server = net.createServer((near) => {
    const far = net.connect(port, "127.0.0.1");
    for (const socket of [near, far]) socket.setNoDelay(true), sockets.add(socket), socket.on("close", () => sockets.delete(socket));
    carry(near, far, way), carry(far, near, way);
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  return { port: server.address().port, close: () => (sockets.forEach((socket) => socket.destroy()), new Promise((done) => server.close(done))) };
}
