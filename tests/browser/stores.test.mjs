// Zarr stores are what they say to an independent reader, npm's zarrita: those that zarr_test writes, and what `chiaro convert` makes.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import * as zarr from "zarrita";

const bin = process.env.CHIARO_BIN, folder = mkdtempSync(join(tmpdir(), "chiaro-stores-"));
after(() => rmSync(folder, { recursive: true }));

/** Files below a folder as zarrita asks for them. */
class Folder {
  constructor(path) {
    this.path = path;
  }
  async get(key) {
    const file = this.path + key;
    return existsSync(file) ? new Uint8Array(readFileSync(file)) : undefined;
  }
  async getRange(key, range) {
    const whole = await this.get(key);
    return whole && ("suffixLength" in range ? whole.slice(-range.suffixLength) : whole.slice(range.offset, range.offset + range.length));
  }
}
/** Numbers of an array, the last axis fastest; zarrita leaves them in the order in which they are stored. */
function inOrder({ data, shape: [nz, ny, nx], stride: [sz, sy, sx] }) {
  const numbers = [];
  for (let z = 0; z < nz; z++) for (let y = 0; y < ny; y++) for (let x = 0; x < nx; x++) numbers.push(data[z * sz + y * sy + x * sx]);
  return numbers;
}
const array = (path) => zarr.open(zarr.root(new Folder(path)), { kind: "array" });

test("zarrita reads the stores that zarr_test writes", { skip: !existsSync(join(bin, "zarr_test")) && "zarr_test is not built" }, async () => {
  execFileSync(join(bin, "zarr_test"), ["--gtest_filter=ZarrOf*"], { env: { ...process.env, CHIARO_KEEP_STORES: folder }, stdio: "ignore" });
  const stores = readdirSync(folder).filter((name) => !name.endsWith("index first")); // zarrita looks for a shard's index at its end alone
  assert.ok(stores.length >= 200, `${stores.length} stores: ten types in more than twenty layouts`);
  for (const name of stores) {
    const read = await zarr.get(await array(join(folder, name, "a"))), bytes = new Uint8Array(readFileSync(join(folder, name, "numbers")));
    assert.deepEqual(read.shape, [5, 7, 6], name);
    assert.deepEqual(inOrder(read), Array.from(new read.data.constructor(bytes.buffer)), name);
  }
});

for (const encoding of ["raw", "zstd", "blosc"])
  test(`zarrita reads what chiaro convert makes, ${encoding}`, async () => {
    const [nx, ny, nz] = [140, 70, 66], numbers = new Uint16Array(nx * ny * nz), file = join(folder, `${encoding}_${nx}x${ny}x${nz}_uint16.raw`);
    for (let i = 0; i < numbers.length; i++) numbers[i] = (i * 40503) & 0xffff;
    writeFileSync(file, numbers);
    const store = join(folder, `${encoding}.zarr`);
    execFileSync(join(bin, "chiaro"), ["convert", file, store, "--encoding", encoding, "--quiet"]);
    const group = await zarr.open(zarr.root(new Folder(store)), { kind: "group" }), [levels] = group.attrs.ome.multiscales;
    assert.deepEqual(levels.axes.map(({ name }) => name), ["z", "y", "x"]);
    const [whole, half] = await Promise.all(levels.datasets.slice(0, 2).map(({ path }) => array(join(store, path)).then((a) => zarr.get(a))));
    assert.deepEqual(whole.shape, [nz, ny, nx]);
    assert.ok(Buffer.from(whole.data.buffer).equals(Buffer.from(numbers.buffer)), "all voxels");
    assert.deepEqual(half.shape, [nz / 2, ny / 2, nx / 2]);
    const at = (x, y, z) => numbers[(z * ny + y) * nx + x];
    for (let z = 0, i = 0; z < nz / 2; z++)
      for (let y = 0; y < ny / 2; y++)
        for (let x = 0; x < nx / 2; x++, i++) {
          let sum = 0;
          for (let k = 0; k < 8; k++) sum += at(2 * x + (k & 1), 2 * y + ((k >> 1) & 1), 2 * z + (k >> 2));
          assert.ok(Math.abs(half.data[i] - sum / 8) <= 0.5, `a mean at ${x}, ${y}, ${z}`);
        }
  });
