// The viewer within another page (?embed): no bar and no panel, and messages to and from the page around it, of an origin that the
// program was started with (--embed-from) alone. Loaded when first used; docs/viewer.md tells the messages.
import { words } from "./texts.js";

const largest = 500_000, groups = (value) => value && typeof value === "object" && !Array.isArray(value);

/** Whether an origin is one of those; "http://localhost:*" is any port. @param {string[]} allowed */
export const isAllowed = (allowed, origin) => allowed.some((one) => one === origin || (one.endsWith(":*") && origin.startsWith(one.slice(0, -1)) && /^\d+$/.test(origin.slice(one.length - 1))));

/** What is left out stays; the transfer function comes whole. */
const merged = (now, given) => Object.fromEntries(Object.keys({ ...now, ...given }).map((key) => [key, !(key in given) ? now[key] : key !== "transfer_function" && groups(now[key]) && groups(given[key]) ? { ...now[key], ...given[key] } : given[key]]));

/** @param {any} app @param {(scene: any) => void} take */
export function makeEmbed(app, take) {
  const outer = window.parent, allowed = app.hello.embed_from ?? [], around = location.ancestorOrigins?.[0];
  let origin = around && isAllowed(allowed, around) ? around : null, told = "";
  document.body.classList.add("embed");
  /** To the page around this one, if it is of an origin that may hear. */
  const tell = (message) => outer !== window && (origin ? [origin] : around ? [] : allowed.filter((one) => !one.endsWith("*"))).forEach((to) => outer.postMessage({ chiaro: 1, ...message }, to));
  const picture = () => new Promise((done) => app.frame.canvas.toBlob(done, "image/png"));

  async function take_(given) {
    const scene = merged(app.scene(), given), text = JSON.stringify(scene);
    if (text.length > largest) throw { sentence: words.embed.tooLarge };
    const found = await app.link.ask("import", { text, name: "scene.json" });
    if (found.needs_volume) throw { sentence: words.embed.otherVolume };
    take(found.scene);
  }
  const answers = {
    scene: async ({ scene }) => {
      if (scene !== undefined && !groups(scene)) throw { sentence: words.embed.noScene };
      if (scene) await take_(scene);
      return { scene: app.scene() };
    },
    picture: async () => ({ png: await picture(), size: [app.frame.canvas.width, app.frame.canvas.height], stage: app.frame.last.stage }),
  };
  addEventListener("message", async (event) => {
    const { source, data } = event;
    if (source !== outer || outer === window || !isAllowed(allowed, event.origin) || data?.chiaro !== 1) return;
    origin = event.origin;
    const id = typeof data.id === "number" || (typeof data.id === "string" && data.id.length <= 64) ? data.id : null;
    try {
      if (!app.volume) throw { sentence: words.embed.nothing };
      if (!Object.hasOwn(answers, data.type)) throw { sentence: words.embed.unknown };
      tell({ type: data.type, id, ...(await answers[data.type](data)) });
    } catch (error) {
      tell({ type: "error", id, sentence: error.sentence ?? words.embed.noScene });
    }
  });
  return {
    opened() {
      const { name, dimensions, type, range, unit, world } = app.volume;
      tell({ type: "ready", version: app.hello.version, volume: { name, dimensions, type, range, unit, world }, scene: app.scene() });
      told = "";
    },
    /** The picture is final: what makes it, where that is new. */
    shown() {
      const scene = app.scene(), text = JSON.stringify(scene);
      if (text !== told) (told = text), tell({ type: "scene", id: null, scene });
    },
    picked: ({ value, world_mm, voxel }) => tell({ type: "picked", value, unit: app.volume.unit ?? "", world_mm, voxel }),
  };
}
