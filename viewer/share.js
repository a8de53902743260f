// A link that opens the same state on the same server. The state lies behind the #, which browsers send to nobody; the token is not
// in it: who follows the link is asked for it. Loaded when first used.
const mark = "#state=";

const through = async (bytes, stream) => new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());

/** @param {any} scene */
export async function linkOf(scene) {
  const packed = await through(new TextEncoder().encode(JSON.stringify(scene)), new CompressionStream("deflate-raw"));
  const text = btoa(Array.from(packed, (b) => String.fromCharCode(b)).join("")).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
  return new URL(`./${mark}${text}`, location.origin + location.pathname).href;
}

/** The scene of the address, or nothing; it is taken out of the address. */
export async function linked() {
  const text = location.hash.slice(mark.length);
  history.replaceState(null, "", location.pathname + location.search);
  try {
    const packed = Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0));
    return JSON.parse(new TextDecoder().decode(await through(packed, new DecompressionStream("deflate-raw"))));
  } catch {
    return null;
  }
}
