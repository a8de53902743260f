// Dark, light, or as the system; the theme never alters the picture.
export function makeTheme(store) {
  const system = matchMedia("(prefers-color-scheme: light)"), root = document.documentElement;
  let colours = null;
  const apply = () => {
    const kept = localStorage.getItem("theme") ?? "system";
    root.dataset.theme = kept === "system" ? (system.matches ? "light" : "dark") : kept;
    colours = null;
    store.redraw();
  };
  system.addEventListener("change", apply);
  apply();
  return {
    get now() { return localStorage.getItem("theme") ?? "system"; },
    set: (name) => (localStorage.setItem("theme", name), apply()),
    /** What the graph is drawn with. */
    colours() {
      const style = getComputedStyle(root), of = (name) => style.getPropertyValue(name).trim();
      return (colours ??= { line: of("--text"), quiet: of("--second"), grid: of("--rule"), accent: of("--accent"), histogram: of("--histogram"), font: getComputedStyle(document.body).fontFamily });
    },
  };
}
