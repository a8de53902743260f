// The state of the page, which is the truth: one immutable object, changed by steps that can be undone. The camera has
// steps of its own.
const most = 200;

/** @typedef {{values: Object<string, any>, camera: Object<string, any>, tf: any, iso: any[], threshold: number[]|null, rest: any}} State */

export class Store {
  /** @type {State} */
  state;
  #undo = { design: [], camera: [] };
  #redo = { design: [], camera: [] };
  #drag = null;
  #listeners = new Map();
  #drawing = 0;
  #turned = true; // so far nothing but the camera is another
  /** Called after each change with {moving}; the link sends from here. */
  onchange = (_) => {};
  /** What is shown besides and never saved: a highlighted peak, a look on trial, the unlit picture. */
  preview = null;

  constructor(state) {
    this.state = state;
  }

  /** Calls `draw` in the frame after each change, or each but those of the camera alone. */
  watch(draw, { camera = true } = {}) {
    this.#listeners.set(draw, camera);
  }

  /** Changes the state: `change(state)` returns what is new in it. One undo step, unless within a drag.
   * @param {string} label what the step is called @param {(state: State) => Partial<State>} change @param {string} [track] */
  set(label, change, track = "design") {
    const before = this.state;
    const changes = change(before);
    this.state = { ...before, ...changes };
    if (this.#drag) this.#drag.changed = true;
    else this.#keep(label, before, track);
    this.#changed(Boolean(this.#drag), Object.keys(changes).every((key) => key === "camera" || changes[key] === before[key]));
  }

  /** All changes until `end` are one step. */
  begin(label, track = "design") {
    this.end();
    this.#drag = { label, before: this.state, track, changed: false };
  }

  end() {
    const drag = this.#drag;
    this.#drag = null;
    if (!drag) return;
    if (!drag.changed) return this.redraw(); // what waits for the end of a drag
    this.#keep(drag.label, drag.before, drag.track);
    this.#changed(false);
  }

  /** Esc during a drag: back to where it began. */
  cancel() {
    if (!this.#drag) return;
    this.state = this.#drag.before;
    this.#drag = null;
    this.#changed(false);
  }

  get dragging() {
    return this.#drag !== null;
  }

  #keep(label, before, track) {
    if (this.#drag) return;
    const last = this.#undo[track].at(-1);
    const now = performance.now();
    // Presses of one key that follow each other closely are one step, as a drag is.
    if (last && last.label === label && label.endsWith("…") && now - last.time < 600) last.time = now;
    else this.#undo[track].push({ label, before, time: now });
    if (this.#undo[track].length > most) this.#undo[track].shift();
    this.#redo[track] = [];
    this.steps++;
  }

  /** The name of the step that undo or redo would take, or nothing. */
  next(which, track = "design") {
    return (which === "undo" ? this.#undo : this.#redo)[track].at(-1)?.label.replace("…", "");
  }

  step(which, track = "design") {
    this.cancel();
    const [from, to] = which === "undo" ? [this.#undo, this.#redo] : [this.#redo, this.#undo];
    const entry = from[track].pop();
    if (!entry) return;
    to[track].push({ label: entry.label, before: this.state, time: 0 });
    const { camera, ...design } = entry.before;
    this.steps++;
    this.state = track === "camera" ? { ...this.state, camera } : { ...this.state, ...design };
    this.#changed(false);
  }

  /** Replaces the whole state, without a step: another volume, or what a server kept. */
  replace(state, { silent = false } = {}) {
    this.#drag = null;
    this.state = state;
    this.#undo = { design: [], camera: [] };
    this.#redo = { design: [], camera: [] };
    silent ? this.redraw() : this.#changed(false);
  }

  /** The steps to be kept elsewhere, the next one first: each with what it changes alone; as many as fit. */
  history(most = 200_000) {
    const packed = (stack) => {
      const steps = [];
      let next = this.state, size = 0;
      for (const { label, before } of [...stack].reverse()) {
        const changes = Object.fromEntries([...new Set([...Object.keys(before), ...Object.keys(next)])].filter((key) => before[key] !== next[key]).map((key) => [key, before[key] ?? null]));
        if ((size += JSON.stringify(changes).length) > most) break;
        steps.push({ label, changes });
        next = before;
      }
      return steps;
    };
    return Object.fromEntries([["undo", this.#undo], ["redo", this.#redo]].map(([name, stacks]) => [name, { design: packed(stacks.design), camera: packed(stacks.camera) }]));
  }

  /** A state with the steps that were kept of it. */
  restore(state, history) {
    this.replace(state, { silent: true });
    const unpacked = (steps) => {
      let next = state;
      return (steps ?? []).map(({ label, changes }) => ({ label, before: (next = { ...next, ...changes }), time: 0 })).reverse();
    };
    for (const [name, stacks] of [["undo", this.#undo], ["redo", this.#redo]]) for (const track of ["design", "camera"]) stacks[track] = unpacked(history?.[name]?.[track]);
    this.#changed(false);
  }

  /** How many steps there were: tells whether there are others. */
  steps = 0;

  /** What the server found out about the state: no step, nothing to send. @param {Partial<State>} found */
  learn(found) {
    this.state = { ...this.state, ...found };
    this.redraw();
  }

  /** Ends a step that was taken: no step of its own. @param {Partial<State>} found */
  amend(found) {
    this.state = { ...this.state, ...found };
    this.#changed(false);
  }

  /** Shows something that is not part of the state (null: no more). */
  show(preview) {
    if (JSON.stringify(preview) === JSON.stringify(this.preview)) return;
    this.preview = preview;
    this.#changed(false);
  }

  #changed(moving, turned = false) {
    this.redraw(turned);
    this.onchange({ moving });
  }

  redraw(turned = false) {
    this.#turned &&= turned;
    this.#drawing ||= requestAnimationFrame(() => {
      const few = this.#turned;
      (this.#drawing = 0), (this.#turned = true);
      for (const [draw, camera] of this.#listeners) if (camera || !few) draw(this.state);
    });
  }
}
