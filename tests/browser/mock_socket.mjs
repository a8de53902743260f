// The little of RFC 6455 that a test needs: a server's end of a WebSocket over node's http.
import { createHash } from "node:crypto";

/** Answers an upgrade; `heard(text)` gets each text message. Returns {send(text or Buffer), close(code)}. */
export function accept(request, socket, heard, closed) {
  const key = createHash("sha1").update(request.headers["sec-websocket-key"] + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11").digest("base64");
  socket.write(`HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${key}\r\n\r\n`);
  let buffer = Buffer.alloc(0);
  const write = (opcode, payload) => {
    if (socket.destroyed) return;
    const length = payload.length;
    const head = length < 126 ? Buffer.from([0x80 | opcode, length]) : length < 65536 ? Buffer.from([0x80 | opcode, 126, length >> 8, length & 255]) : Buffer.concat([Buffer.from([0x80 | opcode, 127, 0, 0, 0, 0]), Buffer.from(new Uint32Array([length]).buffer).reverse()]);
    socket.write(Buffer.concat([head, payload]));
  };
  socket.on("data", (data) => {
    buffer = Buffer.concat([buffer, data]);
    for (;;) {
      if (buffer.length < 2) return;
      let length = buffer[1] & 127, at = 2;
      if (length === 126) (length = buffer.readUInt16BE(2)), (at = 4);
      else if (length === 127) (length = Number(buffer.readBigUInt64BE(2))), (at = 10);
      if (buffer.length < at + 4 + length) return;
      const mask = buffer.subarray(at, at + 4), payload = Buffer.from(buffer.subarray(at + 4, at + 4 + length)), opcode = buffer[0] & 15;
      for (let i = 0; i < length; ++i) payload[i] ^= mask[i & 3];
      buffer = buffer.subarray(at + 4 + length);
      if (opcode === 1) heard(payload.toString());
      else if (opcode === 8) (write(8, payload.subarray(0, 2)), socket.end());
      else if (opcode === 9) write(10, payload);
    }
  });
  socket.on("error", () => {});
  socket.on("close", closed);
  return {
    send: (data) => (typeof data === "string" ? write(1, Buffer.from(data)) : write(2, data)),
    close: (code) => (write(8, Buffer.from([code >> 8, code & 255])), socket.end()),
    drop: () => socket.destroy(),
  };
}
