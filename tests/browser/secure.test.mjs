// Volumes on servers behind TLS: read where the certificate is trusted, a sentence where it is not, no way back to http.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, statSync } from "node:fs";
import { createServer as plainServer } from "node:http";
import { createServer } from "node:https";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";

const chiaro = join(process.env.CHIARO_BIN, "chiaro"), folder = mkdtempSync(join(tmpdir(), "chiaro-secure-"));
const has = (program, ...version) => {
  try {
    return execFileSync(program, version, { stdio: "ignore" }), true;
  } catch {
    return false;
  }
};
const skip = !has("openssl", "version") && "no openssl";

/** Runs the tool. @returns {Promise<{code: number, said: string}>} */
function run(args, env = {}) {
  const child = spawn(chiaro, args, { env: { ...process.env, ...env }, stdio: ["ignore", "ignore", "pipe"] });
  let said = "";
  child.stderr.on("data", (text) => (said += text));
  return new Promise((done) => child.on("close", (code) => done({ code, said })));
}
const listening = (server) => new Promise((done) => server.listen(0, "127.0.0.1", () => done(server.address().port)));

/** Files below the folder, and their ranges. */
function answer(request, response) {
  const path = join(folder, request.url);
  let size;
  try {
    size = statSync(path).isFile() ? statSync(path).size : -1;
  } catch {
    size = -1;
  }
  if (size < 0) return response.writeHead(404).end();
  const range = /^bytes=(\d*)-(\d*)$/.exec(request.headers.range ?? ""), whole = readFileSync(path);
  if (!range) return response.writeHead(200, { "Content-Length": size }).end(whole);
  const first = range[1] ? Number(range[1]) : Math.max(0, size - Number(range[2])), last = range[1] && range[2] ? Math.min(size - 1, Number(range[2])) : size - 1;
  response.writeHead(206, { "Content-Range": `bytes ${first}-${last}/${size}`, "Content-Length": last - first + 1 }).end(whole.subarray(first, last + 1));
}

let secure, plain, address;
before(async () => {
  if (skip) return;
  execFileSync(chiaro, ["convert", "sample:ball:64", join(folder, "ball.zarr"), "--quiet"]);
  const subject = ["-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost"];
  execFileSync("openssl", ["req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2", "-keyout", "key.pem", "-out", "own.pem", ...subject], { cwd: folder, stdio: "ignore" });
  plain = plainServer(answer);
  const port = await listening(plain), away = (request, response) => response.writeHead(302, { Location: `http://localhost:${port}${request.url.replace("/away", "")}` }).end();
  secure = createServer({ key: readFileSync(join(folder, "key.pem")), cert: readFileSync(join(folder, "own.pem")) }, (request, response) => (request.url.startsWith("/away/") ? away : answer)(request, response));
  address = `https://localhost:${await listening(secure)}`;
});
after(() => {
  secure?.close(), plain?.close();
  rmSync(folder, { recursive: true });
});
const picture = (name) => ["-o", join(folder, name), "--size", "64x48", "--quiet"];
const trusted = () => ({ SSL_CERT_FILE: join(folder, "own.pem") });

test("what a trusted server holds is the picture of the folder", { skip }, async () => {
  assert.deepEqual(await run(["render", join(folder, "ball.zarr"), ...picture("folder.png")]), { code: 0, said: "" });
  assert.deepEqual(await run(["render", `${address}/ball.zarr`, "--exact", ...picture("server.png")], trusted()), { code: 0, said: "" });
  const pixels = (name) => readFileSync(join(folder, name)).toString("latin1").split("IDAT").slice(1).join("IDAT");
  assert.equal(pixels("server.png"), pixels("folder.png"));
});

test("a certificate that nobody vouches for is a sentence", { skip }, async () => {
  const { code, said } = await run(["render", `${address}/ball.zarr`, ...picture("none.png")]);
  assert.equal(code, 3);
  assert.match(said, /certificate is not trusted/);
  assert.equal(said.trim().split("\n").length, 1, said);
});

test("a certificate of another name is a sentence", { skip }, async () => {
  const { code, said } = await run(["render", `${address.replace("localhost", "127.0.0.1")}/ball.zarr`, ...picture("none.png")], trusted());
  assert.equal(code, 3);
  assert.match(said, /certificate/);
});

test("no redirect leads from https to http", { skip }, async () => {
  const { code, said } = await run(["render", `${address}/away/ball.zarr`, ...picture("none.png")], trusted());
  assert.equal(code, 3);
  assert.match(said, /redirects from https to http/);
  assert.equal(said.trim().split("\n").length, 1, said);
});
